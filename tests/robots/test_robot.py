"""Robot: input checks, work shared by threads and processes, frozen numbers."""

import copy
import pickle
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from dataclasses import FrozenInstanceError
from multiprocessing import get_context

import numpy as np
import pytest

from hitjoints.dynamics.inertia import inertia_and_gradient_along, inverse_inertia
from hitjoints.dynamics.kinematics import jacobian, position
from hitjoints.errors import InputError
from hitjoints.model.robot import Contact

H = np.array([0.0, 0.6, 0.8])


def quantities(robot, q):
    """Everything that writes into Pinocchio's work space, in one row."""
    contact = Contact(7, (0.01, 0.02, 0.1))
    inertia, gradient = inertia_and_gradient_along(robot, q, contact, H)
    parts = [inertia], gradient, inverse_inertia(robot, q, 6).ravel()
    return np.concatenate(
        [*parts, position(robot, q, 5), jacobian(robot, q, contact).ravel()], dtype=float
    )


def some_configurations(robot, count, seed=0):
    low, high = np.maximum(robot.lower, -np.pi), np.minimum(robot.upper, np.pi)
    return np.random.default_rng(seed).uniform(low, high, (count, robot.n))


def test_threads_agree_with_one_thread(arm):
    robot = pickle.loads(pickle.dumps(arm("iiwa14")))  # one whose caches are still empty
    qs = some_configurations(robot, 2000)
    with ThreadPoolExecutor(8) as pool:
        found = np.array(list(pool.map(lambda q: quantities(robot, q), qs, chunksize=1)))
    expected = np.array([quantities(arm("iiwa14"), q) for q in qs])
    np.testing.assert_array_equal(found, expected)


def test_every_thread_has_its_own_work_space(arm):
    robot = arm("iiwa14")
    with ThreadPoolExecutor(1) as pool:
        other = pool.submit(lambda: robot.data).result()
    assert other is not robot.data
    assert robot.data is robot.data


@pytest.mark.parametrize("copier", [lambda r: pickle.loads(pickle.dumps(r)), copy.deepcopy])
@pytest.mark.parametrize("name", ["iiwa14", "panda", "kinova"])
def test_copies_compute_the_same(arm, name, copier):
    robot = arm(name)
    _ = robot.weightless_model, robot.collision_model, robot.data, robot.lower
    twin = copier(robot)
    assert twin is not robot
    for item in ("name", "hitting_joints", "flange", "xml", "title", "source", "digest", "n"):
        assert getattr(twin, item) == getattr(robot, item)
    np.testing.assert_array_equal(twin.lower, robot.lower)  # infinite for kinova's joints
    np.testing.assert_array_equal(twin.home, robot.home)
    assert not twin.home.flags.writeable
    assert twin.collision_model.ngeoms == robot.collision_model.ngeoms
    for q in some_configurations(robot, 20):
        contact = Contact(robot.n)
        expected = inertia_and_gradient_along(robot, q, contact, H)
        found = inertia_and_gradient_along(twin, q, contact, H)
        assert found[0] == expected[0]
        np.testing.assert_array_equal(found[1], expected[1])


def test_armature_survives_pickling(arm):
    robot = copy.deepcopy(arm("iiwa14"))
    robot.model.armature = np.full(7, 0.1)
    twin = pickle.loads(pickle.dumps(robot))
    np.testing.assert_array_equal(twin.model.armature, 0.1)
    np.testing.assert_array_equal(twin.velocity_lower, -twin.velocity_upper)


def test_processes_agree(arm):
    robot = arm("xarm7")
    qs = some_configurations(robot, 4)
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
        found = list(pool.map(inverse_inertia, [robot] * 4, qs, [6] * 4))
    np.testing.assert_array_equal(found, [inverse_inertia(robot, q, 6) for q in qs])


def test_numbers_are_frozen(arm):
    robot = arm("iiwa14")
    for values in (robot.home, robot.lower, robot.upper, robot.velocity_upper, robot.effort):
        with pytest.raises(ValueError, match="read-only"):
            values[0] = 0
    with pytest.raises(FrozenInstanceError):
        robot.name = "other"


def test_robot_in_a_word(arm):
    assert repr(arm("iiwa14")) == "Robot(iiwa14: 7 joints, hits with 5, 6, 7)"


def test_robot_can_be_a_key(arm):
    assert {arm("iiwa14"): 1}[arm("iiwa14")] == 1
    # A copy gives the same numbers, and finds what was built for the original.
    assert arm("iiwa14") == copy.deepcopy(arm("iiwa14"))
    assert arm("iiwa14") != arm("iiwa14_bullet")
    assert arm("iiwa14") != "iiwa14"


def test_digest_tells_robots_apart(arm):
    names = ("iiwa14", "iiwa14_bullet", "iiwa7", "panda", "xarm7")
    assert len({arm(name).digest for name in names}) == len(names)


def test_contact_of_a_number(arm):
    robot = arm("iiwa14")
    assert robot.contact(7) == Contact(7, (0.0, 0.0, 0.0))
    assert robot.contact(np.int64(7)) == Contact(7)
    assert robot.contact(Contact(5, [0, 0, 1])) == Contact(5, (0.0, 0.0, 1.0))
    assert hash(Contact(5, [0, 0, 1])) == hash(Contact(5, (0, 0, 1)))


@pytest.mark.parametrize("joint", [0, 8, -1, 5.0, "5", True, None])
def test_no_such_joint(arm, joint):
    for given in (joint, Contact(joint)):
        with pytest.raises(InputError, match=r"joint = .*: iiwa14 has joints 1 to 7"):
            arm("iiwa14").contact(given)


@pytest.mark.parametrize("offset", [(0, 0), (0, 0, np.nan), "abc", 3.0, None, (1, 2, np.inf)])
def test_bad_offset(offset):
    with pytest.raises(InputError, match=r"offset = .*: three finite numbers in metres"):
        Contact(5, offset)


BAD_Q = {
    "short": ([0, 0, 0], "iiwa14 takes 7 joint positions"),
    "empty": ([], "this has shape (0,)"),
    "deep": (np.zeros((2, 2, 7)), "this has shape (2, 2, 7)"),
    "nan": ([0, 0, np.nan, 0, 0, 0, 0], "every joint position must be finite"),
    "inf": ([0, 0, np.inf, 0, 0, 0, 0], "every joint position must be finite"),
    "text": ("zero", "7 numbers in rad"),
    "ragged": ([[0] * 7, [0]], "7 numbers in rad"),
}


@pytest.mark.parametrize("case", BAD_Q)
def test_bad_configuration(arm, case):
    q, message = BAD_Q[case]
    for ask in (arm("iiwa14").configuration, arm("iiwa14").within_limits):
        with pytest.raises(InputError) as caught:
            ask(q)
        assert message in str(caught.value)
        assert str(caught.value).startswith("q = ")
        assert caught.value.argument == "q"


def test_rows_where_one_is_needed(arm):
    rows = np.zeros((2, 7))
    assert arm("iiwa14").configuration(rows).shape == (2, 7)
    with pytest.raises(InputError, match="one configuration is needed, not rows"):
        arm("iiwa14").one_configuration(rows)
    for ask in (position, jacobian, inverse_inertia):
        with pytest.raises(InputError, match="one configuration is needed, not rows"):
            ask(arm("iiwa14"), rows, 7)


def test_outside_the_limits_names_joint_and_bounds(arm):
    q = np.zeros(7)
    q[3] = 2.2
    with pytest.raises(InputError, match=r"start = .* joint 4 is at 2.2, .*\[-2.0944, 2.0944\]"):
        arm("iiwa14").within_limits(q, "start")
