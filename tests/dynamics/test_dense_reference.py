"""Inertia and gradient against dense references that share no code with them."""

import numpy as np
import pinocchio as pin
import pytest

from hitjoints.dynamics.inertia import inertia_along, inertia_and_gradient_along, inverse_inertia
from hitjoints.dynamics.kinematics import jacobian, position
from hitjoints.model.robot import Contact

ROBOTS = ["iiwa14", "iiwa7", "panda", "xarm7"]
JOINTS = [4, 5, 6, 7]
CONFIGURATIONS = 1000
# A fourth-order difference errs by a truncation of about FIFTH s^4 and a round-off of about
# eps / s, with s the step over the distance on which the function changes and FIFTH what nearly
# straight arms make of its fifth derivative. The sum is least where the two are equal, at about
# 2e-12; the tolerance leaves room for derivatives a hundred times larger.
FIFTH = 1e4
STEP = (np.finfo(float).eps / FIFTH) ** 0.2
TOLERANCE = 1e-9
STENCIL = ((-2, 1 / 12), (-1, -2 / 3), (1, 2 / 3), (2, -1 / 12))


def points_of(model, q, joint, offset):
    """Return the contact points (N, 3) by a product of transforms; `q` (N, n) may be complex."""
    count = len(q)
    turn = np.broadcast_to(np.eye(3), (count, 3, 3))
    place = np.zeros((count, 3))
    for i in range(1, joint + 1):
        assert model.joints[i].shortname() == "JointModelRZ"
        fixed = model.jointPlacements[i]
        place = place + turn @ fixed.translation
        c, s, zero = np.cos(q[:, i - 1]), np.sin(q[:, i - 1]), np.zeros(count)
        spin = np.stack([c, -s, zero, s, c, zero, zero, zero, zero + 1], axis=1)
        turn = turn @ fixed.rotation @ spin.reshape(count, 3, 3)
    return place + np.einsum("nij,nj->ni", turn, offset)


def complex_step_jacobians(model, q, joint, offset):
    """Return dense Jacobians (N, 3, n), exact to round-off: no difference is taken."""
    columns = []
    for i in range(model.nv):
        moved = q.astype(complex)
        moved[:, i] += 1e-30j
        columns.append(points_of(model, moved, joint, offset).imag / 1e-30)
    return np.stack(columns, axis=2)


def sample(robot, joint, with_offset):
    rng = np.random.default_rng(100 * joint + with_offset)
    q = rng.uniform(robot.lower, robot.upper, (CONFIGURATIONS, robot.n))
    h = rng.normal(size=(CONFIGURATIONS, 3))
    h /= np.linalg.norm(h, axis=1, keepdims=True)
    offsets = with_offset * rng.uniform(-0.1, 0.1, (CONFIGURATIONS, 3))
    return q, h, offsets


@pytest.mark.parametrize("with_offset", [False, True], ids=["origin", "offset"])
@pytest.mark.parametrize("joint", JOINTS)
@pytest.mark.parametrize("name", ROBOTS)
class TestAgainstDenseReference:
    def test_jacobian_and_inertia(self, arm, name, joint, with_offset):
        robot = arm(name)
        fresh = pin.Model(robot.model)
        q, h, offsets = sample(robot, joint, with_offset)
        jacobians = complex_step_jacobians(fresh, q, joint, offsets)
        places = points_of(fresh, q, joint, offsets)
        worst_inertia = worst_matrix = worst_jacobian = worst_place = 0.0
        for i, configuration in enumerate(q):
            contact = Contact(joint, tuple(offsets[i]))
            mass_matrix = pin.crba(fresh, fresh.createData(), configuration)
            upper = np.triu(mass_matrix)
            mass_matrix = upper + np.triu(mass_matrix, 1).T
            pull = h[i] @ jacobians[i]
            expected = 1 / (pull @ np.linalg.solve(mass_matrix, pull))
            found = inertia_along(robot, configuration, contact, h[i])
            worst_inertia = max(worst_inertia, abs(found / expected - 1))
            dense = jacobians[i] @ np.linalg.solve(mass_matrix, jacobians[i].T)
            found = inverse_inertia(robot, configuration, contact)
            worst_matrix = max(worst_matrix, np.abs(found - dense).max() / np.abs(dense).max())
            found = jacobian(robot, configuration, contact)
            worst_jacobian = max(worst_jacobian, np.abs(found - jacobians[i]).max())
            found = position(robot, configuration, contact)
            worst_place = max(worst_place, np.abs(found - places[i]).max())
        print(
            f"inertia {worst_inertia:.1e}  matrix {worst_matrix:.1e}  "
            f"jacobian {worst_jacobian:.1e}  position {worst_place:.1e}"
        )
        assert worst_inertia < 1e-12
        assert worst_matrix < 1e-12
        assert worst_jacobian < 1e-14
        assert worst_place < 1e-14

    def test_gradient(self, arm, name, joint, with_offset):
        """The step is measured in the distance on which lambda changes.

        Where h is nearly infeasible, 1 / lambda is nearly zero and quadratic in the distance to
        its zero: lambda changes on the scale sqrt(lambda_min / lambda), lambda_min the least
        inertia of the contact in any direction. A fixed step would jump over the peak. The error
        is relative to the larger of |gradient| and lambda per rad.
        """
        robot = arm(name)
        worst = 0.0
        for configuration, h, offset in zip(*sample(robot, joint, with_offset), strict=True):
            contact = Contact(joint, tuple(offset))
            inertia, gradient = inertia_and_gradient_along(robot, configuration, contact, h)
            most = np.linalg.eigvalsh(inverse_inertia(robot, configuration, contact))[-1]
            step = STEP / np.sqrt(inertia * most)
            assert step > 1e-7
            expected = [
                sum(
                    weight * inertia_along(robot, configuration + far * step * axis, contact, h)
                    for far, weight in STENCIL
                )
                / step
                for axis in np.eye(robot.n)
            ]
            scale = max(np.abs(gradient).max(), inertia)
            worst = max(worst, np.abs(gradient - expected).max() / scale)
        print(f"gradient {worst:.1e}")
        assert worst < TOLERANCE


@pytest.mark.parametrize("name", ["kinova", "ur5_robot", "z1"])
def test_other_arms(arm, name):
    """Arms of other axes and joint numbers: the Jacobian is differenced from the position."""
    robot = arm(name)
    rng = np.random.default_rng(3)
    low, high = np.maximum(robot.lower, -np.pi), np.minimum(robot.upper, np.pi)
    for q in rng.uniform(low, high, (50, robot.n)):
        contact = Contact(robot.n - 1, tuple(rng.uniform(-0.1, 0.1, 3)))
        h = rng.normal(size=3)
        h /= np.linalg.norm(h)
        numeric = np.stack(
            [
                sum(w * position(robot, q + k * STEP * axis, contact) for k, w in STENCIL) / STEP
                for axis in np.eye(robot.n)
            ],
            axis=1,
        )
        jac = jacobian(robot, q, contact)
        np.testing.assert_allclose(jac, numeric, rtol=0, atol=1e-10)
        mass_matrix = pin.crba(robot.model, robot.model.createData(), q)
        pull = h @ jac
        inertia, gradient = inertia_and_gradient_along(robot, q, contact, h)
        expected = 1 / (pull @ np.linalg.solve(mass_matrix, pull))
        assert inertia == pytest.approx(expected, rel=1e-12)
        most = np.linalg.eigvalsh(inverse_inertia(robot, q, contact))[-1]
        step = STEP / np.sqrt(inertia * most)
        expected = [
            sum(w * inertia_along(robot, q + k * step * e, contact, h) for k, w in STENCIL) / step
            for e in np.eye(robot.n)
        ]
        scale = max(np.abs(gradient).max(), inertia)
        np.testing.assert_allclose(gradient, expected, rtol=0, atol=TOLERANCE * scale)
