"""Rollouts side by side against the same rollouts one by one."""

import multiprocessing

import numpy as np
import pytest

import hitjoints as hj
from hitjoints.hitting import step_rows
from hitjoints.hitting.step import Gains
from hitjoints.rollouts import side_by_side
from tests.hitting.test_rollout import planar
from tests.oracles import random_rollouts as oracle

SUMMARY = (
    "steps",
    "saturated_steps",
    "braked_steps",
    "velocity_ratio_max",
    "position_violation_max",
    "torque_ratio_max",
    "reason",
    "why",
)
OPTIONS = (
    {},
    {"weighting": "gradient"},
    {"reference": "constant"},
    {"speed_profile": "paper", "dt": 0.004},
    {"gains": Gains(posture=2.0, inertia=0.1)},
)


def cases(count, name, seed=0):
    """Hits and starts of one arm, half of them with joints at their limits."""
    mine = [case for case in oracle.random_cases(3 * count, seed) if case[0].name == name]
    return mine[0][0], [case[1] for case in mine], *(np.array([c[i] for c in mine]) for i in (2, 3))


def assert_same(together, i, one):
    if one.impact is None and together.certified_steps[i]:
        # Creeping along limits to a stop: ProxQP's answers there are good to its own tolerance.
        assert together.reason[i].split()[0] == one.reason.split()[0]
        return
    for name in SUMMARY:
        expected, found = getattr(one, name), getattr(together, name)[i]
        if isinstance(expected, str):
            assert found == expected
        else:
            assert found == pytest.approx(expected, rel=1e-9, abs=1e-9, nan_ok=True), name
    # What ProxQP answers is within 1e-7, and differs from step to step by as much.
    ratio = together.acceleration_ratio_max[i]
    assert ratio == pytest.approx(one.acceleration_ratio_max, rel=1e-6, nan_ok=True)
    assert together.sendable[i] == one.sendable
    assert together.hit[i] == (one.reason == "")
    if one.impact is None:
        assert np.isnan(together.flux[i])
        return
    for name, expected in vars(one.impact).items():
        np.testing.assert_allclose(getattr(together, name)[i], expected, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("name", ["iiwa14", "iiwa7", "panda"])
def test_each_is_the_rollout_alone(name):
    robot, hits, q0, q_hit = cases(10, name)
    for k, options in enumerate(OPTIONS):
        rows = slice(k, None, len(OPTIONS))
        chosen = hits[rows]
        together = hj.rollouts(robot, chosen, q0[rows], q_hit=q_hit[rows], **options)
        assert len(together) == len(chosen)
        assert together.within_limits.all()
        for i, hit in enumerate(chosen):
            one = hj.rollout(robot, hit, q0=q0[rows][i], q_hit=q_hit[rows][i], **options)
            assert_same(together, i, one)


def near_hits(count, seed=1):
    """One hit, and starts behind the object from which it mostly succeeds."""
    robot, rng = hj.load_robot("iiwa14"), np.random.default_rng(seed)
    hit = hj.Hit(6, [0.5, 0.3, 0.5], [0.0, 1.0, 0.0], 2.0, 0.3)
    at = np.array([0.5, 0.1, 0.5]) + rng.uniform(-0.03, 0.03, (count, 3))
    return robot, hit, hj.place_joint(robot, 6, at, start=robot.home).q


def test_hits_are_hits_and_the_hitting_configuration_is_found():
    robot, hit, q0 = near_hits(6)
    together = hj.rollouts(robot, hit, q0)
    assert together.hit.sum() >= 4
    for i, q in enumerate(q0):
        one = hj.rollout(robot, hit, q0=q)
        np.testing.assert_array_equal(together.q_hit[i], one.q_hit)
        assert_same(together, i, one)


def test_an_arm_in_a_plane_whose_lanes_have_no_proof(urdf):
    robot = planar(urdf)
    q0 = np.array([[0.3, 0.9, 0.8], [0.2, 1.0, 0.9]])
    target = hj.position(robot, q0[0], 3) + np.array([-0.08, 0.02, 0.0])
    hit = hj.Hit(3, target, [-1.0, 0.25, 0.0], 1.0, 0.1)
    together = hj.rollouts(robot, hit, q0)
    assert (together.certified_steps == together.steps).all()
    assert together.hit[0]
    for i in range(2):
        assert_same(together, i, hj.rollout(robot, hit, q0=q0[i]))


def test_neither_threads_nor_neighbours_change_a_bit(monkeypatch):
    robot, hit, q0 = near_hits(40)
    first = hj.rollouts(robot, hit, q0, threads=1)
    monkeypatch.setattr(side_by_side, "AT_ONCE", 7)
    for rows, threads in ((np.arange(40), 4), (np.arange(5, 17), 2)):
        again = hj.rollouts(robot, hit, q0[rows], threads=threads)
        for name in ("flux", "q", "steps", "torque_ratio_max", "reason", "miss"):
            np.testing.assert_array_equal(getattr(again, name), getattr(first, name)[rows])


def test_a_lane_without_a_proof_goes_the_certifying_way(monkeypatch):
    robot, hits, q0, q_hit = cases(8, "iiwa14", seed=4)
    usual = hj.rollouts(robot, hits, q0, q_hit=q_hit)
    monkeypatch.setattr(step_rows, "GUESSES", 1)
    hasty = hj.rollouts(robot, hits, q0, q_hit=q_hit)
    assert hasty.certified_steps.sum() > 2 * usual.certified_steps.sum() + 20
    np.testing.assert_array_equal(hasty.steps, usual.steps)
    np.testing.assert_allclose(hasty.flux, usual.flux, atol=1e-8)
    assert hasty.within_limits.all()


def test_the_numpy_back_end_gives_the_same(monkeypatch):
    robot, hit, q0 = near_hits(5)
    fast = hj.rollouts(robot, hit, q0)
    monkeypatch.setenv("HITJOINTS_BACKEND", "numpy")
    again = hj.load_robot("iiwa14", lock={})  # nothing compiled is kept of it
    slow = hj.rollouts(again, hit, q0)
    for name in ("flux", "q", "miss", "torque_ratio_max"):
        np.testing.assert_allclose(getattr(slow, name), getattr(fast, name), atol=1e-9)


def test_a_refused_row_says_what_a_rollout_would_and_the_others_go_on():
    robot, hit, q0 = near_hits(5)
    end = hj.rollout(robot, hit, q0=q0[0]).q_hit
    q_hit = np.tile(end, (5, 1))
    q0[1] = robot.upper + 0.1
    q0[2] = hj.place_joint(robot, 6, hit.position + 0.02 * hit.direction, start=end).q[0]
    q_hit[3] = q0[3]
    together = hj.rollouts(robot, hit, q0, q_hit=q_hit)
    for i in (1, 2, 3):
        with pytest.raises(hj.HitjointsError) as refusal:
            hj.rollout(robot, hit, q0=q0[i], q_hit=q_hit[i])
        assert together.reason[i] == str(refusal.value)
        assert together.steps[i] == 0
        assert not together.sendable[i]
    assert_same(together, 0, hj.rollout(robot, hit, q0=q0[0], q_hit=end))
    assert_same(together, 4, hj.rollout(robot, hit, q0=q0[4], q_hit=end))
    far = hj.Hit(6, [5.0, 0.0, 0.0], [1.0, 0.0, 0.0], 2.0, 0.3)
    assert "out of reach" in hj.rollouts(robot, far, robot.home).reason[0]


def test_what_cannot_be_used_is_refused():
    robot, hit, q0 = near_hits(3)
    for arguments, options, words in (
        (([hit, hit], q0), {}, "hits"),
        (([], q0), {}, "hits"),
        ((["hit"], q0), {}, "hits"),
        ((hit, np.full(7, np.nan)), {}, "q0"),
        ((hit, q0), {"q_hit": q0[:2]}, "hits"),
        ((hit, q0), {"dt": 1.0}, "dt"),
        ((hit, q0), {"threads": 0}, "threads"),
        ((hit, q0), {"reference": "none"}, "reference"),
        ((hit.changed(contact=None), q0), {}, "joint"),
    ):
        with pytest.raises(hj.InputError, match=words):
            hj.rollouts(robot, *arguments, **options)


def test_the_data_set_has_a_row_for_each():
    robot, hit, q0 = near_hits(4)
    together = hj.rollouts(robot, [hit] * 4, q0)
    dataset = together.dataset
    assert dict(dataset.sizes) == {"rollout": 4, "coordinate": 3, "axis": 7}
    np.testing.assert_array_equal(dataset.flux, together.flux)
    assert dataset.flux.attrs["units"] == "m/s"
    assert dataset.attrs["dt"] == 0.002


def flux_there(result):
    robot, hit, q0 = near_hits(3)
    result.put(hj.rollouts(robot, hit, q0, threads=2).flux)


def test_a_forked_child_does_the_same():
    robot, hit, q0 = near_hits(3)
    here = hj.rollouts(robot, hit, q0, threads=2).flux
    context = multiprocessing.get_context("fork")
    result = context.Queue()
    child = context.Process(target=flux_there, args=(result,))
    child.start()
    np.testing.assert_array_equal(result.get(timeout=60), here)
    child.join()
