"""The impact in the engine: rigid impact by Pinocchio, momentum, energy, an eccentric box."""

from dataclasses import replace

import mujoco
import numpy as np
import pinocchio as pin
import pytest

from hitjoints.dynamics.kinematics import jacobian, position
from hitjoints.errors import InputError, SolverError
from hitjoints.evidence.physics.engine_scene import build_scene
from hitjoints.evidence.physics.first_touch import ImpactState
from hitjoints.evidence.physics.setting import EngineSetting, setting
from hitjoints.evidence.physics.simulation import simulate
from hitjoints.evidence.physics.slide import slide
from hitjoints.evidence.physics.strike import strike
from hitjoints.hit import Hit
from hitjoints.model.engine import engine
from hitjoints.model.robot import Contact

MASS = 2.0


def impact_of(robot, joint=7, offset=(0.0, 0.0, 0.1), seed=0, speed=0.8, h=(0.0, 1.0, 0.0)):
    """Return an arm that hits along h with a speed, its other motion random and as it comes."""
    rng, h = np.random.default_rng(seed), np.array(h)
    q = robot.home + rng.uniform(-0.2, 0.2, robot.n)
    contact = Contact(joint, offset)
    g = h @ jacobian(robot, q, contact)
    qd = rng.uniform(-0.3, 0.3, robot.n)
    qd += g * (speed - g @ qd) / (g @ g)
    return ImpactState(contact, h, MASS, q, qd, position(robot, q, contact))


def free(robot, impact, how):
    """Strike with nothing acting on the arm but the contact."""
    return strike(robot, impact, how, lambda time: impact.qd)


def rigid(robot, impact, restitution):
    """Return the speeds of arm and object after an impact of Pinocchio: arm and a sliding body."""
    model, h, n = robot.model.copy(), impact.direction, robot.n
    body = model.addJoint(0, pin.JointModelPrismaticUnaligned(h), pin.SE3.Identity(), "object")
    model.appendBodyToJoint(
        body, pin.Inertia(impact.mass, np.zeros(3), np.eye(3)), pin.SE3.Identity()
    )
    q, before = np.append(impact.q, 0.0), np.append(impact.qd, 0.0)
    g = np.append(h @ jacobian(robot, impact.q, impact.contact), -1.0)
    after = pin.impulseDynamics(model, model.createData(), q, before, g[None], restitution, 0.0)
    return g[:n] @ after[:n], after[n]


@pytest.mark.parametrize("name", ["iiwa14", "panda", "xarm7"])
@pytest.mark.parametrize("restitution", [0.0, 0.4, 1.0])
def test_the_rigid_impact_of_pinocchio(arm, name, restitution):
    robot = arm(name)
    for joint in (5, 6, 7):
        impact = impact_of(robot, joint, seed=joint)
        found = free(robot, impact, EngineSetting(restitution))
        after, thrown = rigid(robot, impact, restitution)
        assert found.object_speed == pytest.approx(thrown, rel=2e-3)
        assert found.rebound == pytest.approx(after - 0.8, rel=5e-3)
        assert found.restitution == pytest.approx(restitution, abs=2e-3)
        assert found.contact_time == pytest.approx(1e-4, rel=0.02) or restitution == 0


def test_a_shorter_contact_is_nearer_to_the_rigid_impact(arm):
    # The arm moves on during the contact, and its inertia and speed change with it.
    robot = arm("iiwa14")
    impact = impact_of(robot)
    after, thrown = rigid(robot, impact, 0.5)
    inertia = -MASS * thrown / (after - 0.8)
    off = [
        abs(free(robot, impact, EngineSetting(contact_time=time)).inertia / inertia - 1)
        for time in (8e-3, 2e-3, 5e-4)
    ]
    assert off[0] > 2 * off[1] > 4 * off[2]


@pytest.mark.parametrize("restitution", [0.2, 0.7, 1.0])
def test_momentum_and_energy_of_the_contact(arm, restitution):
    robot = arm("iiwa14")
    impact = impact_of(robot)
    found = free(robot, impact, EngineSetting(restitution))
    # The engine applies the force of a row until the next one.
    force = found.rows["force"][:-1] * np.diff(found.rows["time"])
    assert force.sum() == pytest.approx(MASS * found.object_speed, rel=1e-6)
    # What the contact takes up and does not give back: (1 - eps^2) of the energy of approach.
    closing = found.rows["robot_speed"] - found.rows["object_speed"]
    lost = force @ (closing[:-1] + closing[1:]) / 2
    reduced = found.inertia * MASS / (found.inertia + MASS)
    approach = reduced * 0.8**2 / 2
    assert lost == pytest.approx((1 - restitution**2) * approach, abs=0.01 * approach)


@pytest.mark.parametrize("off", [0.01, -0.03])
def test_an_eccentric_hit_moves_less_of_the_box(arm, off):
    # The box turns too: at the contact it weighs m / (1 + off^2 / k^2), k its radius of gyration.
    robot, size = arm("iiwa14"), (0.1, 0.2, 0.1)
    impact = impact_of(robot)
    central, aside = (
        free(robot, impact, EngineSetting(0.5, size, off_centre=value)) for value in (0.0, off)
    )
    felt = MASS / (1 + off**2 / ((size[0] ** 2 + size[1] ** 2) / 12))
    inertia = central.inertia
    ratio = felt / (inertia + felt) / (MASS / (inertia + MASS))
    assert aside.object_speed / central.object_speed == pytest.approx(ratio, rel=2e-3)
    assert aside.inertia == pytest.approx(inertia, rel=2e-3)
    assert aside.restitution == pytest.approx(0.5, abs=2e-3)


def test_any_direction_and_the_point_behind_the_contact(arm):
    robot = arm("iiwa14")
    for h in ((0.0, 0.0, -1.0), (0.6, 0.0, 0.8)):
        impact = impact_of(robot, h=h)
        found = free(robot, impact, EngineSetting(0.5))
        assert found.object_speed == pytest.approx(rigid(robot, impact, 0.5)[1], rel=2e-3)
        np.testing.assert_allclose(impact.axes.T @ impact.axes, np.eye(3), atol=1e-12)
        assert np.linalg.det(impact.axes) == pytest.approx(1)


def test_a_servo_makes_the_arm_heavier(arm):
    robot = arm("iiwa14")
    impact = impact_of(robot)
    how = EngineSetting(contact_time=0.01)
    gains = [free(robot, impact, replace(how, servo_gain=gain)).inertia for gain in (0, 20, 100)]
    assert gains[0] < gains[1] < gains[2]


def test_a_servo_is_as_strong_as_its_motor(arm):
    robot = arm("iiwa14")
    model, data = build_scene(robot, impact_of(robot), EngineSetting(servo_gain=1000.0))
    data.ctrl[:] = 100.0
    mujoco.mj_forward(model, data)
    np.testing.assert_allclose(data.qfrc_actuator[: robot.n], robot.effort)


def test_friction_drags_the_box_along_sideways(arm):
    # Sliding all the time, so Coulomb's law with its equality: the share mu of the impulse.
    robot, friction = arm("iiwa14"), 0.1
    impact = impact_of(robot)
    jac = jacobian(robot, impact.q, impact.contact)
    wanted = impact.axes @ np.array([0.8, 1.5, 0.0])
    impact = replace(impact, qd=np.linalg.lstsq(jac, wanted)[0])
    found = free(robot, impact, EngineSetting(0.5, contact_friction=friction))
    forward, sideways, _ = impact.axes.T @ found.box[1][:3]
    assert sideways / forward == pytest.approx(friction, rel=0.02)


def test_the_table_takes_its_part_of_the_impulse(arm):
    robot, time, friction = arm("iiwa14"), 0.02, 0.5
    how = EngineSetting(friction=friction, contact_time=time, on_table=True)
    found = free(robot, impact_of(robot), how)
    impulse = found.rows["force"][:-1] @ np.diff(found.rows["time"])
    lost = friction * MASS * 9.81 * found.contact_time
    assert impulse - MASS * found.object_speed == pytest.approx(lost, rel=0.1)


@pytest.mark.parametrize(("speed", "friction"), [(0.3, 0.3), (1.0, 0.2), (1.7, 0.6), (2.5, 0.4)])
def test_a_sliding_box_stops_where_friction_stops_it(arm, speed, friction):
    impact = impact_of(arm("iiwa14"), h=(0.6, 0.8, 0.0))
    how = EngineSetting(friction=friction)
    quaternion = pin.Quaternion(impact.axes).coeffs()[[3, 0, 1, 2]]
    pose = np.concatenate((impact.box_centre(how), quaternion))
    found = slide(impact, how, pose, np.concatenate((speed * impact.direction, np.zeros(3))))
    way = found.rows["slide_position"][-1] - pose[:3]
    assert impact.direction @ way == pytest.approx(speed**2 / (2 * friction * 9.81), rel=0.015)


def test_what_a_mode_sets_and_what_is_asked_for_instead():
    assert setting("ideal") == EngineSetting()
    assert setting("ideal").causes() == []
    realistic = setting("realistic", servo_gain=0.0)
    assert realistic.contact_time == 0.01
    assert [cause[0] for cause in realistic.causes()] == [
        "contact time", "contact friction", "off-centre", "table",
    ]  # fmt: skip
    name, value, alone, without = realistic.causes()[0]
    assert (name, value) == ("contact time", 0.01)
    assert alone == EngineSetting(contact_time=0.01)
    assert without == replace(realistic, contact_time=EngineSetting().contact_time)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("restitution", 1.5), ("restitution", -0.1), ("restitution", float("nan")),
        ("size", (0.1, 0.1)), ("size", (0.1, 0.0, 0.1)), ("size", (0.1, float("inf"), 0.1)),
        ("friction", -0.1), ("friction", float("nan")), ("servo_gain", -1.0), ("servo_gain", 2e4),
        ("contact_friction", float("inf")), ("contact_time", 1e-7), ("contact_time", 0.06),
        ("contact_time", float("nan")), ("off_centre", 0.05), ("off_centre", float("nan")),
    ],
)  # fmt: skip
def test_what_cannot_be_set(name, value):
    with pytest.raises(InputError, match=f"^{name} = "):
        setting("ideal", **{name: value})


def test_an_unknown_mode_lists_the_known_ones():
    with pytest.raises(InputError, match="ideal, realistic"):
        setting("perfect")


def test_the_engine_writes_no_files_of_its_own(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    mujoco = engine()
    model = mujoco.MjModel.from_xml_string(
        '<mujoco><worldbody><body><freejoint/><geom size="1"/></body></worldbody></mujoco>'
    )
    data = mujoco.MjData(model)
    data.qvel[:] = 1e300
    mujoco.mj_step(model, data)
    assert data.warning.number.sum() > 0
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("edges", [(1e-3, 1e-3, 1e-3), (10.0, 10.0, 10.0)])
def test_the_smallest_and_the_largest_boxes(arm, edges):
    """At both ends of what is allowed the prediction holds."""
    result = simulate(arm("iiwa14"), Hit(6, (0.5, 0.3, 0.5), (0, 1, 0), 2.0, 0.3), size=edges)
    assert abs(result.errors["object_speed"]) < 0.01
    assert abs(result.errors["inertia"]) < 0.01


def test_a_lost_state_is_told(arm):
    """The engine must not go on from the beginning with a state that is none."""
    state = np.zeros(7)
    state[3] = 1.0
    with pytest.raises(SolverError, match="the engine loses the box"):
        slide(impact_of(arm("iiwa14")), setting("ideal"), state, np.full(6, 1e300))
