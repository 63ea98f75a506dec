"""A robot's TOML adds facts to a URDF; what is wrong in it is said."""

import pickle

import numpy as np
import pinocchio as pin
import pytest

from hitjoints.dynamics.inertia import inertia_along
from hitjoints.errors import InputError, ModelError, UnknownNameError
from hitjoints.loading.load import load_robot
from hitjoints.model.robot import Contact


@pytest.fixture
def toml(urdf):
    """Load a TOML of these lines beside a two-link URDF with a tool."""
    tool = urdf.link("tool", mass=0.2) + urdf.joint("mount", "link_2", "tool", "fixed", at="0 0 .2")
    urdf.write(urdf.two_links().replace("</robot>", tool + "</robot>"))

    def load(*lines, urdf_line='urdf = "small.urdf"', **options):
        return load_robot(urdf.write("\n".join([urdf_line, *lines]), "arm.toml"), **options)

    return load


def test_defaults(toml):
    robot = toml()
    assert robot.name == robot.title == "arm"
    assert robot.flange == Contact(2)
    np.testing.assert_array_equal(robot.home, [0, 0])
    np.testing.assert_array_equal(robot.model.armature, [0, 0])


def test_facts_are_taken(toml):
    robot = toml(
        'name = "hitter"', 'title = "The Hitter"', 'licence = "MIT"', 'source = "a\\n   b"',
        "hitting_joints = [2]", "home = [0.5, -0.25]", 'flange = "tool"',
    )  # fmt: skip
    assert (robot.name, robot.title, robot.licence) == ("hitter", "The Hitter", "MIT")
    assert robot.source == "a b"
    assert robot.hitting_joints == (2,)
    np.testing.assert_array_equal(robot.home, [0.5, -0.25])
    assert robot.flange == Contact(2, (0, 0, 0.2))


def test_locks_of_file_and_caller_add_up(toml):
    assert toml('lock = ["joint_2"]').joint_names == ["joint_1"]
    with pytest.raises(ModelError, match="no moving joint"):
        toml('lock = ["joint_2"]', lock=["joint_1"])


def test_armature_enters_the_mass_matrix_and_the_inertia(toml):
    plain, geared = toml(), toml("armature = [0.5, 0.25]")
    q, h = np.array([0.3, 0.4]), np.array([0.0, 1.0, 0.0])
    matrices = [pin.crba(r.model, r.model.createData(), q) for r in (plain, geared)]
    np.testing.assert_allclose(matrices[1] - matrices[0], np.diag([0.5, 0.25]), atol=1e-15)
    contact = Contact(2, (0.2, 0.1, 0.0))
    pull = pin.getFrameJacobian
    data = geared.model.createData()
    pin.computeJointJacobians(geared.model, data, q)
    place = pin.SE3(np.eye(3), np.array(contact.offset))
    g = h @ pull(geared.model, data, 2, place, pin.LOCAL_WORLD_ALIGNED)[:3]
    expected = 1 / (g @ np.linalg.solve(matrices[1], g))
    assert inertia_along(geared, q, contact, h) == pytest.approx(expected, rel=1e-13)
    assert inertia_along(geared, q, contact, h) > inertia_along(plain, q, contact, h)
    assert geared.digest != plain.digest


DRIVES = {"acceleration": 8.0, "jerk": 900.0, "rotor_inertia": 0.5, "joint_stiffness": 4e3}


@pytest.mark.parametrize("key", DRIVES)
def test_facts_of_the_drives_are_held_with_their_source_and_change_no_inertia(toml, key):
    value = DRIVES[key]
    plain, known = toml(), toml(f"{key} = [{value}, 0.25]", f'{key}_source = "a\\n data sheet"')
    assert getattr(plain, key) is None
    assert plain.provenance == {}
    np.testing.assert_array_equal(getattr(known, key), [value, 0.25])
    assert known.provenance == {key: "a data sheet"}
    with pytest.raises(ValueError, match="read-only"):
        getattr(known, key)[0] = 0
    np.testing.assert_array_equal(known.model.armature, 0)
    q, h = np.array([0.3, 0.4]), np.array([0.0, 1.0, 0.0])
    contact = Contact(2, (0.2, 0.1, 0.0))
    assert inertia_along(known, q, contact, h) == inertia_along(plain, q, contact, h)
    assert known.digest != plain.digest
    copy = pickle.loads(pickle.dumps(known))
    assert copy == known
    np.testing.assert_array_equal(getattr(copy, key), [value, 0.25])


def test_limits_of_the_toml_go_before_those_of_the_description(toml):
    robot = toml("velocity = [1.5, 0.5]", "effort = [10, 0]", "position = [[-3, 2], [-inf, inf]]")
    np.testing.assert_array_equal(robot.velocity_upper, [1.5, 0.5])
    np.testing.assert_array_equal(robot.velocity_lower, [-1.5, -0.5])
    np.testing.assert_array_equal(robot.effort, [10, 0])
    np.testing.assert_array_equal(robot.lower, [-3, -np.inf])
    np.testing.assert_array_equal(robot.upper, [2, np.inf])
    np.testing.assert_array_equal(robot.home, [-0.5, 0])
    assert robot.digest != toml().digest


def test_limits_that_the_description_lacks(urdf):
    urdf.write(urdf.two_links(more=""))
    text = 'urdf = "small.urdf"\nposition = [[-1, 1], [0, 0.5]]\nvelocity = [1, 2]'
    robot = load_robot(urdf.write(text, "arm.toml"))
    np.testing.assert_array_equal(robot.upper, [1, 0.5])
    np.testing.assert_array_equal(robot.velocity_upper, [1, 2])


REFUSED = {
    "velocity = [1]": "velocity = [1] must be 2 numbers, one per joint",
    "velocity = [1, -1]": "velocity = [1, -1] must be finite and not negative",
    "effort = [inf, 1]": "effort = [inf, 1] must be finite and not negative",
    "effort = [nan, 1]": "must be 2 numbers, one per joint",
    "position = [-1, 1]": "position = [-1, 1] must be 2 pairs [lower, upper], one per joint",
    "position = [[1, -1], [0, 1]]": "joint joint_1: position [1, -1] must be a lower and an upper",
    "position = [[-1, inf], [0, 1]]": "joint joint_1: position [-1, inf] must be a lower",
    "position = [[1], [1, 2]]": "must be 2 pairs [lower, upper]",
    "acceleration = [1, 2]": "acceleration and acceleration_source belong together",
    'jerk_source = "a book"': "jerk and jerk_source belong together",
    "jerk = [1]": "jerk = [1] must be 2 finite numbers",
    "acceleration = [0, 1]": "acceleration = [0, 1] must be above zero",
    "joint_stiffness = [1, -1]": "joint_stiffness = [1, -1] must be above zero",
    "rotor_inertia = [0, -1]": "rotor_inertia = [0, -1] must not be negative",
    "rotor_inertia_source = 3": "rotor_inertia_source = 3 must be text",
    "speed = 1": "unknown key 'speed'; the keys are name, title, urdf,",
    "armature = [0.1]": "armature = [0.1] must be 2 finite numbers",
    "armature = [[0, 1], [2]]": "must be 2 finite numbers",
    "armature = [0, inf]": "must be 2 finite numbers",
    "armature = [0, -0.1]": "must not be negative",
    "armature = 0.1": "armature = 0.1 must be a list",
    "home = [2, 0]": "home = [2.,0.]: joint 1 is at 2, outside its limits [-1, 1]",
    "home = [nan, 0]": "home = [nan, 0] must be 2 finite numbers",
    "home = [0]": "home = [0] must be 2 finite numbers",
    'home = ["a", "b"]': "must be 2 finite numbers",
    'flange = "ghost"': "flange 'ghost' is no frame on the last joint; choose one of ['joint_2', ",
    'flange = "link_1"': "flange 'link_1' is no frame on the last joint",
    "flange = 3": "flange = 3 must be text",
    "hitting_joints = [3]": "hitting_joints = (3,) must be joints from 1 to 2",
    "hitting_joints = [0]": "must be joints from 1 to 2",
    "hitting_joints = [true]": "must be joints from 1 to 2",
    "hitting_joints = [1.5]": "must be joints from 1 to 2",
    "hitting_joints = []": "must be joints from 1 to 2",
    "hitting_joints = 2": "hitting_joints = 2 must be a list",
    "name = 5": "name = 5 must be text",
    'lock = "joint_1"': "lock = 'joint_1' must be a list",
    "lock = [1]": "lock = 1: NAME or NAME=VALUE, a joint and the position (rad or m) to hold",
    "home = = 3": "not a TOML file",
}


@pytest.mark.parametrize("line", REFUSED)
def test_refused(toml, line):
    with pytest.raises(ModelError) as caught:
        toml(line)
    assert REFUSED[line] in str(caught.value)
    assert "\n" not in str(caught.value)


def test_urdf_must_be_named_and_exist(toml):
    with pytest.raises(ModelError, match="the key 'urdf' must name the URDF file"):
        toml(urdf_line="")
    with pytest.raises(InputError, match=r"ghost\.urdf: No such file"):
        toml(urdf_line='urdf = "ghost.urdf"')
    with pytest.raises(InputError, match=r"ghost\.urdf: No such file"):
        toml(urdf_line='urdf = "example-robot-data:ghost.urdf"')
    with pytest.raises(UnknownNameError, match="choose one of joint_1, joint_2"):
        toml('lock = ["ghost"]')
