"""Acceleration limits: kept from rest to rest, always able to stop, and no limit ever broken."""

from __future__ import annotations

import json

import numpy as np
import pytest

import hitjoints as hj
from hitjoints.errors import InputError
from hitjoints.hit import Hit
from hitjoints.hitting.acceleration_limits import AccelerationLimits
from hitjoints.hitting.controller import Controller
from hitjoints.planning.start import plan_start
from hitjoints.rollouts.follow import rollout
from tests.oracles.random_rollouts import broken_limits, random_rollouts

OBJECT, ALONG = np.array([0.5, 0.3, 0.5]), np.array([0.0, 1.0, 0.0])


@pytest.mark.parametrize("dt", [2e-5, 0.002, 0.05])
def test_from_any_step_there_is_another(arm, dt):
    """Whatever is chosen within the bounds, at worst their ends, they never become empty."""
    robot, rng = arm("panda"), np.random.default_rng(3)
    limits = AccelerationLimits(robot, dt)
    q, qd = robot.home, np.zeros(robot.n)
    turned = 0
    for i in range(4000):
        bounds = limits.stopping(q, robot.velocity_lower, robot.velocity_upper)
        lower, upper, kept = limits.near(qd, *bounds)
        assert kept
        assert (lower <= upper).all()
        push = rng.choice([0.0, 1.0], robot.n) if i % 500 < 100 else float((i // 500) % 2)
        following = lower + push * (upper - lower)
        assert (np.abs(following - qd) <= robot.acceleration * dt).all()
        turned += int(
            (np.abs(q - robot.upper) < 1e-3).any() or (np.abs(q - robot.lower) < 1e-3).any()
        )
        q, qd = q + dt * following, following
        assert ((q >= robot.lower - 1e-12) & (q <= robot.upper + 1e-12)).all()
    assert dt < 0.001 or turned > 10


def test_a_flywheel_speeds_up_as_its_limit_says(urdf):
    limit = '<limit lower="-2" upper="2" velocity="20" effort="50"/>'
    robot = urdf.load(
        urdf.base, urdf.link("l1", 1.0, (0.1, 0, 0)), urdf.joint("j1", "base", "l1", more=limit)
    )
    contact, q = hj.Contact(1, (0.2, 0.0, 0.0)), np.zeros(1)
    hit = Hit(contact, hj.position(robot, q, contact) + 0.1 * ALONG, ALONG, 0.5, 0.3)
    control = Controller(robot, hit, q, posture=q, acceleration_limits=[5.0])
    qd = np.zeros(1)
    for _ in range(10):
        following = control.step(q)
        assert following[0] - qd[0] == pytest.approx(5.0 * control.dt, rel=1e-6)
        q, qd = control.follow(q, following), following


def test_a_rollout_that_can_be_sent(arm):
    robot, hit = arm("iiwa14"), Hit(6, OBJECT, ALONG, 2.0, 0.3)
    free, kept = rollout(robot, hit), rollout(robot, hit, acceleration_limits=True)
    assert not free.sendable
    assert kept.sendable
    assert kept.acceleration_ratio_max <= 1
    assert broken_limits(kept) == 0
    assert kept.impact.flux == pytest.approx(0.3, rel=1e-3)
    assert kept.impact.miss < 1e-3
    # The bound of any straight speeding up: v^2 / 2 over the greatest acceleration along the line.
    q = kept.rows["q"][0]
    most = np.abs(ALONG @ hj.jacobian(robot, q, 6)) @ robot.acceleration
    way = np.linalg.norm(kept.rows["position"][0] - OBJECT)
    assert way > 0.5 * kept.impact.speed**2 / (1.5 * most)


def test_the_start_is_as_far_back_as_the_limits_need(arm):
    robot = arm("iiwa14")
    best = hj.plan(robot, OBJECT, ALONG, 2.0, [6], "straight-flux", certificate=False).best
    near = plan_start(robot, best.q, 6, ALONG, 0.5)
    far = plan_start(robot, best.q, 6, ALONG, 0.5, acceleration_limits=2.0)
    assert far.run_up > near.run_up
    weak = plan_start(robot, best.q, 6, ALONG, 0.5, run_up=0.05, acceleration_limits=1.0)
    assert not weak.feasible
    assert "the acceleration limits let the contact reach" in weak.reason


@pytest.mark.parametrize("torque_limits", [False, True])
def test_no_limit_is_broken_from_random_starts(torque_limits):
    kept = {"acceleration_limits": True, "torque_limits": torque_limits}
    for result in random_rollouts(2, seed=4, **kept):
        assert broken_limits(result) == 0
        assert not result.rows["emergency"].any()
        assert np.abs(result.rows["qd"][-1]).max() < 1e-9


def test_positions_and_velocities_come_before_accelerations(arm):
    robot, hit = arm("panda"), Hit(6, OBJECT, ALONG, 2.0, 0.3)
    control = Controller(robot, hit, robot.home, acceleration_limits=True)
    fast = 1.5 * robot.velocity_upper
    qd = control.step(robot.home, fast)
    assert (qd <= robot.velocity_upper).all()
    assert control.last.emergency
    control.step(robot.home, np.zeros(7))
    assert not control.last.emergency


def test_what_cannot_be_limited_is_refused(arm):
    hit = Hit(6, OBJECT, ALONG, 2.0, 0.3)
    for options, words in (
        ({"law": "paper", "acceleration_limits": True}, "take the law 'qp'"),
        ({"acceleration_limits": -1.0}, "acceleration = -1"),
        ({"acceleration_limits": [1.0, 2.0]}, "or 7 of them"),
    ):
        with pytest.raises(InputError, match=words):
            Controller(arm("iiwa14"), hit, np.zeros(7), **options)
    with pytest.raises(InputError, match="xarm7 does not tell its acceleration limits"):
        Controller(arm("xarm7"), hit, np.zeros(7), acceleration_limits=True)


def test_the_command_keeps_them(run):
    found = run("rollout", "--acceleration-limits", "--json")
    assert found.code == 0
    assert found.json["sendable"] is True
    assert found.json["why"] == ""
    assert "not sendable" not in found.err
    assert found.json["acceleration_limits"][0] == 8.57
    given = run("rollout", "--robot", "xarm7", "--acceleration", 20, "--json")
    assert given.json["acceleration_limits"] == [20.0] * 7
    assert given.json["acceleration_ratio_max"] <= 1
    refused = run("rollout", "--robot", "xarm7", "--acceleration-limits")
    assert refused.code == 1
    assert "does not tell its acceleration limits" in refused.err
    assert json.loads(json.dumps(found.json)) == found.json
