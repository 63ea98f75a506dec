"""Errors cross processes, and arguments are what they seem."""

import multiprocessing
import pickle

import numpy as np
import pytest

import hitjoints as hj
from hitjoints import errors
from hitjoints.errors import SHOWN, InputError, shown
from hitjoints.impact.collision import hitting_flux
from hitjoints.vectors import real

EXAMPLES = [
    errors.HitjointsError("what"),
    errors.InputError("q", [1, 2], "three"),
    errors.UnknownNameError("robot", "x", ["b", "a"]),
    errors.ModelError("arm", "no"),
    errors.InfeasibleError("no way", {"a": 1.5}),
    errors.SolverError("doubt"),
    errors.KernelMismatchError("no"),
    errors.MissingExtraError("viser", "view"),
]


def kinds(root):
    return {root}.union(*(kinds(kind) for kind in root.__subclasses__()))


@pytest.mark.parametrize("error", EXAMPLES, ids=lambda error: type(error).__name__)
def test_errors_survive_pickling_with_their_data(error):
    copy = pickle.loads(pickle.dumps(error))
    assert type(copy) is type(error)
    assert str(copy) == str(error)
    assert copy.__dict__ == error.__dict__


def test_every_kind_of_error_has_an_example():
    ours = {kind for kind in kinds(errors.HitjointsError) if kind.__module__ == errors.__name__}
    assert ours == {type(error) for error in EXAMPLES}


def ask(joint):
    robot = hj.load_robot("iiwa14")
    return float(hj.directional_inertia(robot, robot.home, joint, [0, 1, 0]))


def test_a_pool_hands_the_error_back():
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        answers = pool.map_async(ask, [5, 99])
        with pytest.raises(InputError, match="joint = 99: iiwa14 has joints 1 to 7"):
            answers.get(timeout=60)


class Unwritable:
    def __str__(self):
        raise RuntimeError


def test_a_value_in_a_message_is_one_short_line():
    assert shown("a\n  b") == "a b"
    assert shown(Unwritable()) == "a Unwritable"
    assert shown(16**5000) == "a int"
    for value in ("x" * 10**6, np.arange(10**6), list(range(10**5))):
        assert len(shown(value)) < 2 * SHOWN
        assert len(str(InputError("a", value, "b"))) < 2 * SHOWN


INTEGERS = [np.int64(6), np.int32(6), np.uint8(6), np.array([6])[0]]


@pytest.mark.parametrize("joint", INTEGERS, ids=lambda joint: type(joint).__name__)
def test_numpy_integers_are_joints(arm, joint):
    robot, h, at = arm("iiwa14"), [0, 1, 0], [0.5, 0.3, 0.5]
    contact = robot.contact(joint)
    assert contact == robot.contact(6)
    assert type(contact.joint) is type(hj.Contact(joint).joint) is int
    for ask in (hj.directional_inertia, hj.directional_inertia_gradient, hj.hitting_speed):
        for q in (robot.home, [robot.home]):
            np.testing.assert_array_equal(ask(robot, q, joint, h), ask(robot, q, 6, h))
    for ask in (hj.position, hj.jacobian, hj.manipulability, hj.inverse_inertia):
        np.testing.assert_array_equal(
            ask(robot, robot.home, joint), ask(robot, robot.home, contact)
        )
    assert hj.place_joint(robot, joint, at).solved.all()
    assert hj.posture(robot, robot.home, joint, h).joint == 6
    planned = hj.plan(robot, at, h, 2.0, joints=np.array([joint]), certificate=False)
    assert planned.best.joint == 6
    swept = hj.sweep_joint(robot, at, h, 2.0, joints=np.array([joint]), count=3)
    assert [hj.Contact(k).joint for k in swept.joint.values] == [6]


@pytest.mark.parametrize("joint", [True, np.bool_(True), 6.0, np.float64(6), "6", None, 0, 8, -1])
def test_what_is_no_joint(arm, joint):
    with pytest.raises(InputError, match="iiwa14 has joints 1 to 7"):
        arm("iiwa14").contact(joint)


@pytest.mark.parametrize("joints", [6, np.int64(6), hj.Contact(6)])
def test_joints_are_a_list(arm, joints):
    with pytest.raises(InputError, match="a list of joints, even of one"):
        hj.plan(arm("iiwa14"), [0.5, 0.3, 0.5], [0, 1, 0], 2.0, joints=joints)
    for wrong in ([], [6, 6], np.array([6, 6])):
        with pytest.raises(InputError, match="at least one, each once"):
            hj.sweep_joint(arm("iiwa14"), [0.5, 0.3, 0.5], [0, 1, 0], 2.0, joints=wrong)


NOT_REAL = {
    "masked": np.ma.array([0.1] * 7, mask=[True] + [False] * 6),
    "masked rows": [np.ma.array([0.1] * 7, mask=[True] * 7)] * 2,
    "complex": np.full(7, 1 + 1j),
    "complex in a list": [1j] + [0] * 6,
    "text": ["0.1"] * 7,
    "a text": "0000000",
    "too large": [10**400] + [0] * 6,
    "times": np.zeros(7, "m8[s]"),
    "ragged": [[0] * 7, [0]],
    "nothing": None,
}


@pytest.mark.parametrize("values", NOT_REAL.values(), ids=NOT_REAL)
def test_numbers_that_are_not_real_are_refused(arm, values):
    robot = arm("iiwa14")
    vector = values if values is None or isinstance(values, str) else values[:3]
    for ask in (
        lambda: robot.configuration(values),
        lambda: robot.within_limits(values),
        lambda: hj.directional_inertia(robot, robot.home, 6, vector),
        lambda: hj.place_joint(robot, 6, vector),
        lambda: hj.Contact(6, vector),
        lambda: hitting_flux(values, 2.0, 1.0),
        lambda: hitting_flux(3.0, 2.0, values),
    ):
        with pytest.raises(InputError):
            ask()


def test_real_numbers_pass():
    plain = np.array([0.5, 1.0])
    assert real(plain, "a", "b") is plain
    for same in (np.ma.array(plain), [0.5, 1], plain.astype("f2"), plain.astype(object)):
        np.testing.assert_array_equal(real(same, "a", "b"), plain)
