"""Whole swings, judged by code that shares nothing with what makes them."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pytest

import hitjoints as hj
from benchmarks.swings import MARGIN, SIZE, random_hits
from hitjoints.errors import InfeasibleError, InputError
from hitjoints.hit import Hit
from hitjoints.swings.as_rollout import as_rollout
from tests.oracles.swing_checker import judge

OBJECT, ALONG = np.array([0.5, 0.3, 0.5]), np.array([0.0, 1.0, 0.0])


@pytest.fixture(scope="module")
def bare(arm):
    return hj.swing(arm("iiwa14"), Hit(6, OBJECT, ALONG, 2.0, 0.3, size=SIZE))


def test_the_bare_swing_is_what_was_asked_for(bare, arm):
    found = judge(bare, SIZE, MARGIN)
    assert found["wrong"] == []
    assert bare.sendable
    assert bare.flux == pytest.approx(0.3, rel=1e-6)
    assert bare.miss < 1e-6
    assert (bare.q0 == arm("iiwa14").home).all()
    assert found["clearance"] == pytest.approx(bare.clearance, abs=5e-4)
    steps = np.diff(bare.times)
    np.testing.assert_allclose(steps, bare.dt, rtol=1e-9)
    assert "sendable" in repr(bare)


@pytest.mark.parametrize("name", ["panda", "xarm7"])
def test_the_fastest_swing_of_other_arms(arm, name):
    given = {} if name == "panda" else {"acceleration": 10.0}
    hit = Hit(7, OBJECT, [0.3, 1.0, 0.1], 1.0, size=SIZE)
    made = hj.swing(arm(name), hit, table_height=0.0, **given)
    assert judge(made, SIZE, MARGIN)["wrong"] == []
    assert made.flux <= made.maximum_flux
    assert made.flux > 0.8 * made.maximum_flux


def test_random_hits_are_struck_or_refused_with_a_reason(arm):
    robot, struck = arm("iiwa7"), 0
    for hit in random_hits(robot, 6, seed=12):
        try:
            made = hj.swing(robot, hit)
        except InfeasibleError:
            continue
        struck += 1
        assert made.sendable
        if struck <= 2:
            assert judge(made, SIZE, MARGIN)["wrong"] == []
    assert struck >= 4


def test_it_starts_where_it_is_told(arm):
    robot = arm("iiwa14")
    q0 = np.array([-0.8, 0.6, 0.2, -1.5, 0.3, 1.0, 0.5])
    made = hj.swing(robot, Hit(6, OBJECT, ALONG, 2.0, 0.3), q0=q0, dt=0.004)
    assert (made.q0 == q0).all()
    at = made.motion.at(np.array([made.impact_time])).qd[0]
    np.testing.assert_allclose(at, made.qd_hit, atol=1e-12)
    assert made.impact_time / 0.004 == pytest.approx(round(made.impact_time / 0.004))


def test_a_plan_is_struck_in_its_configuration(arm):
    robot = arm("iiwa14")
    best = hj.plan(robot, OBJECT, ALONG, 2.0, [6], "straight-flux", certificate=False).best
    for flux in (0.3, None):
        made = hj.swing(robot, Hit(6, OBJECT, ALONG, 2.0, flux), q_hit=best.q)
        turned = (made.q_hit - best.q) / (2 * np.pi)
        np.testing.assert_allclose(turned, np.round(turned), atol=1e-9)
        assert made.notes == ()
    assert made.flux > 0.9 * best.deliverable_flux


def test_same_input_same_bits(bare, arm):
    again = hj.swing(arm("iiwa14"), bare.hit)
    for one, other in zip(bare.joints, again.joints, strict=True):
        assert one.tobytes() == other.tobytes()
    assert bare.torque.tobytes() == again.torque.tobytes()


def test_rotors_cost_torque(arm):
    robot = arm("panda")
    hit = Hit(6, OBJECT, ALONG, 2.0, 0.3)
    made = hj.swing(robot, hit)
    light = replace(made, limits=replace(made.limits, rotor_inertia=np.zeros(7)))
    extra = made.torque - light.torque
    np.testing.assert_allclose(extra, robot.rotor_inertia * made.joints.qdd, atol=1e-9)
    assert np.abs(extra).max() > 1


def test_jerk_limits_are_kept_when_given(arm):
    hit = Hit(6, OBJECT, ALONG, 2.0, 0.3, size=SIZE)
    made = hj.swing(arm("iiwa14"), hit, jerk=100.0)
    assert made.limits.unknown == ()
    assert made.as_dict()["jerk_ratio_max"] <= 1
    assert judge(made, SIZE, MARGIN)["wrong"] == []


def test_a_motion_that_breaks_limits_says_which(bare):
    slow = replace(bare.limits, acceleration=bare.limits.acceleration / 2)
    broken = replace(bare, limits=slow)
    assert not broken.sendable
    assert broken.why == "accelerations are beyond their limits"
    weak = replace(bare, limits=replace(bare.limits, effort=bare.limits.effort / 100))
    assert weak.why == "torques are beyond their limits"


def test_what_cannot_be_done_is_refused_by_name(arm):
    robot = arm("iiwa14")
    with pytest.raises(InfeasibleError, match="beyond the maximum") as told:
        hj.swing(robot, Hit(6, OBJECT, ALONG, 2.0, 3.0))
    most = told.value.data["maximum_flux"]
    assert 0.5 < most < 0.6
    with pytest.raises(InfeasibleError, match="unreachable"):
        hj.swing(robot, Hit(6, [2.0, 0, 0.5], ALONG, 2.0, 0.3))
    with pytest.raises(InfeasibleError, match="no reachable run-up"):
        hj.swing(robot, Hit(6, [0.8, 0, 0.36], [-1, 0, 0], 2.0, 0.1))
    with pytest.raises(InfeasibleError, match="no clear configuration"):
        hj.swing(robot, Hit(6, OBJECT, -ALONG, 2.0, 0.3, size=[2.0, 2.0, 2.0]))


def test_bad_input_names_the_argument(arm):
    robot, hit = arm("iiwa14"), Hit(6, OBJECT, ALONG, 2.0, 0.3)
    folded = np.array([-2.3, 2.09, -2.8, 2.09, -1.2, -0.2, 0.3])
    for options, words in (
        ({"q0": np.full(7, 9.0)}, "q0"),
        ({"q0": folded}, "apart there"),
        ({"dt": 1e-7}, "dt = 1e-07: a spacing of 0.0001 s to 0.02 s"),
        ({"dt": np.nan}, "dt"),
        ({"margin": np.inf}, "margin"),
        ({"q_hit": robot.home}, "off the object"),
    ):
        with pytest.raises(InputError, match=words):
            hj.swing(robot, hit, **options)


def test_the_physics_engine_follows_it_as_it_is(bare):
    pytest.importorskip("mujoco")
    found = hj.simulate(bare, restitution=0.5)
    assert found.predicted.flux == pytest.approx(bare.flux, rel=1e-9)
    assert found.predicted.object_speed == pytest.approx(1.5 * bare.flux, rel=1e-9)
    assert found.errors["object_speed"] == pytest.approx(0, abs=2e-3)
    assert (found.motion.rows["q"] == bare.joints.q).all()
    with pytest.raises(InputError, match="a swing has its own"):
        hj.simulate(bare, bare.hit)
    with pytest.raises(InputError, match="hit"):
        hj.simulate(bare.robot)


def test_as_a_rollout_it_is_the_same_motion(bare):
    rolled = as_rollout(bare)
    at = rolled.steps - 1
    assert rolled.rows["qd"][at].tobytes() == bare.qd_hit.tobytes()
    assert rolled.impact.flux == pytest.approx(bare.flux)
    assert rolled.rows["flux"][at] == pytest.approx(bare.flux, rel=1e-9)
    assert rolled.rows["speed"][at] == pytest.approx(bare.speed, rel=1e-9)
    assert rolled.sendable


def test_rollouts_tell_whether_they_can_be_sent(arm):
    rolled = hj.rollout(arm("iiwa14"), Hit(6, OBJECT, ALONG, 2.0, 0.3))
    steps = np.diff(np.vstack((np.zeros(7), rolled.rows["qd"])), axis=0) / rolled.dt
    ratio = np.abs(steps / arm("iiwa14").acceleration).max()
    assert rolled.acceleration_ratio_max == pytest.approx(ratio)
    assert not rolled.sendable
    assert f"{ratio:.3g} times their limits" in rolled.why
    assert rolled.dataset.attrs["sendable"] == 0
    assert np.isnan(
        hj.rollout(arm("xarm7"), Hit(6, OBJECT, ALONG, 2.0, 0.2)).acceleration_ratio_max
    )


def branches(robot, q):
    """Return the configurations (N, 7) of an iiwa with all links where they are at q (7,)."""
    found = [q]
    for a, b, c in ((0, 1, 2), (4, 5, 6)):  # shoulder and wrist turned over
        for other in list(found):
            flipped = np.array(other)
            flipped[[a, c]] += np.pi
            flipped[b] *= -1
            found.append(flipped)
    turned = [(each + np.pi) % (2 * np.pi) - np.pi for each in found]
    return np.array([each for each in turned if (np.abs(each) <= robot.upper).all()])


def test_the_branch_nearest_to_the_start_is_taken(arm):
    """Of ways to hold all links in the same places, whatever the start."""
    robot, hit = arm("iiwa14"), Hit(7, OBJECT, ALONG, 2.0, 0.1)
    several = 0
    for q0 in branches(robot, robot.home + np.array([0.4, 0.2, 0.3, -0.5, 0.4, 0.6, 0.2])):
        made = hj.swing(robot, hit, q0=q0)
        equal = branches(robot, made.q_hit)
        for each in equal:
            np.testing.assert_allclose(
                hj.position(robot, each, 7), hj.position(robot, made.q_hit, 7), atol=1e-9
            )
        far = np.abs((equal - q0)[:, :6]).max(axis=1)
        assert far[0] == far.min()
        several += len(equal) > 1
    assert several >= 2


def test_an_object_where_the_arm_stands_is_refused_by_name(arm):
    robot = arm("iiwa14")
    begin = hj.place_joint(robot, 7, OBJECT + 0.25 * ALONG, start=robot.home).q[0]
    hit = Hit(6, OBJECT, ALONG, 2.0, 0.2, size=np.array([0.3, 0.3, 0.3]))
    with pytest.raises(InfeasibleError, match="the object is where the arm stands"):
        hj.swing(robot, hit, q0=begin)


def test_a_way_around_is_found_and_cut_short(arm):
    """From one side of the object to the other, where the straight way leads through it."""
    from hitjoints.swings.clear_way import Room, axes_along
    from hitjoints.swings.detours import clear_between, detour

    robot = arm("iiwa14")
    room, h = Room(robot, MARGIN, None, np.array([0.1, 0.1, 0.4])), np.array([1.0, 0, 0])
    aside = np.array([0.9, 0, 0, 0, 0, 0, 0])
    start, end = robot.home + aside, robot.home - aside
    box = room.whole(room.box(robot.home, robot.contact(7), h, axes_along(h, 0.0)))
    assert not room.touches(start, box)
    assert not room.touches(end, box)
    assert not clear_between(room, box, start, end)
    way = detour(room, box, (start, end), robot.finite_limits, np.random.default_rng(0))
    assert (way[0] == start).all()
    assert (way[-1] == end).all()
    for a, b in itertools.pairwise(way):
        for share in np.linspace(0, 1, 60):
            assert room.check((a + share * (b - a))[None], box).least >= MARGIN - 1e-9
    assert len(way) <= 6
