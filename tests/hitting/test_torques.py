"""Torque limits: real run-ups, real braking, and no limit ever broken."""

from __future__ import annotations

import math
from itertools import islice

import numpy as np
import pytest
from scipy.optimize import minimize

import hitjoints as hj
from hitjoints.errors import InfeasibleError, InputError
from hitjoints.hit import Hit
from hitjoints.hitting.braking import Brake
from hitjoints.hitting.controller import Controller
from hitjoints.hitting.stopping import stopping_rate, stopping_speed
from hitjoints.hitting.torque_limits import TorqueLimits
from hitjoints.programs.hitting_speed import step_bounds
from hitjoints.rollouts.follow import rollout
from tests.oracles.random_rollouts import broken_limits, random_rollouts

OBJECT, ALONG = np.array([0.5, 0.3, 0.5]), np.array([0.0, 1.0, 0.0])


def spinner(urdf, effort, *, reach=2.0, speed=20.0):
    """Return an arm with one joint about the vertical: a flywheel of 0.02 kg m^2, no gravity."""
    limit = f'<limit lower="{-reach}" upper="{reach}" velocity="{speed}" effort="{effort}"/>'
    return urdf.load(
        urdf.base, urdf.link("l1", 1.0, (0.1, 0, 0)), urdf.joint("j1", "base", "l1", more=limit)
    )


@pytest.fixture(scope="module")
def limited(arm):
    return rollout(arm("panda"), Hit(6, OBJECT, ALONG, 2.0, 0.4), torque_limits=True)


def test_the_fastest_speed_that_stops_in_time():
    """Against counting the steps: dt (v + (v - a dt) + ...) is the distance, to rounding."""
    rate, dt = np.full(60, 7.0), 0.01
    distance = np.concatenate(([0.0], np.geomspace(1e-7, 3.0, 59)))
    speed = stopping_speed(distance, rate, dt)
    for d, v in zip(distance, speed, strict=True):
        way = sum(max(v - i * 7.0 * dt, 0.0) for i in range(2000)) * dt
        assert way == pytest.approx(d, abs=1e-12)
    assert stopping_speed(np.array([np.inf]), np.ones(1), dt)[0] == np.inf


def test_the_least_rate_that_stops_in_time():
    distance, dt, v = np.geomspace(1e-7, 3.0, 60), 0.01, 1.3
    rates = stopping_rate(distance, np.full(60, v), dt)
    for d, rate in zip(distance, rates, strict=True):
        way = sum(max(v - i * rate * dt, 0.0) for i in range(1, 2000)) * dt
        assert way == pytest.approx(d, abs=1e-12)
    assert stopping_rate(np.zeros(1), np.ones(1), dt)[0] == pytest.approx(1 / dt)
    assert stopping_rate(np.array([np.inf]), np.ones(1), dt)[0] == 0


def test_a_flywheel_speeds_up_as_torque_over_inertia_says(urdf):
    robot = spinner(urdf, 0.5)
    dt, flux = 0.002, 0.3
    contact = hj.Contact(1, (0.2, 0.0, 0.0))
    q0 = np.zeros(1)
    target = hj.position(robot, q0, contact) + 0.1 * ALONG
    control = Controller(
        robot, Hit(contact, target, ALONG, 0.5, flux), q0, dt=dt, posture=q0, torque_limits=True
    )
    q, qd = q0, np.zeros(1)
    for _ in range(20):
        following = control.step(q)
        assert following[0] - qd[0] <= 0.5 / 0.02 * dt
        if following[0] * 0.2 < 0.9 * control.hit.speed(0.5):
            assert following[0] - qd[0] == pytest.approx(0.5 / 0.02 * dt, rel=1e-3)
        q, qd = control.follow(q, following), following
    assert q[0] > 0


def test_it_stops_at_a_position_limit_as_torque_over_inertia_says(urdf):
    robot = spinner(urdf, 0.5, reach=1.0, speed=100.0)
    limits = TorqueLimits(robot, 0.001)
    distance, q = 0.3, np.array([0.7])
    fastest = math.sqrt(2 * 0.5 / 0.02 * distance)
    assert limits.can_stop(q, np.array([0.95 * fastest]))
    assert not limits.can_stop(q, np.array([1.01 * fastest]))
    assert limits.can_stop(q, np.array([-fastest]))
    qd = np.array([0.95 * fastest])
    brake = Brake(robot, limits)
    for _ in range(1000):
        following, safe = brake.slower(q, qd, 0.0)
        assert safe
        assert qd[0] - following[0] <= 0.5 / 0.02 * 0.001 * (1 + 1e-9)
        q, qd = q + 0.001 * following, following
    assert qd[0] == 0
    assert 0.9 < q[0] <= 1.0


def test_no_limit_is_ever_broken():
    ends = []
    for result in random_rollouts(24, seed=8, torque_limits=True):
        assert broken_limits(result) == 0
        assert result.torque_ratio_max <= 1
        assert result.braked_steps < 0.1 * result.steps + 10
        assert not result.rows["qd"][-1].any()
        ends.append(result.reason)
    assert "" in ends


def test_the_bare_hit_is_as_good_as_without(limited):
    impact = limited.impact
    assert limited.reason == ""
    assert impact.miss <= 2e-3
    assert impact.direction_error <= 2
    assert impact.flux == pytest.approx(0.4, rel=0.01)
    assert limited.rows["scaling"][0] < 0.5  # it takes time to speed up
    assert limited.saturated_steps > 0


def test_the_torques_are_those_of_another_engine(limited, arm):
    """MuJoCo's inverse dynamics, of a model made from the links' inertias one by one."""
    mujoco = pytest.importorskip("mujoco")
    robot = arm("panda")
    spec = mujoco.MjSpec()
    spec.compiler.autolimits = False
    body = spec.worldbody
    for i in range(1, robot.n + 1):
        at, inertia = robot.model.jointPlacements[i], robot.model.inertias[i]
        quaternion = np.zeros(4)
        mujoco.mju_mat2Quat(quaternion, np.ascontiguousarray(at.rotation).ravel())
        I = inertia.inertia  # noqa: E741
        body = body.add_body(pos=at.translation, quat=quaternion, explicitinertial=True)
        body.mass, body.ipos = inertia.mass, inertia.lever
        body.fullinertia = [I[0, 0], I[1, 1], I[2, 2], I[0, 1], I[0, 2], I[1, 2]]
        body.add_joint(axis=[0, 0, 1])
    model = spec.compile()
    data = mujoco.MjData(model)
    q, qd, torque = (limited.rows[name] for name in ("q", "qd", "torque"))
    before = np.vstack([np.zeros(robot.n), qd[:-1]])
    for i in range(0, len(q), 7):
        data.qpos, data.qvel, data.qacc = q[i], before[i], (qd[i] - before[i]) / limited.dt
        mujoco.mj_inverse(model, data)
        np.testing.assert_allclose(data.qfrc_inverse, torque[i], atol=1e-6)


def test_same_input_same_bits(limited, arm):
    again = rollout(arm("panda"), limited.hit, torque_limits=True)
    for name, values in limited.rows.items():
        assert values.tobytes() == again.rows[name].tobytes(), name


def test_measured_velocities_are_used(arm):
    robot, hit = arm("panda"), Hit(6, OBJECT, ALONG, 2.0, 0.4)
    q = rollout(robot, hit, torque_limits=True).rows["q"][0]
    control = Controller(robot, hit, q, torque_limits=True)
    rest = control.step(q)
    moving = Controller(robot, hit, q, torque_limits=True).step(q, 0.5 * robot.velocity_upper)
    assert np.abs(moving - rest).max() > 0.1
    with pytest.raises(InputError, match="qd"):
        control.step(q, np.full(7, np.nan))


def test_a_locked_joint_stays(arm, tmp_path):
    path = tmp_path / "locked.urdf"
    parts = arm("iiwa14").xml.split("velocity=")
    value, rest = parts[3].split(" ", 1) if " " in parts[3][:24] else parts[3].split("/", 1)
    assert float(value.strip('"')) > 1
    parts[3] = f'"0" {rest}' if not rest.startswith(">") else f'"0"/{rest}'
    path.write_text("velocity=".join(parts))
    robot = hj.load_robot(path)
    assert robot.velocity_upper[2] == 0
    q0 = arm("iiwa14").home
    target = hj.position(robot, q0, 7) + 0.1 * ALONG
    result = rollout(robot, Hit(7, target, ALONG, 1.0, 0.2), q0=q0, torque_limits=True)
    assert (result.rows["qd"][:, 2] == 0).all()
    assert broken_limits(result) == 0
    assert result.impact is not None


def test_what_cannot_be_limited_is_refused(urdf, arm):
    hit = Hit(hj.Contact(1, (0.2, 0.0, 0.0)), [0.1, 0.1, 0.0], ALONG, 0.5, 0.1)
    with pytest.raises(InputError, match=r"joint 1: 0\.0"):
        Controller(spinner(urdf, 0.0), hit, [0.0], posture=[0.0], torque_limits=True)
    with pytest.raises(InputError, match="law"):
        Controller(
            arm("iiwa14"), Hit(6, OBJECT, ALONG, 2.0, 0.3), np.zeros(7), law="paper",
            torque_limits=True,
        )  # fmt: skip


def test_an_arm_that_cannot_hold_itself_is_refused(urdf):
    link = urdf.link("l1", 2.0, (0.5, 0, 0))
    robot = urdf.load(urdf.base, link, urdf.joint("j1", "base", "l1", axis="0 -1 0"))
    contact = hj.Contact(1, (0.4, 0.0, 0.0))
    hit = Hit(contact, hj.position(robot, [0.3], contact), [0, 0, 1], 1.0, 0.1)
    with pytest.raises(InfeasibleError, match=r"gravity asks 9\.81 N m of joint 1"):
        rollout(robot, hit, q0=[0.0], torque_limits=True)


def test_a_way_to_rest_that_asks_for_too_much_between_its_moments(monkeypatch):
    """The one of a thousand random rollouts that needs the nearest step."""
    monkeypatch.setattr(
        "tests.oracles.random_rollouts.rollout", lambda *given, **options: (given, options)
    )
    given, options = next(islice(random_rollouts(999, torque_limits=True), 998, None))
    nearest, taken = Brake._nearest, []
    monkeypatch.setattr(Brake, "_nearest", lambda *its: taken.append(nearest(*its)) or taken[-1])
    result = rollout(*given, **options)
    assert len(taken) > 0
    assert broken_limits(result) == 0


def test_the_nearest_step_that_the_motors_can_make(arm):
    """Against SciPy's SLSQP, for ways to rest that ask for more torque than there is."""
    robot = arm("panda")
    limits, rng = TorqueLimits(robot, 0.002), np.random.default_rng(5)
    brake = Brake(robot, limits)
    tight = 0
    for _ in range(30):
        q = rng.uniform(robot.lower, robot.upper)
        qd = rng.uniform(0.5, 1.0, robot.n) * robot.velocity_upper * rng.choice([-1, 1], robot.n)
        impulses = limits.impulses(q, qd)
        wanted = 0.5 * qd
        if impulses.allow(wanted):
            continue
        within = robot.lower, robot.upper, robot.velocity_lower, robot.velocity_upper
        low, high = step_bounds(q, *within, 0.002)
        found = brake._nearest(wanted, impulses, low, high)
        assert (np.abs(found) <= robot.velocity_upper).all()
        torque = (impulses.M @ found + impulses.b) / 0.002
        assert (np.abs(torque) <= robot.effort).all()
        rows = np.vstack((impulses.M, -impulses.M))
        room = np.concatenate((impulses.limit - impulses.b, impulses.limit + impulses.b))
        best = minimize(
            lambda x, wanted=wanted: np.sum((x - wanted) ** 2) / 2,
            found + rng.normal(0, 0.01, robot.n),
            jac=lambda x, wanted=wanted: x - wanted,
            bounds=list(zip(low, high, strict=True)),
            constraints={
                "type": "ineq",
                "fun": lambda x, A=rows, b=room: b - A @ x,
                "jac": lambda x, A=rows: -A,
            },
            method="SLSQP",
            options={"ftol": 1e-14, "maxiter": 300},
        )
        assert best.success
        np.testing.assert_allclose(found, best.x, atol=1e-6)
        tight += 1
    assert tight > 10
