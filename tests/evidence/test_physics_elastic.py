"""Motors on springs in the engine: they are what the closed form says, and it is their judge."""

import mujoco
import numpy as np
import pinocchio as pin
import pytest

import hitjoints as hj
from hitjoints.dynamics.kinematics import jacobian, position
from hitjoints.evidence.physics.engine_scene import build_scene
from hitjoints.evidence.physics.first_touch import ImpactState
from hitjoints.evidence.physics.setting import EngineSetting
from hitjoints.evidence.physics.strike import strike

K = 1e4


def state_of(robot, joint, seed, speed=0.5, mass=1.0):
    rng = np.random.default_rng(seed)
    q, contact = robot.home + rng.uniform(-0.4, 0.4, robot.n), hj.Contact(joint, (0.0, 0.0, 0.05))
    h = rng.normal(size=3)
    h /= np.linalg.norm(h)
    qd = np.linalg.pinv(jacobian(robot, q, contact)) @ (speed * h)
    return ImpactState(contact, h, mass, q, qd, position(robot, q, contact))


def elastic(robot, time, gain=0.0, eps=0.6):
    return EngineSetting(
        eps,
        contact_time=time,
        servo_gain=gain,
        stiffness=(K,) * robot.n,
        rotors=tuple(robot.rotor_inertia),
    )


def test_motors_are_bodies_of_their_own(arm):
    robot = arm("panda")
    state = state_of(robot, 6, 1)
    model, data = build_scene(robot, state, elastic(robot, 0.01))
    assert model.nv == 2 * robot.n + 6
    mujoco.mj_forward(model, data)
    whole = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, whole)
    motors = [model.joint(f"motor_{i + 1}").dofadr[0] for i in range(robot.n)]
    np.testing.assert_allclose(whole[np.ix_(motors, motors)], np.diag(robot.rotor_inertia))
    links = pin.crba(robot.model, robot.model.createData(), state.q)
    np.testing.assert_allclose(whole[: robot.n, : robot.n], links, rtol=1e-9, atol=1e-9)
    data.qpos[[model.joint(f"motor_{i + 1}").qposadr[0] for i in range(robot.n)]] += 1e-3
    mujoco.mj_forward(model, data)
    np.testing.assert_allclose(data.qfrc_passive[: robot.n], 1e-3 * K, rtol=1e-9)


@pytest.mark.parametrize(("time", "slack"), [(1e-3, 0.5), (5e-3, 0.6), (1e-2, 1.0)])
@pytest.mark.parametrize("gain", [0.0, 50.0])
def test_the_closed_form(arm, time, slack, gain):
    for name, joint in (("iiwa14", 7), ("iiwa14", 5), ("panda", 7)):
        robot = arm(name)
        state = state_of(robot, joint, joint)
        engine = strike(robot, state, elastic(robot, time, gain), lambda _, qd=state.qd: qd)
        told = hj.elastic_impact(
            robot, state.q, state.contact, state.direction, state.mass, 0.5, 0.6, time, K,
            servo=(0.0, gain), qd=state.qd,
        )  # fmt: skip
        assert told.object_speed == pytest.approx(engine.object_speed, rel=0.01 * slack)
        assert told.robot_speed == pytest.approx(0.5 + engine.rebound, abs=0.5 * 0.02 * slack)
        assert told.contact_time == pytest.approx(engine.contact_time, rel=0.02)


def test_what_is_left_goes_with_the_speed(arm):
    robot = arm("iiwa14")
    off = []
    for speed in (0.8, 0.08):
        state = state_of(robot, 7, 3, speed)
        engine = strike(robot, state, elastic(robot, 0.02), lambda _, qd=state.qd: qd)
        told = hj.elastic_impact(
            robot, state.q, state.contact, state.direction, 1.0, speed, 0.6, 0.02, K
        )
        off.append(abs(told.object_speed / engine.object_speed - 1))
    assert off[1] < 0.2 * off[0]


def test_an_arm_that_moves_on_is_taken_in_the_middle_of_the_contact(arm):
    robot = arm("iiwa14")
    random = np.random.default_rng(8)
    moved, still = [], []
    for seed in range(6):
        one = state_of(robot, 7, seed)
        own = random.normal(0, 0.5, robot.n)
        jac = jacobian(robot, one.q, one.contact)
        qd = one.qd + own - np.linalg.pinv(jac) @ jac @ own  # the arm moves, its contact does not
        state = ImpactState(one.contact, one.direction, one.mass, one.q, qd, one.point)
        engine = strike(robot, state, elastic(robot, 0.02), lambda _, qd=qd: qd)
        for off, motion in ((moved, qd), (still, None)):
            told = hj.elastic_impact(
                robot, one.q, one.contact, one.direction, 1.0, 0.5, 0.6, 0.02, K, qd=motion
            )
            off.append(
                (
                    told.object_speed / engine.object_speed - 1,
                    (told.robot_speed - 0.5 - engine.rebound) / 0.5,
                )
            )
    with_motion, without = np.abs(moved).mean(axis=0), np.abs(still).mean(axis=0)
    assert (with_motion < 0.4 * without).all()


def test_a_servo_is_felt_through_the_contact(arm):
    # A contact that holds the two bodies to their own motion would not yield to it.
    robot = arm("iiwa14")
    state = state_of(robot, 7, 2)
    how = EngineSetting(0.5, contact_time=0.01, servo_gain=1e3)
    held = strike(robot, state, how, lambda _: state.qd).object_speed
    free = strike(
        robot, state, EngineSetting(0.5, contact_time=0.01), lambda _: state.qd
    ).object_speed
    # Stiff servos at links without rotors: as the closed form has them.
    told = hj.elastic_impact(
        robot, state.q, state.contact, state.direction, 1.0, 0.5, 0.5, 0.01,
        servo=(0.0, 1e3), rotor_inertia=0.0, qd=state.qd,
    )  # fmt: skip
    assert held > 1.1 * free
    assert held == pytest.approx(told.object_speed, rel=0.01)


def test_simulate_elastic(run):
    found = run("simulate", "--elastic", "--json").json
    told, off = found["elastic"], found["elastic_errors"]
    assert found["contact_time"] == 0.01
    assert abs(off["object_speed"]) < 0.01
    assert abs(off["robot_speed"]) < 0.02
    assert told["equivalent"] > found["predicted"]["inertia"]
    assert {cause["cause"] for cause in found["shares"]} == {"contact time", "elastic joints"}
    assert run("simulate", "--json").json["elastic"] is None


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--stiffness", "1e4"), "stiffness = given: it belongs to elastic joints"),
        (("--elastic", "--robot", "xarm7"), "rotor_inertia"),
        (("--elastic", "--stiffness", "-1"), "stiffness = -1"),
    ],
)
def test_refusals(run, options, said):
    outcome = run("simulate", *options)
    assert outcome.code == 1
    assert said in outcome.err
