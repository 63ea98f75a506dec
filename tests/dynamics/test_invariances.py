"""What must not change the inertia, or change it in a known way."""

from importlib import resources

import numpy as np
import pinocchio as pin
import pytest

from hitjoints.dynamics.inertia import inertia_and_gradient_along, inverse_inertia
from hitjoints.dynamics.kinematics import jacobian, manipulability, position
from hitjoints.model.robot import Contact
from hitjoints.vectors import unit

RNG_SEED = 11
COUNT = 50


def cases(robot, seed=RNG_SEED):
    rng = np.random.default_rng(seed)
    for q in rng.uniform(robot.lower, robot.upper, (COUNT, robot.n)):
        joint = int(rng.integers(4, robot.n + 1))
        yield q, Contact(joint, tuple(rng.uniform(-0.1, 0.1, 3))), unit(rng.normal(size=3))


def assert_same(found, expected, rtol=1e-10):
    assert found[0] == pytest.approx(expected[0], rel=rtol)
    scale = max(np.abs(expected[1]).max(), expected[0])
    np.testing.assert_allclose(found[1], expected[1], rtol=0, atol=rtol * scale)


def test_turned_base(arm, urdf):
    """An arm mounted on a wall feels the same along the turned direction."""
    text = (resources.files("hitjoints.robots") / "iiwa14.urdf").read_text()
    upright = '<origin xyz="0 0 0.1575" rpy="0 0 0"/>'
    assert text.count(upright) == 1
    turn = pin.rpy.rpyToMatrix(0.3, -1.2, 2.0)
    foot = turn @ [0, 0, 0.1575] + [0.5, -0.3, 1.0]
    mounted = f'<origin xyz="{foot[0]} {foot[1]} {foot[2]}" rpy="0.3 -1.2 2.0"/>'
    turned, robot = urdf.load(text.replace(upright, mounted)), arm("iiwa14")
    for q, contact, h in cases(robot):
        assert_same(
            inertia_and_gradient_along(turned, q, contact, turn @ h),
            inertia_and_gradient_along(robot, q, contact, h),
        )
        np.testing.assert_allclose(
            position(turned, q, contact),
            turn @ position(robot, q, contact) + [0.5, -0.3, 1.0],
            atol=1e-12,
        )
        np.testing.assert_allclose(
            inverse_inertia(turned, q, contact),
            turn @ inverse_inertia(robot, q, contact) @ turn.T,
            rtol=1e-9,
            atol=1e-10,
        )
        assert manipulability(turned, q, contact) == pytest.approx(
            manipulability(robot, q, contact), rel=1e-9
        )


def test_sign_of_the_direction(arm):
    for q, contact, h in cases(arm("panda")):
        there = inertia_and_gradient_along(arm("panda"), q, contact, h)
        back = inertia_and_gradient_along(arm("panda"), q, contact, -h)
        assert there[0] == back[0]
        np.testing.assert_array_equal(there[1], back[1])


def test_length_of_the_direction(arm):
    for q, contact, h in cases(arm("iiwa7")):
        expected = inertia_and_gradient_along(arm("iiwa7"), q, contact, h)
        found = inertia_and_gradient_along(arm("iiwa7"), q, contact, unit(1e-200 * h))
        assert_same(found, expected, rtol=1e-11)


def test_first_joint_carries_the_direction_along(arm):
    """Turning joint 1 and the direction with it turns everything: q_1 plays no part."""
    robot = arm("iiwa14")
    for q, contact, h in cases(robot):
        expected = inertia_and_gradient_along(robot, q, contact, h)
        other = q.copy()
        other[0] += 0.7
        turned = pin.rpy.rpyToMatrix(0, 0, 0.7) @ h
        assert_same(inertia_and_gradient_along(robot, other, contact, turned), expected)
        # So the gradient by q_1 is minus that of turning h about the vertical.
        small = 1e-4
        sides = [
            inertia_and_gradient_along(robot, q, contact, pin.rpy.rpyToMatrix(0, 0, a) @ h)[0]
            for a in (-2 * small, -small, small, 2 * small)
        ]
        slope = np.dot(sides, [1, -8, 8, -1]) / (12 * small)
        scale = max(np.abs(expected[1]).max(), expected[0])
        assert expected[1][0] == pytest.approx(-slope, abs=1e-6 * scale)


@pytest.mark.parametrize("name", ["iiwa14", "iiwa7", "panda", "xarm7"])
def test_a_joint_does_not_move_its_own_origin(arm, name):
    robot = arm(name)
    for q, contact, _ in cases(robot):
        k = contact.joint
        jac = jacobian(robot, q, k)
        np.testing.assert_allclose(jac[:, k - 1 :], 0, atol=1e-15)
        assert np.abs(jac[:, 0]).max() > 1e-3
        # With an offset joint k itself does move the contact, the joints after it do not.
        jac = jacobian(robot, q, contact)
        np.testing.assert_array_equal(jac[:, k:], 0)
        assert np.abs(jac[:, k - 1]).max() > 1e-4


def test_offset_along_the_direction_changes_nothing(arm):
    """h . (omega x s h) = 0: sliding the contact along the hitting direction is free."""
    robot = arm("iiwa14")
    for q, contact, h in cases(robot):
        expected, _ = inertia_and_gradient_along(robot, q, contact, h)
        pin.forwardKinematics(robot.model, robot.data, q)
        local = robot.data.oMi[contact.joint].rotation.T @ h
        slid = Contact(contact.joint, tuple(np.array(contact.offset) + 0.2 * local))
        assert inertia_and_gradient_along(robot, q, slid, h)[0] == pytest.approx(
            expected, rel=1e-10
        )
        # Sideways is another matter.
        side = Contact(
            contact.joint, tuple(np.array(contact.offset) + 0.2 * unit(local[[1, 2, 0]]))
        )
        assert inertia_and_gradient_along(robot, q, side, h)[0] != pytest.approx(expected, rel=1e-3)


def test_last_joint_turns_a_symmetric_link(arm):
    """The last link of the iiwa 14 is a body of revolution: lambda at joint 7 ignores q_7."""
    robot = arm("iiwa14")
    for q, _, h in cases(robot):
        inertia, gradient = inertia_and_gradient_along(robot, q, Contact(7), h)
        assert abs(gradient[6]) < 1e-12 * max(inertia, np.abs(gradient).max())
        other = q.copy()
        other[6] += 1.0
        again, _ = inertia_and_gradient_along(robot, other, Contact(7), h)
        assert again == pytest.approx(inertia, rel=1e-12)


def test_inertia_grows_towards_the_base(arm):
    """Over random directions joint 5 is heavier to hit with than 6, and 6 than 7."""
    robot = arm("iiwa14")
    rng = np.random.default_rng(2)
    qs = rng.uniform(robot.lower, robot.upper, (300, 7))
    hs = unit(rng.normal(size=(300, 3)))
    medians = [
        np.median(
            [
                inertia_and_gradient_along(robot, q, Contact(k), h)[0]
                for q, h in zip(qs, hs, strict=True)
            ]
        )
        for k in (5, 6, 7)
    ]
    assert medians[0] > medians[1] > medians[2]
