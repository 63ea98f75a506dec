"""Braking as hard as the motors can, from states at and beyond limits, where no way out is safe."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import linprog

import hitjoints as hj
from hitjoints.hit import Hit
from hitjoints.hitting.braking import Brake
from hitjoints.hitting.controller import Controller
from hitjoints.hitting.torque_limits import TorqueLimits

ARMS, STATES, DT = ("iiwa14", "iiwa7", "panda", "xarm7"), 2500, 0.002
HIT = (np.array([0.5, 0.3, 0.5]), np.array([0.0, 1.0, 0.0]), 2.0, 0.3)


def states(robot, count, seed):
    """Yield states at limits, near and away from them, up to twice as fast as is allowed."""
    rng = np.random.default_rng(seed)
    low, high = robot.finite_limits
    for _ in range(count):
        inside = rng.uniform(low, high)
        side, gap = rng.integers(0, 4, robot.n), rng.choice([0.0, 0.05]) * rng.random(robot.n)
        q = np.where(side == 0, low + gap, np.where(side == 1, high - gap, inside))
        fastest = rng.choice([0.3, 1.0, 2.0]) * robot.velocity_upper
        yield q, rng.uniform(-1, 1, robot.n) * fastest


def torques(robot, q, qd, following):
    """Return the torques (n,) N m of a step, of another recursion than that of the controller."""
    import pinocchio as pin

    return pin.rnea(robot.model, robot.data, q, qd, (following - qd) / DT)


@pytest.mark.parametrize("name", ARMS)
def test_from_any_state_no_step_leaves_the_limits(arm, name):
    robot = arm(name)
    unsafe = overloaded = 0
    limits = TorqueLimits(robot, DT)
    for q, qd in states(robot, STATES, seed=3):
        step = Brake(robot, limits).slower(q, qd, 0.5)
        end = q + DT * step.qd
        assert (step.qd >= robot.velocity_lower).all()
        assert (step.qd <= robot.velocity_upper).all()
        assert (end >= robot.lower - 1e-12).all()
        assert (end <= robot.upper + 1e-12).all()
        assert (step.qd[q == robot.upper] <= 0).all()  # never outwards at a stop
        assert (step.qd[q == robot.lower] >= 0).all()
        over = (np.abs(torques(robot, q, qd, step.qd)) > robot.effort * (1 + 1e-9)).any()
        assert not (over and step.safe)
        if not step.safe:
            assert (np.abs(step.qd) <= np.abs(qd) + 1e-9).all()  # no joint speeds up
        unsafe, overloaded = unsafe + (not step.safe), overloaded + over
    assert 0.1 * STATES < unsafe < 0.9 * STATES
    assert 0 < overloaded < unsafe


def test_torques_are_exceeded_only_where_no_slower_step_keeps_them(arm):
    """Against HiGHS, which looks for any step that slows down within torques and limits."""
    robot = arm("panda")
    limits, told = TorqueLimits(robot, DT), []
    for q, qd in states(robot, 400, seed=5):
        step = Brake(robot, limits).slower(q, qd, 0.5)
        if step.safe:
            continue
        low = np.maximum(
            np.maximum(robot.velocity_lower, (robot.lower - q) / DT), np.minimum(qd, 0)
        )
        high = np.minimum(
            np.minimum(robot.velocity_upper, (robot.upper - q) / DT), np.maximum(qd, 0)
        )
        bias = torques(robot, q, qd, qd)
        M = np.array([torques(robot, q, qd, qd + DT * e) - bias for e in np.eye(robot.n)]).T
        rows = np.vstack((M, -M)) / DT
        room = np.concatenate((robot.effort - bias, robot.effort + bias))
        room += rows @ qd
        exists = linprog(
            np.zeros(robot.n), rows, room, bounds=list(zip(low, high, strict=True)), method="highs"
        )
        over = (np.abs(torques(robot, q, qd, step.qd)) > robot.effort * (1 + 1e-9)).any()
        if exists.status == 0:
            tight = linprog(
                np.zeros(robot.n), rows, room - 1e-3, bounds=list(zip(low, high, strict=True))
            )
            if tight.status == 0:  # with some room left, so that no rounding decides
                assert not over
        else:
            assert over
        told.append(exists.status == 0)
    assert 20 < sum(told) < len(told) - 20


def test_it_comes_to_rest_from_anywhere_and_a_safe_way_stays_safe(arm):
    robot = arm("panda")
    limits, begun = TorqueLimits(robot, DT), 0
    for q, qd in states(robot, 60, seed=7):
        brake = Brake(robot, limits)
        allowed = (np.abs(qd) <= robot.velocity_upper).all()
        safe = bool(allowed and limits.can_stop(q, qd))
        begun += safe
        at, speed = q, qd
        for _ in range(1000):
            if not speed.any():
                break
            step = brake.slower(at, speed, 0.5)
            assert step.safe or not safe
            at = np.clip(at + DT * step.qd, robot.lower, robot.upper)
            speed = np.where(np.abs(step.qd) < 1e-9, 0.0, step.qd)
        assert not speed.any()
    assert 10 < begun < 50


def test_asking_whether_it_can_stop_changes_nothing(arm):
    robot = arm("panda")
    limits = TorqueLimits(robot, DT)
    (q, qd), (other, fast) = states(robot, 2, seed=11)
    first = Brake(robot, limits).slower(q, qd, 0.0)
    limits.can_stop(other, fast)
    again = Brake(robot, limits).slower(q, qd, 0.0)
    assert first.qd.tobytes() == again.qd.tobytes()
    assert limits.way_to_rest(q, np.zeros(robot.n)) is not None


@pytest.mark.parametrize("joint", [2, 4])
def test_the_controller_says_that_it_is_an_emergency(arm, joint):
    robot = arm("iiwa14")
    control = Controller(robot, Hit(6, *HIT), robot.home, torque_limits=True)
    control.step(robot.home)
    assert not control.last.emergency
    q, qd = robot.home.copy(), np.zeros(robot.n)
    q[joint - 1], qd[joint - 1] = robot.upper[joint - 1], 1.0
    following = control.step(q, qd)
    assert following[joint - 1] <= 0
    assert control.last.braked
    assert control.last.emergency
    qd[joint - 1] = 2 * robot.velocity_upper[joint - 1]
    following = control.step(robot.home, qd)
    assert (np.abs(following) <= robot.velocity_upper).all()


def test_an_emergency_has_its_column(arm):
    result = hj.rollout(arm("panda"), Hit(6, *HIT), torque_limits=True)
    assert not result.dataset.emergency.any()
