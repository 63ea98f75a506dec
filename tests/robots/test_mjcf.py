"""An MJCF is the arm that MuJoCo makes of it, and the arm of the URDF that says the same."""

import sys

import mujoco
import numpy as np
import pinocchio as pin
import pytest

import hitjoints as hj
from hitjoints.errors import MissingExtraError
from hitjoints.kernels.formulas.chain import joint_axes
from hitjoints.loading.load import load_robot

pytestmark = pytest.mark.filterwarnings("ignore::hitjoints.loading.load.ModelWarning")

BODY = '<inertial pos="0 0 0.1" mass="1" diaginertia="0.01 0.012 0.005"/>'
ODD = """<mujoco model="odd">
  <compiler angle="degree" eulerseq="zyx"/>
  <default><joint armature="0.1" damping="1"/>
    <default class="strong"><joint armature="0.2" actuatorfrcrange="-50 40"/></default></default>
  <worldbody>
    <geom type="plane" size="1 1 1"/>
    <body name="base" pos="0.1 0 0.2" euler="10 20 30">
      <geom type="box" size="0.1 0.1 0.1"/>
      <body name="l1" pos="0 0 0.2" axisangle="0 1 1 40">
        <inertial pos="0 0 0.1" mass="2" fullinertia="0.02 0.021 0.01 0.001 0.002 0.003"/>
        <joint name="j1" class="strong" axis="0 0 1" range="-100 100"/>
        <geom type="capsule" fromto="0 0 0 0.1 0 0.3" size="0.05"/>
        <body name="l2" pos="0 0 0.3" quat="0.9 0.1 0.2 0.3">
          <inertial pos="0.01 0 0.1" mass="1" diaginertia="0.01 0.02 0.015" quat="0.8 0.2 0.1 0.3"/>
          <joint name="j2" axis="0 1 0" pos="0.02 0 0.01" range="-90 90" ref="30"/>
          <joint name="j2b" axis="1 1 0" pos="0 0.03 0.05"/>
          <geom type="sphere" size="0.06" pos="0 0 0.1"/>
          <body name="l3" pos="0 0 0.3" xyaxes="0 1 0 -1 0 0">
            <joint name="j3" axis="1 1 0" type="slide" range="-0.1 0.2" ref="0.05"/>
            <geom type="cylinder" size="0.05 0.04" pos="0.01 0 0" density="500"/>
            <geom type="sphere" size="1" contype="0" conaffinity="0" mass="0"/>
            <site name="tcp" pos="0 0.1 0.2" euler="0 0 90"/>
            <body name="jaw"><joint name="grip" axis="0 0 1" type="slide" range="0 0.04"/>
              <geom type="box" size="0.01 0.01 0.01"/></body>
            <body name="jaw2"><joint name="grip2" axis="0 0 -1" type="slide" range="0 0.04"/>
              <geom type="box" size="0.01 0.01 0.01"/></body>
          </body>
        </body>
      </body>
    </body>
    <body name="ball" pos="1 0 0"><freejoint/><geom type="sphere" size="0.1"/></body>
  </worldbody>
  <equality><joint joint1="grip2" joint2="grip" polycoef="0 1 0 0 0"/></equality>
  <actuator><motor joint="j2" forcerange="-30 20" gear="2"/></actuator>
  <keyframe><key name="other" qpos="0 0 0 0 0 0 1 0 0 0 1 0 0"/>
    <key name="home" qpos="0.1 0.2 0.3 0.05 0 0 1 0 0 0 1 0 0"/></keyframe>
</mujoco>"""


def mujoco_model(text):
    model = mujoco.MjModel.from_xml_string(text)
    return model, mujoco.MjData(model)


def mass_matrix(model, data):
    M = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, M)
    return M


def test_mass_matrix_and_positions_are_mujocos():
    robot = load_robot(ODD)
    model, data = mujoco_model(ODD)
    assert robot.joint_names == ["j1", "j2", "j2b", "j3"]
    rng = np.random.default_rng(0)
    for _ in range(50):
        q = rng.uniform(-1, 1, 4)
        data.qpos[:4] = q
        mujoco.mj_forward(model, data)
        M = pin.crba(robot.model, robot.data, q)
        np.testing.assert_allclose(M, mass_matrix(model, data)[:4, :4], rtol=0, atol=1e-10)
        pin.framesForwardKinematics(robot.model, robot.data, q)
        site = robot.data.oMf[robot.model.getFrameId("tcp")]
        np.testing.assert_allclose(site.translation, data.site("tcp").xpos, atol=1e-12)
        np.testing.assert_allclose(site.rotation.ravel(), data.site("tcp").xmat, atol=1e-12)
        geometry = pin.GeometryData(robot.collision_model)
        pin.updateGeometryPlacements(robot.model, robot.data, robot.collision_model, geometry, q)
        arm = [
            i for i in range(model.ngeom) if model.geom_contype[i] and i not in (0, model.ngeom - 1)
        ]
        for mine, theirs in zip(geometry.oMg, arm, strict=True):
            np.testing.assert_allclose(mine.translation, data.geom_xpos[theirs], atol=1e-12)


def test_what_else_is_read():
    robot = load_robot(ODD)
    assert robot.home == pytest.approx([0.1, 0.2, 0.3, 0.05])
    assert robot.model.armature == pytest.approx([0.2, 0.1, 0.1, 0.1])
    assert robot.upper == pytest.approx([np.radians(100), np.pi / 2, np.inf, 0.2])
    assert robot.lower == pytest.approx([-np.radians(100), -np.pi / 2, -np.inf, -0.1])
    assert robot.effort == pytest.approx([40, 40, 0, 0])
    assert not robot.velocity_upper.any()
    kinds = [type(o.geometry).__name__ for o in robot.collision_model.geometryObjects]
    assert kinds == ["Box", "Capsule", "Sphere", "Cylinder", "Box", "Box"]
    point = hj.position(robot, robot.home, robot.flange)
    model, data = mujoco_model(ODD)
    mujoco.mj_resetDataKeyframe(model, data, 1)
    mujoco.mj_forward(model, data)
    np.testing.assert_allclose(point, data.site("tcp").xpos, atol=1e-12)


def test_missing_velocity_limits_are_told_and_a_toml_gives_them(tmp_path):
    (tmp_path / "odd.xml").write_text(ODD)
    with pytest.warns(UserWarning, match="zero or missing velocity limit"):
        load_robot(tmp_path / "odd.xml")
    (tmp_path / "odd.toml").write_text('urdf = "odd.xml"\nvelocity = [1, 2, 3, 0.5]\n')
    assert load_robot(tmp_path / "odd.toml").velocity_upper == pytest.approx([1, 2, 3, 0.5])


def as_mjcf(robot):
    """Write a robot's model as an MJCF, every digit of it."""
    model, (axes, prismatic) = robot.model, joint_axes(robot.model)

    def words(values):
        return " ".join(repr(float(v)) for v in values)

    bodies, ends = "", ""
    for i, name in enumerate(robot.joint_names):
        at, body = model.jointPlacements[i + 1], model.inertias[i + 1]
        x, y, z, w = pin.Quaternion(at.rotation).coeffs()
        full = body.inertia[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]
        bodies += (
            f'<body name="link_{i}" pos="{words(at.translation)}" quat="{words((w, x, y, z))}">'
            f'<inertial pos="{words(body.lever)}" mass="{body.mass!r}" '
            f'fullinertia="{words(full)}"/>'
            f'<joint name="{name}" axis="{words(axes[i])}" range="-2 2" '
            f'type="{"slide" if prismatic[i] else "hinge"}" '
            f'armature="{float(model.armature[i])!r}"/>'
        )
        ends += "</body>"
    return (
        '<mujoco><compiler angle="radian" boundmass="0" boundinertia="0"/>'
        f"<worldbody>{bodies}{ends}</worldbody></mujoco>"
    )


@pytest.mark.parametrize("name", ["iiwa14", "panda", "xarm7", "kinova"])
def test_one_arm_in_both_formats_has_one_inertia(arm, name):
    robot = arm(name)
    twin = load_robot(as_mjcf(robot))
    rng = np.random.default_rng(1)
    q = rng.uniform(-2, 2, (30, robot.n))
    h = rng.normal(size=(30, 3))
    h /= np.linalg.norm(h, axis=1, keepdims=True)
    for joint in (4, robot.n - 1):
        contact = hj.Contact(joint, (0.02, 0.03, 0.04))
        mine, theirs = (hj.directional_inertia(r, q, contact, h) for r in (twin, robot))
        np.testing.assert_allclose(mine, theirs, rtol=1e-12)


def test_meshes_lie_where_mujoco_has_them(tmp_path):
    folder = tmp_path / "meshes"
    folder.mkdir()
    (folder / "wedge.obj").write_text(
        "v 0.1 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 2\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
    )
    path = tmp_path / "arm.xml"
    path.write_text(f"""<mujoco><compiler meshdir="meshes"/>
      <asset><mesh name="wedge" file="wedge.obj" scale="0.1 0.2 -0.3"/>
        <mesh name="inline" vertex="0 0 0 1 0 0 0 1 0 0 0 1"/></asset>
      <worldbody><body name="a"><joint name="j1" axis="0 0 1"/>{BODY}
        <geom type="mesh" mesh="wedge" pos="0.1 0.2 0.3" euler="10 20 30"/>
        <body name="b" pos="0 0 0.3"><joint name="j2" axis="0 1 0"/>{BODY}</body></body>
      </worldbody></mujoco>""")
    robot = load_robot(path)
    (shape,) = robot.collision_model.geometryObjects
    mine = np.array(shape.geometry.vertices()) @ shape.placement.rotation.T
    mine = mine + shape.placement.translation
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    theirs = model.mesh_vert @ data.geom_xmat[0].reshape(3, 3).T + data.geom_xpos[0]
    order = [np.argmin(np.linalg.norm(theirs - point, axis=1)) for point in mine]
    np.testing.assert_allclose(theirs[order], mine, atol=1e-6)
    path.write_text(path.read_text().replace('mesh="wedge"', 'mesh="inline"'))
    assert "a <mesh> has no filename" in load_robot(path).shape_faults[0][1]


REFUSED = {
    "joint wrist: its type 'ball' is none of revolute": '<joint name="wrist" type="ball"/>',
    "joint wrist: its base floats": '<freejoint name="wrist"/>',
    "MuJoCo cannot read it": '<joint name="wrist" type="screw"/>',
}


@pytest.mark.parametrize("reason", REFUSED)
def test_joints_that_an_arm_cannot_have(tmp_path, run, reason):
    path = tmp_path / "arm.xml"
    path.write_text(f"""<mujoco><worldbody><body name="a">{REFUSED[reason]}{BODY}
      <body name="b" pos="0 0 0.3"><joint name="j2" axis="0 1 0"/>{BODY}</body></body>
      </worldbody></mujoco>""")
    told = run("inspect", "--robot", path)
    assert (told.code, told.err.count("\n")) == (1, 1)
    assert reason in told.err


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('mass="2"', 'mass="nan"'),
        ('mass="1"', 'mass="inf"'),
        ('pos="0.02 0 0.01"', 'pos="0.02 nan 0.01"'),
        ('range="-90 90"', 'range="-90 inf"'),
        ('armature="0.2"', 'armature="nan"'),
        ('forcerange="-30 20"', 'forcerange="-inf inf"'),
        ('qpos="0.1 0.2', 'qpos="nan 0.2'),
        ('qpos="0.1 0.2', 'qpos="9 0.2'),
    ],
)
def test_numbers_that_are_none_are_told_in_a_line(tmp_path, monkeypatch, capfd, old, new):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(hj.ModelError) as error:
        load_robot(ODD.replace(old, new))
    assert "\n" not in str(error.value)
    assert capfd.readouterr() == ("", "")
    assert not list(tmp_path.iterdir())


TEXTS = {
    "<sdf version='1.7'><model name='a'/></sdf>": "SDF, which hitjoints does not read",
    "<html><body/></html>": "the root element is <html>, not <robot>",
    "<mujoco": "MuJoCo cannot read it",
    "<!-- <mujoco> --> <robot/>": "one root link",
    "<>": "not well-formed XML",
}


@pytest.mark.parametrize("text", TEXTS)
def test_texts_that_are_no_arm(text):
    with pytest.raises(hj.ModelError, match=TEXTS[text]):
        load_robot(text)


def test_without_mujoco_the_install_line_is_told(monkeypatch):
    monkeypatch.setitem(sys.modules, "mujoco", None)
    with pytest.raises(MissingExtraError, match=r"pip install 'hitjoints\[sim\]'"):
        load_robot(ODD)
