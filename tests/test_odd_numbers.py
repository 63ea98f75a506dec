"""A list, a text or nothing in the place of a number is refused in one line that names it."""

import pytest

import hitjoints as hj
from hitjoints.errors import InputError
from hitjoints.hit_setting import HitSetting

PLACE, ALONG = (0.5, 0.2, 0.4), (0, 1, 0)
ODD = ([1, 2], "x", None, float("nan"))


@pytest.fixture(scope="module")
def hit():
    return hj.Hit(7, PLACE, ALONG, 1.0, 0.2, restitution=0.4, friction=0.3)


CALLS = {
    "mass": lambda robot, hit, odd: hj.plan(robot, PLACE, ALONG, odd),
    "mass of a hit": lambda robot, hit, odd: hj.Hit(7, PLACE, ALONG, odd),
    "mass of a sweep": lambda robot, hit, odd: hj.sweep_joint(robot, PLACE, ALONG, odd),
    "mass of springs": lambda robot, hit, odd: hj.elastic_impact(
        robot, robot.home, 7, ALONG, odd, 0.5, 0.5, 0.01
    ),
    "speed": lambda robot, hit, odd: hj.landing(robot, robot.home, hit, odd),
    "speed of a start": lambda robot, hit, odd: hj.plan_start(robot, robot.home, 7, ALONG, odd),
    "dt": lambda robot, hit, odd: hj.rollout(robot, hit, dt=odd),
    "seed": lambda robot, hit, odd: hj.plan(robot, PLACE, ALONG, 1.0, seed=odd),
    "hits": lambda robot, hit, odd: HitSetting(hits=odd),
    "tolerance": lambda robot, hit, odd: HitSetting(tolerance=odd),
    "samples": lambda robot, hit, odd: hj.landing(robot, robot.home, hit, 1.0, samples=odd),
}
MAY_BE_NONE = {
    "flux": lambda robot, hit, odd: hj.plan(robot, PLACE, ALONG, 1.0, flux=odd),
    "margin": lambda robot, hit, odd: hj.swing(robot, hit, margin=odd),
    "dt": lambda robot, hit, odd: hj.swing(robot, hit, dt=odd),
    "friction": lambda robot, hit, odd: hj.simulate(robot, hit, friction=odd),
}


@pytest.mark.parametrize("odd", ODD, ids=repr)
@pytest.mark.parametrize("name", CALLS)
def test_it_is_refused(arm, hit, name, odd):
    with pytest.raises(InputError, match=f"{name.partition(' of ')[0]} = "):
        CALLS[name](arm("iiwa14"), hit, odd)


@pytest.mark.parametrize("odd", [odd for odd in ODD if odd is not None], ids=repr)
@pytest.mark.parametrize("name", MAY_BE_NONE)
def test_it_is_refused_unless_it_is_nothing(arm, hit, name, odd):
    with pytest.raises(InputError, match=f"{name} = "):
        MAY_BE_NONE[name](arm("iiwa14"), hit, odd)
