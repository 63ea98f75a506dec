"""Where a hit box lands, and how surely."""

import math

import numpy as np
import pytest

import hitjoints as hj
from hitjoints.errors import InfeasibleError, InputError
from hitjoints.goals.landing import slide_after

HERE = (0.5, 0.3, 0.5)


@pytest.fixture(scope="module")
def arm():
    robot = hj.load_robot("iiwa14")
    return robot, hj.place_joint(robot, 6, HERE, start=robot.home).q[0]


def wanted(**given):
    usual = {"mass": 1.5, "friction": 0.35, "restitution": 0.4, "goal": (0.5, 0.8, 0.5)}
    return hj.Hit(6, HERE, **(usual | given))


def test_the_speed_of_the_wish_lands_at_the_goal(arm):
    robot, q = arm
    hit = wanted()
    speed = hit.speed(hj.directional_inertia(robot, q, 6, hit.direction))
    found = hj.landing(robot, q, hit, speed, samples=10)
    assert found.nominal == pytest.approx(hit.goal, abs=1e-5)
    assert found.within == 1.0
    assert found.covariance == pytest.approx(np.zeros((2, 2)), abs=1e-20)


def test_small_spreads_add_up_as_first_order_says(arm):
    robot, q = arm
    spread = {"mass": 0.03, "restitution": 0.01, "friction": 0.007, "speed": 0.005}
    hit = wanted(spread=spread)
    inertia = hj.directional_inertia(robot, q, 6, hit.direction)
    found = hj.landing(robot, q, hit, hit.speed(inertia), samples=4000)
    eps, mu, m = hit.restitution, hit.friction, hit.mass
    share = math.sqrt(
        (2 * spread["restitution"] / (1 + eps)) ** 2
        + (spread["friction"] / mu) ** 2
        + (2 * spread["speed"]) ** 2
        + (2 * spread["mass"] / (inertia + m)) ** 2
    )
    assert math.sqrt(found.covariance[1, 1]) == pytest.approx(0.5 * share, rel=0.05)
    inside = math.erf(found.tolerance / (0.5 * share) / math.sqrt(2))
    assert found.within == pytest.approx(inside, abs=0.03)


def test_a_box_hit_off_its_centre_scatters_sideways(arm):
    robot, q = arm
    hit = wanted(size=(0.2, 0.15, 0.12), spread={"offset": 0.01})
    speed = hit.speed(hj.directional_inertia(robot, q, 6, hit.direction))
    found = hj.landing(robot, q, hit, speed, samples=200)
    assert found.covariance[0, 0] > 1e-6
    again = hj.landing(robot, q, hit, speed, samples=200)
    assert found.as_dict() == again.as_dict()


@pytest.mark.parametrize(
    ("given", "options", "argument"),
    [
        ({"goal": None, "direction": (0, 1, 0.2)}, {}, "direction"),
        ({"goal": None, "direction": (0, 1, 0), "friction": None}, {}, "friction"),
        ({"goal": None, "direction": (0, 1, 0), "restitution": None}, {}, "restitution"),
        ({}, {"tolerance": 0}, "tolerance"),
        ({}, {"samples": 1}, "samples"),
        ({}, {"speed": -1.0}, "speed"),
    ],
)
def test_bad_input_names_the_argument(arm, given, options, argument):
    robot, q = arm
    with pytest.raises(InputError) as refused:
        hj.landing(robot, q, wanted(**given), **({"speed": 1.0} | options))
    assert refused.value.argument == argument


def test_draws_that_would_slide_on_their_edge_count_as_lost(arm):
    """One in a thousand that is steep does not refuse the hit; a hit that is steep itself does."""
    hit = wanted(friction=0.7, size=(0.1, 0.1, 0.1), spread={"friction": 0.02})
    told = hj.landing(*arm, hit, 1.0, samples=4000)
    beyond = 0.5 * math.erfc(0.05 / 0.02 / math.sqrt(2))
    assert told.lost == pytest.approx(beyond, abs=0.004)
    assert told.lost > 0
    assert len(told.samples) == round(4000 * (1 - told.lost))
    assert told.within <= 1 - told.lost
    with pytest.raises(InfeasibleError, match="slide on its edge"):
        hj.landing(*arm, hit.changed(friction=0.8), 1.0)


@pytest.mark.parametrize(
    "given", [{}, {"size": (0.1, 0.1, 0.05)}, {"size": (0.2, 0.3, 0.05), "yaw": 0.3}]
)
def test_the_slide_ends_where_landing_says(arm, given):
    robot, q = arm
    hit = hj.Hit(6, HERE, (1, 1, 0), 1.5, 0.4, restitution=0.4, friction=0.25, **given)
    path = slide_after(robot, q, hit, 0.6)
    said = hj.landing(robot, q, hit, 0.6, samples=2)
    place, turned = path.at(path.duration)
    np.testing.assert_allclose(hit.position[:2] + place, said.nominal[:2], atol=1e-12)
    assert turned == pytest.approx(said.yaw, abs=1e-12)
    np.testing.assert_array_equal(path.at(-1.0)[0], (0, 0))
    np.testing.assert_array_equal(path.at(path.duration + 1)[0], place)


def test_a_slide_without_turning_is_a_parabola_at_every_time(arm):
    robot, q = arm
    hit = hj.Hit(6, HERE, (0, 1, 0), 1.5, 0.4, restitution=0.4, friction=0.25)
    path = slide_after(robot, q, hit, 0.6)
    flux = hj.hitting_flux(hj.directional_inertia(robot, q, 6, (0, 1, 0)), 1.5, 0.6)
    v = 1.4 * flux
    for time in np.linspace(0, path.duration, 37):
        way = v * time - 0.25 * 9.81 * time**2 / 2
        assert path.at(time)[0] == pytest.approx((0, way), abs=2e-4 * v)
