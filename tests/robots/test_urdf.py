"""Reading URDFs: what is accepted and becomes what, and every refusal with its reason."""

import warnings
from pathlib import Path

import numpy as np
import pytest

from hitjoints.dynamics.inertia import inertia_along
from hitjoints.dynamics.kinematics import position
from hitjoints.errors import HitjointsError, InputError, ModelError, UnknownNameError
from hitjoints.loading import catalogue
from hitjoints.loading.load import load_robot
from hitjoints.model.robot import Contact
from hitjoints.model.urdf import read_urdf


def test_path_string_and_pathlib(urdf):
    path = urdf.write(urdf.two_links())
    for given in (path, str(path)):
        robot = load_robot(given)
        assert robot.name == "small"
        assert robot.joint_names == ["joint_1", "joint_2"]
        np.testing.assert_array_equal(robot.upper, [1, 1])
        np.testing.assert_array_equal(robot.velocity_upper, [2, 2])
        np.testing.assert_array_equal(robot.effort, [3, 3])
        np.testing.assert_array_equal(robot.home, [0, 0])
        assert robot.hitting_joints == (1, 2)
        assert robot.flange == Contact(2)


def test_relative_path_and_other_endings(urdf, monkeypatch):
    urdf.write(urdf.two_links(), "arm.xml")
    urdf.write(urdf.two_links(), "arm.urdf")
    monkeypatch.chdir(urdf.folder)
    assert load_robot("arm.xml").n == 2
    assert load_robot(Path("arm.urdf")).n == 2


def test_byte_order_mark_and_declaration(urdf):
    text = '\ufeff<?xml version="1.0" encoding="utf-8"?>' + urdf.two_links()
    assert load_robot(urdf.write(text)).n == 2


@pytest.mark.parametrize(
    ("name", "n", "unbounded"), [("kinova", 6, [0, 3, 5]), ("ur5_robot", 6, []), ("z1", 6, [])]
)
def test_names_of_example_robot_data(name, n, unbounded):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        robot = load_robot(name)
    assert robot.name == name
    assert robot.n == n
    np.testing.assert_array_equal(np.flatnonzero(np.isinf(robot.lower)), unbounded)
    np.testing.assert_array_equal(np.flatnonzero(np.isinf(robot.upper)), unbounded)
    inertia = inertia_along(robot, robot.home + 0.3, Contact(n - 1), np.array([0.0, 1.0, 0.0]))
    assert 0 < inertia < np.inf


def test_usual_flange_names_are_found():
    flange = load_robot("ur5_robot").flange
    assert flange.joint == 6
    np.testing.assert_allclose(flange.offset, (0, 0.0823, 0), atol=1e-12)


@pytest.mark.parametrize(
    "limit", ["", '<limit effort="3" velocity="2"/>', '<limit lower="-1" upper="1"/>']
)
def test_continuous_joints_are_unbounded(urdf, limit):
    robot = urdf.load(urdf.two_links(kind="continuous", more=limit))
    np.testing.assert_array_equal(robot.lower, [-1, -np.inf])
    np.testing.assert_array_equal(robot.upper, [1, np.inf])
    np.testing.assert_array_equal(robot.home, [0, 0])
    assert robot.velocity_upper[1] == (2 if "velocity" in limit else 0)
    np.testing.assert_array_equal(robot.within_limits([0.5, 100.0]), [0.5, 100.0])


def test_missing_velocity_and_effort_count_as_zero(urdf):
    robot = urdf.load(urdf.two_links(more='<limit lower="-1" upper="1"/>'))
    assert robot.velocity_upper[1] == 0
    assert robot.effort[1] == 0


def test_prismatic_joint(urdf):
    robot = urdf.load(urdf.two_links(kind="prismatic", axis="1 0 0"))
    q = np.array([np.pi / 2, 0.5])
    np.testing.assert_allclose(position(robot, q, 2), [0.3, 0.8, 0], atol=1e-15)


def test_one_joint_arm(urdf):
    robot = urdf.load(urdf.base, urdf.link("link_1"), urdf.joint("joint_1", "base", "link_1"))
    assert robot.n == 1
    assert robot.hitting_joints == (1,)


def test_locked_joint_is_held_at_zero(urdf):
    xml = urdf.two_links(rpy="0 0 0.5")
    held, free = urdf.load(xml, lock=["joint_2"]), urdf.load(xml)
    assert held.joint_names == ["joint_1"]
    frame = held.model.frames[held.model.getFrameId("link_2")]
    point = Contact(1, tuple(frame.placement.translation))
    np.testing.assert_allclose(position(held, [0.4], point), position(free, [0.4, 0.0], 2))
    assert held.model.inertias[1].mass == 2
    assert urdf.load(xml, lock="joint_1").joint_names == ["joint_2"]


def test_locking_makes_a_branch_and_a_mimic_acceptable(urdf):
    fingers = (
        urdf.link("link_3"),
        urdf.joint("joint_3", "link_1", "link_3", more=urdf.limit + '<mimic joint="joint_2"/>'),
    )
    xml = urdf.two_links().replace("</robot>", "".join(fingers) + "</robot>")
    assert urdf.load(xml, lock=["joint_3"]).joint_names == ["joint_1", "joint_2"]
    assert urdf.load(xml, lock=("joint_2", "joint_3")).joint_names == ["joint_1"]


def test_link_and_joint_may_share_a_name(urdf):
    robot = urdf.load(
        urdf.base,
        urdf.link("same"),
        urdf.link("flange"),
        urdf.joint("same", "base", "same"),
        urdf.joint("flange", "same", "flange"),
    )
    assert robot.n == 2
    assert robot.flange == Contact(2)


def test_tensor_is_turned_into_the_link_frame(urdf):
    """The origin of an <inertial> may be turned: roll a quarter turn swaps y and z."""
    turned = urdf.link("link_1", moments=(1, 2, 3), rpy=f'rpy="{np.pi / 2} 0 0"')
    text = urdf.robot(urdf.base, turned, urdf.joint("joint_1", "base", "link_1"))
    link = read_urdf(text, "small").bodies["link_1"]
    np.testing.assert_allclose(link.inertia, np.diag([1, 3, 2]), atol=1e-15)
    rpy = 'rpy="0.3 -0.4 0.5"'
    turned = urdf.link("link_1", moments=(1, 2, 2.5), products=(0.1, 0.2, -0.1), rpy=rpy)
    text = urdf.robot(urdf.base, turned, urdf.joint("joint_1", "base", "link_1"))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        body = urdf.load(text).model.inertias[1]
    np.testing.assert_allclose(
        read_urdf(text, "small").bodies["link_1"].inertia, body.inertia, rtol=1e-12
    )


NAN_LIMIT = '<limit lower="nan" upper="1" velocity="2" effort="3"/>'
JOINTS = {
    "floating": ({"kind": "floating"}, "joint joint_2: its base floats"),
    "planar": ({"kind": "planar"}, "joint joint_2: planar joints are not supported"),
    "kind": ({"kind": "ball"}, "joint joint_2: its type 'ball' is none of revolute, continuous"),
    "zero axis": ({"axis": "0 0 0"}, "joint joint_2: its axis is zero"),
    "short axis": ({"axis": "0 1"}, "joint joint_2: axis xyz = '0 1' is not three finite"),
    "no limit": ({"more": ""}, "joint joint_2: it has no <limit>, which a revolute joint needs"),
    "NaN limit": ({"more": NAN_LIMIT}, "joint joint_2: limit lower = 'nan' is not a finite"),
    "infinite limit": (
        {"more": '<limit lower="-inf" upper="inf" velocity="2" effort="3"/>'},
        "joint joint_2: limit lower = '-inf' is not a finite number",
    ),
    "text limit": (
        {"more": '<limit lower="-1" upper="wide" velocity="2" effort="3"/>'},
        "joint joint_2: limit upper = 'wide' is not a finite number",
    ),
    "crossed limits": (
        {"more": '<limit lower="1" upper="-0.5" velocity="2" effort="3"/>'},
        "joint joint_2: lower limit 1 is above upper -0.5",
    ),
    "NaN speed": (
        {"more": '<limit lower="-1" upper="1" velocity="nan" effort="3"/>'},
        "joint joint_2: limit velocity = 'nan' is not a finite number",
    ),
    "negative speed": (
        {"more": '<limit lower="-1" upper="1" velocity="-2" effort="3"/>'},
        "joint joint_2: its velocity limit -2 is negative",
    ),
    "negative effort": (
        {"kind": "continuous", "more": '<limit velocity="2" effort="-3"/>'},
        "joint joint_2: its effort limit -3 is negative",
    ),
    "NaN origin": ({"at": "nan 0 0"}, "joint joint_2: origin xyz = 'nan 0 0' is not three"),
    "NaN turn": ({"rpy": "0 nan 0"}, "joint joint_2: origin rpy = '0 nan 0' is not three finite"),
}


@pytest.mark.parametrize("case", JOINTS)
def test_refused_joints(urdf, case, capfd):
    joint, message = JOINTS[case]
    with pytest.raises(ModelError) as caught:
        urdf.load(urdf.two_links(**joint))
    assert message in str(caught.value)
    assert "small.urdf" in str(caught.value)
    assert "\n" not in str(caught.value)
    # Nothing leaks from the parsers underneath.
    assert capfd.readouterr() == ("", "")


def refused_trees(urdf):
    link, joint, base = urdf.link, urdf.joint, urdf.base
    one = link("link_1"), joint("joint_1", "base", "link_1")
    loop = (joint("joint_2", "link_2", "link_3"), joint("joint_3", "link_3", "link_2"))
    fixed_loop = (
        joint("joint_2", "link_2", "link_3", "fixed"),
        joint("joint_3", "link_3", "link_2", "fixed"),
    )
    others = link("link_2"), link("link_3")
    return {
        "malformed": ("<robot", "not well-formed XML"),
        "empty": ("", "not well-formed XML"),
        "another document": ("<html/>", "not a URDF: the root element is <html>, not <robot>"),
        "two branches": (
            urdf.robot(base, *one, *others, joint("joint_2", "link_1", "link_2")).replace(
                "</robot>", joint("joint_3", "link_1", "link_3") + "</robot>"
            ),
            "it ends in 2 places: choose one with --tip link_2 (2 joints), --tip link_3 (2 joints)",
        ),
        "two arms": (
            urdf.robot(base, *one, link("link_2"), joint("joint_2", "base", "link_2")),
            '--tip link_1 (1 joint), --tip link_2 (1 joint) (in Python tip="link_1")',
        ),
        "missing child": (
            urdf.robot(base, *one, joint("joint_2", "link_1", "ghost")),
            "joint joint_2: its child link 'ghost' does not exist",
        ),
        "missing parent": (
            urdf.robot(base, *one, joint("joint_2", "ghost", "base")),
            "joint joint_2: its parent link 'ghost' does not exist",
        ),
        "no parent named": (
            urdf.robot(base, '<joint name="j" type="fixed"><child link="base"/></joint>'),
            "joint j: its parent link '' does not exist",
        ),
        "two roots": (
            urdf.robot(base, *one, link("alone")),
            "there must be one root link, not 2 ['alone', 'base']",
        ),
        "no link": ("<robot name='r'/>", "there must be one root link, not 0"),
        "two parents": (
            urdf.robot(base, *one, joint("joint_2", "base", "link_1")),
            "link link_1 is the child of two joints",
        ),
        "loop": (
            urdf.robot(base, *one, *others, *loop),
            "links ['link_2', 'link_3'] hang in a loop, not on the root link base",
        ),
        "rigid loop": (
            urdf.robot(base, *one, *others, *fixed_loop),
            "links ['link_2', 'link_3'] hang in a loop, not on the root link base",
        ),
        "no joint": (urdf.robot(base), "it has no moving joint"),
        "rigid": (
            urdf.robot(base, link("link_1"), joint("joint_1", "base", "link_1", "fixed")),
            "it has no moving joint",
        ),
        "nameless link": (urdf.robot("<link/>"), "a <link> has no name"),
        "empty name": (urdf.robot('<link name=""/>'), "a <link> has no name"),
        "twice": (urdf.robot(base, base), "two <link> elements are called base"),
        "absurd inertia": (
            urdf.robot(base, link("link_1", products=("-1e308", 0, 0)), one[1]),
            "link link_1: inertial holds 1e+308: no link is so heavy",
        ),
        "NaN mass": (
            urdf.robot(base, link("link_1", mass="nan"), one[1]),
            "link link_1: inertial mass value = 'nan' is not a finite number",
        ),
        "NaN inertia": (
            urdf.robot(base, link("link_1", moments=("nan", 1, 1)), one[1]),
            "link link_1: inertial inertia ixx = 'nan' is not a finite number",
        ),
        "NaN mass centre": (
            urdf.robot(base, link("link_1", com=("inf", 0, 0)), one[1]),
            "link link_1: inertial origin xyz = 'inf 0 0' is not three finite numbers",
        ),
        "no mass": (
            urdf.robot(base, link("link_1").replace('<mass value="1.0"/>', ""), one[1]),
            "link link_1: inertial mass has no value",
        ),
        "no product": (
            urdf.robot(base, link("link_1").replace('iyz="0"', ""), one[1]),
            "link link_1: inertial inertia has no iyz",
        ),
    }


CASES = [
    "malformed", "empty", "another document", "two branches", "two arms", "missing child",
    "missing parent", "no parent named", "two roots", "no link", "two parents", "loop",
    "rigid loop", "no joint", "rigid", "nameless link", "empty name", "twice",
    "absurd inertia", "NaN mass", "NaN inertia", "NaN mass centre", "no mass", "no product",
]  # fmt: skip


def test_every_refused_tree_is_tried(urdf):
    assert list(refused_trees(urdf)) == CASES


@pytest.mark.parametrize("case", CASES)
def test_refused_trees(urdf, case, capfd):
    xml, message = refused_trees(urdf)[case]
    with pytest.raises(ModelError) as caught:
        load_robot(urdf.write(xml))
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)
    assert capfd.readouterr() == ("", "")


def test_locking_everything(urdf):
    with pytest.raises(ModelError, match="no moving joint"):
        urdf.load(urdf.two_links(), lock=["joint_1", "joint_2"])


def test_unknown_lock_lists_the_joints(urdf):
    with pytest.raises(UnknownNameError) as caught:
        urdf.load(urdf.two_links(), lock=["finger"])
    assert str(caught.value) == "lock = 'finger': choose one of joint_1, joint_2"
    with pytest.raises(UnknownNameError, match="choose one of joint_1, joint_2"):
        urdf.load(urdf.two_links(), lock="finger")


@pytest.mark.parametrize("name", ["nosuch", "", ".", Path("nosuch")])
def test_unknown_name_lists_the_robots(name):
    with pytest.raises(UnknownNameError) as caught:
        load_robot(name)
    for choice in ("iiwa14", "iiwa7", "panda", "xarm7", "a URDF path", "example-robot-data"):
        assert choice in str(caught.value)


def test_unreadable_files(tmp_path):
    with pytest.raises(InputError, match=r"robot = .*ghost\.urdf: No such file"):
        load_robot(tmp_path / "ghost.urdf")
    with pytest.raises(InputError, match=r"ghost\.toml: No such file"):
        load_robot(tmp_path / "ghost.toml")
    with pytest.raises(InputError, match="Is a directory"):
        load_robot(tmp_path)
    binary = tmp_path / "binary.urdf"
    binary.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(InputError, match="not a UTF-8 text file"):
        load_robot(binary)


def test_example_robot_data_may_be_missing(monkeypatch):
    def missing(name):
        raise catalogue.metadata.PackageNotFoundError(name)

    monkeypatch.setattr(catalogue.metadata, "distribution", missing)
    with pytest.raises(InputError, match="not installed: pip install example-robot-data"):
        catalogue.erd_directory.__wrapped__()


def test_branched_robots_of_example_robot_data_are_refused():
    for name in ("a1", "baxter", "pr2", "talos_reduced", "tiago_dual"):
        with pytest.raises(HitjointsError, match=r"it ends in \d+ places: choose one with --tip "):
            load_robot(name)


def test_missing_mesh_is_named_when_the_shapes_are_asked_for(urdf):
    mesh = '<collision><geometry><mesh filename="ghost.stl"/></geometry></collision></link>'
    xml = urdf.two_links()
    head, tail = xml.rsplit("</link>", 1)
    robot = urdf.load(head + mesh + tail)
    with pytest.raises(ModelError, match=r"shape of \w+ cannot be read: mesh ghost\.stl"):
        _ = robot.collision_model
