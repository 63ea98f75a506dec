"""The robots that come with hitjoints hold the published numbers, and nothing else."""

import re
import tomllib
import warnings
from importlib import resources
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from hitjoints.loading.catalogue import robot_names
from hitjoints.loading.check import check_arm
from hitjoints.loading.load import load_robot, read_arm
from hitjoints.loading.source import describe

OWN = ["iiwa14", "iiwa14_bullet", "iiwa7"]
ALL = [*OWN, "panda", "xarm7"]
FACTS = Path(__file__).parents[1] / "data" / "robots"
CENTIMETRE = 0.01


def own_urdf(name):
    return (resources.files("hitjoints.robots") / f"{name}.urdf").read_text()


def numbers(text):
    return np.array([float(word) for word in text.split()])


def test_names():
    assert set(robot_names()) > set(ALL)
    assert len(robot_names()) >= 25


@pytest.mark.parametrize("name", ALL)
def test_loads_without_a_warning(name):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        robot = load_robot(name)
    assert robot.name == name
    assert robot.n == 7
    assert robot.hitting_joints == (5, 6, 7)
    assert robot.title
    assert robot.licence
    assert robot.source
    assert (robot.lower < robot.home).all()
    assert (robot.home < robot.upper).all()
    assert (robot.velocity_upper > 0).all()
    np.testing.assert_array_equal(robot.velocity_lower, -robot.velocity_upper)
    np.testing.assert_array_equal(robot.model.armature, 0)
    assert all(issue.severity != "error" for issue in check_arm(read_arm(describe(name)), robot))


@pytest.mark.parametrize("name", OWN)
def test_model_holds_the_published_numbers(arm, name):
    facts = tomllib.loads((FACTS / f"{name}.toml").read_text())
    robot = arm(name)
    assert len(facts["joint"]) == robot.n
    for k, joint in enumerate(facts["joint"], start=1):
        limit = np.deg2rad(joint["position_limit_deg"])
        assert robot.upper[k - 1] == pytest.approx(limit, rel=1e-15)
        assert robot.lower[k - 1] == -robot.upper[k - 1]
        speed = np.deg2rad(joint["velocity_limit_deg_s"])
        assert robot.velocity_upper[k - 1] == pytest.approx(speed, rel=1e-15)
        assert robot.effort[k - 1] == joint["torque_limit"]
        body = robot.model.inertias[k]
        assert body.mass == joint["link_mass"]
        np.testing.assert_allclose(body.lever, joint["link_com"], rtol=0, atol=1e-16)
        i = joint["link_inertia_com"]
        tensor = [
            [i["ixx"], i["ixy"], i["ixz"]],
            [i["ixy"], i["iyy"], i["iyz"]],
            [i["ixz"], i["iyz"], i["izz"]],
        ]
        np.testing.assert_allclose(body.inertia, tensor, rtol=1e-12, atol=1e-16)
        placed = robot.model.jointPlacements[k]
        np.testing.assert_array_equal(placed.translation, joint["origin_xyz"])
    assert robot.flange.joint == facts["flange"]["parent_joint"]
    assert list(robot.flange.offset) == facts["flange"]["xyz"]


@pytest.mark.parametrize("name", OWN)
def test_urdf_text_holds_the_published_numbers(name):
    facts = tomllib.loads((FACTS / f"{name}.toml").read_text())
    root = ElementTree.fromstring(own_urdf(name))
    joints = {joint.get("name"): joint for joint in root.findall("joint")}
    links = {link.get("name"): link for link in root.findall("link")}
    assert len(joints) == 8
    for fact in facts["joint"]:
        joint = joints[f"joint_{fact['index']}"]
        origin, link = joint.find("origin"), links[f"link_{fact['index']}"]
        np.testing.assert_array_equal(numbers(origin.get("xyz")), fact["origin_xyz"])
        turn = numbers(origin.get("rpy"))
        np.testing.assert_array_equal(turn, np.pi * np.array(fact["origin_rpy_in_pi"]))
        np.testing.assert_array_equal(numbers(joint.find("axis").get("xyz")), fact["axis"])
        tensor = link.find("inertial/inertia")
        assert {k: float(v) for k, v in tensor.items()} == fact["link_inertia_com"]
        assert "rpy" not in link.find("inertial/origin").keys()  # noqa: SIM118
    flange = joints["flange_joint"].find("origin")
    np.testing.assert_array_equal(numbers(flange.get("xyz")), facts["flange"]["xyz"])


@pytest.mark.parametrize("name", OWN)
def test_base_and_flange_carry_no_inertia(name):
    links = {link.name: link for link in read_arm(describe(name)).links}
    for link in ("link_0", "flange"):
        assert links[link].mass == 0
        assert not links[link].inertia.any()


def cylinder_extent(collision):
    """Return the least and greatest coordinates of a <collision> cylinder in its link's frame."""
    cylinder = collision.find("geometry/cylinder")
    radius, length = float(cylinder.get("radius")), float(cylinder.get("length"))
    centre = numbers(collision.find("origin").get("xyz"))
    roll, pitch, yaw = numbers(collision.find("origin").get("rpy"))
    assert pitch == yaw == 0
    axis = np.array([0, -np.sin(roll), np.cos(roll)])
    half = length / 2 * abs(axis) + radius * np.sqrt(np.maximum(0, 1 - axis**2))
    return centre - half, centre + half


def test_collision_shapes_lie_within_the_links():
    extents = tomllib.loads((FACTS / "iiwa14.toml").read_text())["link_extents"]
    root = ElementTree.fromstring(own_urdf("iiwa14"))
    for link in root.findall("link"):
        shapes = link.findall("collision")
        if link.get("name") == "flange":
            assert not shapes
            continue
        boxes = [cylinder_extent(shape) for shape in shapes]
        low, high = (np.array(side) for side in extents[link.get("name")])
        least = np.min([box[0] for box in boxes], axis=0)
        most = np.max([box[1] for box in boxes], axis=0)
        assert (least > low - CENTIMETRE).all(), link.get("name")
        assert (most < high + CENTIMETRE).all(), link.get("name")
        # ... and reach where the link does: a shape too small would let hits pass unseen. The
        # plug at the back of the base is the one part left out.
        slack = np.where(link.get("name") == "link_0", 0.02, CENTIMETRE)
        assert (least < low + slack).all(), link.get("name")
        assert (most > high - slack).all(), link.get("name")


@pytest.mark.parametrize("name", OWN)
def test_collision_shapes_are_primitives_coal_can_measure(arm, name):
    coal = pytest.importorskip("coal")
    import pinocchio as pin

    robot = arm(name)
    geometry = robot.collision_model
    assert {type(shape.geometry).__name__ for shape in geometry.geometryObjects} == {"Cylinder"}
    data = pin.GeometryData(geometry)
    pin.updateGeometryPlacements(robot.model, robot.data, geometry, data, robot.home)
    base, tip = 0, geometry.ngeoms - 1
    shapes = geometry.geometryObjects
    result = coal.DistanceResult()
    distance = coal.distance(
        shapes[base].geometry,
        coal.Transform3s(data.oMg[base].rotation, data.oMg[base].translation),
        shapes[tip].geometry,
        coal.Transform3s(data.oMg[tip].rotation, data.oMg[tip].translation),
        coal.DistanceRequest(),
        result,
    )
    apart = np.linalg.norm(data.oMg[base].translation - data.oMg[tip].translation)
    assert 0.1 < distance < apart


@pytest.mark.parametrize("name", ["panda", "xarm7"])
def test_collision_meshes_of_example_robot_data_are_found(arm, name):
    assert arm(name).collision_model.ngeoms >= 8


@pytest.mark.parametrize("name", ["iiwa14", "iiwa7"])
def test_mujoco_reads_the_urdf_and_finds_the_same_mass_matrix(arm, name):
    mujoco = pytest.importorskip("mujoco")
    import pinocchio as pin

    robot = arm(name)
    model = mujoco.MjModel.from_xml_string(robot.xml)
    data = mujoco.MjData(model)
    assert model.nv == robot.n
    assert model.ngeom == robot.collision_model.ngeoms
    rng = np.random.default_rng(0)
    for q in rng.uniform(robot.lower, robot.upper, (20, robot.n)):
        data.qpos[:] = q
        mujoco.mj_forward(model, data)
        found = np.zeros((robot.n, robot.n))
        mujoco.mj_fullM(model, data, found)
        expected = pin.crba(robot.model, robot.model.createData(), q)
        # MuJoCo turns each tensor into principal axes, to about 1e-9.
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-8)


def test_panda_holds_its_fingers(arm):
    robot = arm("panda")
    assert robot.joint_names == [f"panda_joint{k}" for k in range(1, 8)]
    # Hand and fingers ride on link 7.
    assert robot.model.inertias[7].mass > 0.73
    assert robot.flange.offset == (0, 0, 0.107)


def test_facts_of_the_drives(arm):
    known = {"acceleration": "iiwa14 iiwa7 panda", "jerk": "panda", "rotor_inertia": "iiwa14 panda"}
    for key in ("acceleration", "jerk", "rotor_inertia", "joint_stiffness"):
        having = [name for name in ALL if getattr(arm(name), key) is not None]
        assert having == known.get(key, "").split()
        assert all(arm(name).provenance[key] for name in having)
    # Reflected through the gears: the ratio squared times the motor's inertia.
    motors = 160**2 * np.array([1.321e-4] * 4 + [0, 4.54e-5, 4.54e-5])
    motors[4] = 100**2 * 1.321e-4
    np.testing.assert_allclose(arm("iiwa14").rotor_inertia, motors, rtol=1e-14)
    # The jerk limits of the Panda are reached in 2 ms.
    np.testing.assert_allclose(arm("panda").jerk * 0.002, arm("panda").acceleration)


def test_sources_name_where_the_numbers_come_from(arm):
    for name in ALL:
        assert re.search(r"iiwa|example-robot-data", arm(name).source)
