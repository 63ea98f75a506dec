"""Every collision shape that is written is built as urdfdom would, or told."""

from __future__ import annotations

import pickle

import numpy as np
import pinocchio as pin
import pytest

import hitjoints as hj
from hitjoints.loading.catalogue import erd_directory
from hitjoints.loading.load import load_robot
from hitjoints.model.collision_shapes import read_shapes
from hitjoints.model.urdf import read_urdf
from hitjoints.model.urdf_text import urdf_text

X = [1, 0, 0]
BALL = '<collision><geometry><sphere radius="0.05"/></geometry></collision>'
BOX = '<collision><origin xyz="0 0 0.1"/><geometry><box size="0.4 0.4 0.1"/></geometry></collision>'
CAPSULE = '<collision><geometry><capsule radius="0.2" length="0.1"/></geometry></collision>'
MESH = '<collision><geometry><mesh filename="a.obj"/></geometry></collision>'
PYRAMID = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"


def where(path):
    """A place that joint 4 reaches, as an option."""
    at = hj.position(load_robot(path), [0.5, 0.6, 0.3, 0.4, 0.0], 5)
    return "--object=" + ",".join(f"{v:.6f}" for v in at)


def arm_text(shape, n=5):
    """n joints 0.2 m apart upwards, balls on links 1 and n, the shape on link 3."""
    inertial = (
        '<mass value="1"/><inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/>'
    )
    shapes = {1: BALL, 3: shape, n: BALL}
    links = "".join(
        f'<link name="l{i}"><inertial>{inertial}</inertial>{shapes.get(i, "")}</link>'
        for i in range(n + 1)
    )
    joints = "".join(
        f'<joint name="j{i}" type="revolute"><parent link="l{i - 1}"/><child link="l{i}"/>'
        f'<origin xyz="0 0 0.2"/><axis xyz="{"0 0 1" if i % 2 else "0 1 0"}"/>'
        '<limit lower="-2" upper="2" velocity="2" effort="50"/></joint>'
        for i in range(1, n + 1)
    )
    return f'<robot name="shapes">{links}{joints}</robot>'


@pytest.fixture
def write(tmp_path):
    def call(shape, folder=".", **files):
        place = tmp_path / folder
        place.mkdir(exist_ok=True)
        for name, text in files.items():
            (place / f"{name}.obj").write_text(text)
        path = place / "arm.urdf"
        path.write_text(arm_text(shape))
        return path

    return call


@pytest.mark.parametrize("name", ["iiwa14", "panda", "xarm7", "ur5_robot", "z1"])
def test_shapes_are_those_of_urdfdom(arm, name):
    robot = arm(name)
    folders = [str(erd_directory().parent.parent)]
    kind = pin.GeometryType.COLLISION
    theirs = pin.buildGeomFromUrdfString(robot.model, robot.xml, kind, None, folders)
    mine = robot.collision_model
    assert [one.name for one in mine.geometryObjects] == [o.name for o in theirs.geometryObjects]
    for a, b in zip(mine.geometryObjects, theirs.geometryObjects, strict=True):
        assert (a.parentJoint, a.parentFrame) == (b.parentJoint, b.parentFrame)
        np.testing.assert_allclose(a.placement.homogeneous, b.placement.homogeneous, atol=1e-15)
        for solid in (a.geometry, b.geometry):
            solid.computeLocalAABB()
        np.testing.assert_array_equal(a.geometry.aabb_local.min_, b.geometry.aabb_local.min_)
        np.testing.assert_array_equal(a.geometry.aabb_local.max_, b.geometry.aabb_local.max_)


def test_shapes_do_not_change_the_model(arm):
    tree = read_urdf(arm("panda").xml, "panda")
    whole, bare = (pin.buildModelFromXML(urdf_text(tree, shapes=s)) for s in (True, False))
    assert whole == bare


@pytest.mark.parametrize("shape", [BOX, BOX.replace('0.1"/></geom', ' 0.1 "/></geom')])
def test_a_box_however_it_is_spaced(write, shape):
    robot = load_robot(write(shape))
    found = hj.clearance(robot, robot.home, 5, X, table_height=0.45)
    assert robot.collision_model.ngeoms == 3
    # Link 3 begins at 0.6 m: its box spans 0.65 to 0.75; the ball of link 5 ends at 0.95.
    assert found.table == pytest.approx(0.2, abs=1e-9)
    assert found.itself == pytest.approx(0.2, abs=1e-9)


def test_a_capsule_is_a_cylinder_with_caps(write):
    robot = load_robot(write(CAPSULE))
    found = hj.clearance(robot, robot.home, 5, X, table_height=0.1)
    assert found.table == pytest.approx(0.6 - 0.05 - 0.2 - 0.1, abs=1e-9)


FAULTS = {
    "origin xyz = '0 0 0,1' is not 3 finite numbers": BOX.replace("0 0 0.1", "0 0 0,1"),
    "origin rpy = '0 0' is not 3": BOX.replace('xyz="0 0 0.1"', 'rpy="0 0"'),
    "box size = '0.4 0.4' is not 3": BOX.replace("0.4 0.4 0.1", "0.4 0.4"),
    "box size = -0.4 -0.4 0.1 must be above zero": BOX.replace("0.4 0.4", "-0.4 -0.4"),
    "box size = '0.4 nan 0.1'": BOX.replace("0.4 0.4", "0.4 nan"),
    "sphere radius = -0.2 must be above zero": BALL.replace("0.05", "-0.2"),
    "sphere radius = 0 must be above zero": BALL.replace("0.05", "0"),
    "sphere radius = '1e300' is larger than any arm": BALL.replace("0.05", "1e300"),
    "origin xyz = '0 0 -1e9' is larger than any arm": BOX.replace("0 0 0.1", "0 0 -1e9"),
    "sphere has no radius": BALL.replace("radius", "diameter"),
    "cylinder has no length": BALL.replace("sphere", "cylinder"),
    "capsule radius length = 0.2 -0.1 must be above zero": CAPSULE.replace('"0.1"', '"-0.1"'),
    "mesh scale = '1 1' is not 3": MESH.replace("/></geom", ' scale="1 1"/></geom'),
    "mesh scale = '1 0 1' flattens it": MESH.replace("/></geom", ' scale="1 0 1"/></geom'),
    "a <mesh> has no filename": MESH.replace("filename", "file"),
    "mesh a.obj not found": MESH,
    "<cone> is none of box": BALL.replace("sphere", "cone"),
    "one solid in its <geometry>, not 0": "<collision><geometry/></collision>",
    "one solid in its <geometry>, not 2": BALL.replace("<sphere", "<sphere/><sphere"),
}


@pytest.mark.parametrize("reason", FAULTS)
def test_what_cannot_be_read_is_told_and_never_left_out(write, run, reason):
    path = write(FAULTS[reason])
    robot = load_robot(path)
    assert robot.shape_faults[0][0] == "l3"
    assert reason in robot.shape_faults[0][1]
    with pytest.raises(hj.ModelError, match="cannot be read"):
        hj.clearance(robot, robot.home, 5, X)
    told = run("robots", "check", path, "--json").json["issues"]
    assert [one["link"] for one in told if reason in one["problem"]] == ["l3"]


@pytest.mark.parametrize("reason", FAULTS)
def test_no_line_but_ours_is_printed(write, reason, capfd):
    robot = load_robot(write(FAULTS[reason]))
    assert robot.shape_faults
    assert capfd.readouterr() == ("", "")


def test_a_plan_says_that_clearance_is_not_known_and_why(write, run):
    path = write(FAULTS["mesh a.obj not found"])
    line = ["--joint", "5", where(path), "--no-certificate", "--no-away"]
    printed = run("plan", "--robot", path, *line)
    assert printed.code == 0
    assert "clearance not known: the collision shape of l3 cannot be read: mesh a.obj" in (
        printed.out
    )
    best = run("plan", "--robot", path, *line, "--json").json["best"]
    assert "mesh a.obj not found" in best["clearance"]["not_known"]
    refused = run("plan", "--robot", path, *line, "--margin", "0.01")
    assert refused.code == 1
    assert "mesh a.obj not found" in refused.err


def test_two_arms_of_one_text_have_each_their_own_meshes(write):
    here, there = (
        load_robot(write(MESH, folder, a=text))
        for folder, text in (("A", PYRAMID), ("B", PYRAMID.replace("v 0 0 1", "v 0 0 -0.5")))
    )
    table = [hj.clearance(r, r.home, 5, X, table_height=0.0).table for r in (here, there)]
    assert table == pytest.approx([0.6, 0.1], abs=1e-6)
    assert here != there
    assert here == pickle.loads(pickle.dumps(here))
    assert here.digest == there.digest  # kinematics and dynamics are the same


def test_a_mesh_written_anew_is_read_anew(write):
    found = []
    for height in ("-0.1", "-0.3"):
        robot = load_robot(write(MESH, a=PYRAMID.replace("v 0 0 1", f"v 0 0 {height}")))
        found.append(hj.clearance(robot, robot.home, 5, X, table_height=0.0).table)
    assert found == pytest.approx([0.5, 0.3], abs=1e-6)


def test_shapes_turned_in_their_link(write):
    turned = BOX.replace("0 0 0.1", '0 0 0.1" rpy="0 1.5707963267948966 0')
    robot = load_robot(write(turned))
    found = hj.clearance(robot, robot.home, 5, X, table_height=0.0)
    assert found.table == pytest.approx(0.7 - 0.2, abs=1e-9)


def test_links_of_one_name_in_names_of_shapes():
    shapes, faults = read_shapes(arm_text(BOX + BALL))
    assert [one.name for one in shapes] == ["l1_0", "l3_0", "l3_1", "l5_0"]
    assert faults == []
