"""Where a contact point is, how it can move, and in which directions it cannot."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import pinocchio as pin

from hitjoints.tolerances import RANK, rank_floor
from hitjoints.vectors import unit

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from hitjoints.model.robot import Contact, Robot

WORLD_ALIGNED = pin.LOCAL_WORLD_ALIGNED


def position(robot: Robot, q: ArrayLike, contact: Contact | int) -> NDArray[np.float64]:
    """Return the contact point chi_k(q).

    Args:
        robot: the arm.
        q: (n,) rad.
        contact: joint number or Contact.

    Returns:
        (3,) m, in the robot's base frame.

    Raises:
        InputError: no such joint, or q of wrong shape or not finite.
    """
    contact, q = robot.contact(contact), robot.one_configuration(q)
    data = robot.data
    pin.forwardKinematics(robot.model, data, q)
    return np.array(data.oMi[contact.joint].act(np.array(contact.offset)))


def jacobian(robot: Robot, q: ArrayLike, contact: Contact | int) -> NDArray[np.float64]:
    """Return the translational Jacobian J_k(q) of the contact point.

    Args:
        robot: the arm.
        q: (n,) rad.
        contact: joint number or Contact.

    Returns:
        (3, n) m/rad, world-aligned. Columns k..n are zero when the contact is joint k's origin.

    Raises:
        InputError: no such joint, or q of wrong shape or not finite.
    """
    contact, q = robot.contact(contact), robot.one_configuration(q)
    return point_jacobian(robot.model, robot.data, q, contact)


def point_jacobian(
    model: Any, data: Any, q: NDArray[np.float64], contact: Contact
) -> NDArray[np.float64]:
    """Return the Jacobian of a checked contact at a checked configuration."""
    pin.computeJointJacobians(model, data, q)
    jac = pin.getFrameJacobian(model, data, contact.joint, contact.placement, WORLD_ALIGNED)
    # The single column of a one-joint arm comes as a vector.
    return np.asarray(jac).reshape(6, model.nv)[:3]


def manipulability(robot: Robot, q: ArrayLike, contact: Contact | int) -> float:
    """Return Yoshikawa's measure of manipulability.

    Args:
        robot: the arm.
        q: (n,) rad.
        contact: joint number or Contact.

    Returns:
        sqrt(det(J J^T)), m^3/rad^3.

    Raises:
        InputError: no such joint, or q of wrong shape or not finite.

    Source: Yoshikawa, Manipulability of robotic mechanisms, IJRR 4(2), 1985.
    """
    singular = np.linalg.svd(jacobian(robot, q, contact), compute_uv=False)
    return float(np.prod(singular)) if singular.size == 3 else 0.0


@dataclass(frozen=True)
class FeasibleDirections:
    """The directions a contact point can move in: the range of its Jacobian.

    Attributes:
        rank: dimension of that range, 0 to 3.
        basis: (3, rank) orthonormal columns, the direction of easiest motion first.
        speed: (rank,) m/s, the maximum speed along each (Eq. 9).
    """

    rank: int
    basis: NDArray[np.float64]
    speed: NDArray[np.float64]

    @property
    def description(self) -> str:
        """The range in a word: "all", "a plane", "a line" or "none"."""
        return ("none", "a line", "a plane", "all")[self.rank]

    def contain(self, direction: ArrayLike) -> bool:
        """Tell whether `direction` (3,) lies in the range, to within an angle of `RANK`."""
        h = unit(direction)
        return bool(np.linalg.norm(h - self.basis @ (self.basis.T @ h)) < RANK)


def feasible_directions(robot: Robot, q: ArrayLike, contact: Contact | int) -> FeasibleDirections:
    """Return the directions the contact point can move in.

    Section V of the paper: the range of J_k, which is not all of space near the base.

    Args:
        robot: the arm.
        q: (n,) rad.
        contact: joint number or Contact.

    Returns:
        An orthonormal basis of them, with the greatest speed along each.

    Raises:
        InputError: no such joint, or q of wrong shape or not finite.
    """
    jac = jacobian(robot, q, contact)
    left, singular, _ = np.linalg.svd(jac, full_matrices=False)
    rank = int((singular > rank_floor(jac)).sum())
    basis = left[:, :rank]
    pull = jac.T @ basis
    lower, upper = robot.velocity_lower[:, None], robot.velocity_upper[:, None]
    return FeasibleDirections(rank, basis, np.maximum(pull * lower, pull * upper).sum(axis=0))
