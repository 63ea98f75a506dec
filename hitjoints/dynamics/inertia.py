"""Inertia felt at a contact point along a direction, and its exact gradient.

The task inertia Lambda = (J M^-1 J^T)^-1 is never formed: its inverse is singular whenever the
contact cannot move in all directions, while the directional inertia is still defined.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pinocchio as pin

from hitjoints.dynamics.kinematics import WORLD_ALIGNED, point_jacobian
from hitjoints.errors import InfeasibleError, ModelError
from hitjoints.model.robot import NO_MASS
from hitjoints.tolerances import moves

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from hitjoints.model.robot import Contact, Robot


def inverse_inertia(robot: Robot, q: ArrayLike, contact: Contact | int) -> NDArray[np.float64]:
    """Return the inverse task inertia Li = J M^-1 J^T.

    Args:
        robot: the arm.
        q: (n,) rad.
        contact: joint number or Contact.

    Returns:
        (3, 3) 1/kg, symmetric; singular when the contact cannot move in all directions.

    Raises:
        InputError: no such joint, or q of wrong shape or not finite.
        ModelError: the mass matrix is not positive definite.
    """
    contact, q = robot.contact(contact), robot.one_configuration(q)
    model, data = robot.model, robot.data
    jac = point_jacobian(model, data, q, contact)
    factor_mass_matrix(model, data, q)
    solved = np.column_stack([pin.cholesky.solve(model, data, row) for row in jac])
    product = jac @ solved
    return np.asarray((product + product.T) / 2)


def factor_mass_matrix(model: Any, data: Any, q: NDArray[np.float64]) -> None:
    """Leave the mass matrix M(q) and its Cholesky factors in `data`.

    Raises:
        ModelError: M is not positive definite; a link's mass or inertia is missing or wrong.
    """
    pin.crba(model, data, q)
    pin.cholesky.decompose(model, data)
    if not all(pivot > 0 for pivot in data.D.tolist()):
        if not any(body.mass > 0 for body in list(model.inertias)[1:]):
            raise ModelError(model.name, NO_MASS)
        raise ModelError(
            model.name,
            "its mass matrix is not positive definite: a link's mass or inertia is missing or "
            "wrong (hitjoints robots check names it)",
        )


def response(
    model: Any, data: Any, q: NDArray[np.float64], pull: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return u = M^-1 g, the joint velocities that a unit impulse of pull g = J^T h causes."""
    factor_mass_matrix(model, data, q)
    return np.asarray(pin.cholesky.solve(model, data, pull))


def mobility(
    model: Any, data: Any, q: NDArray[np.float64], contact: Contact, h: NDArray[np.float64]
) -> float:
    """Return h^T J M^-1 J^T h (1/kg), the inverse of the directional inertia."""
    g = h @ point_jacobian(model, data, q, contact)
    return float(g @ response(model, data, q, g))


def inertia_along(
    robot: Robot, q: NDArray[np.float64], contact: Contact, h: NDArray[np.float64]
) -> float:
    """Return lambda_h = 1 / (h^T Li h), kg, for checked arguments.

    Raises:
        InfeasibleError: the contact cannot move along h.
        ModelError: the mass matrix is not positive definite.
    """
    return _inertia_and_response(robot, q, contact, h)[0]


def inertia_and_gradient_along(
    robot: Robot, q: NDArray[np.float64], contact: Contact, h: NDArray[np.float64]
) -> tuple[float, NDArray[np.float64]]:
    """Return lambda_h (kg) and its gradient (n,) kg/rad, for checked arguments.

    With u = M^-1 J^T h held fixed,
    d lambda / dq = -lambda^2 (2 h^T d(J u)/dq - u^T (dM/dq) u).
    """
    inertia, u = _inertia_and_response(robot, q, contact, h)
    model, data, still = robot.model, robot.data, robot.still
    pin.computeForwardKinematicsDerivatives(model, data, q, u, still)
    # Of Pinocchio's velocity derivatives only the one of a point is d(J u)/dq.
    velocity_by_q = pin.getPointVelocityDerivatives(
        model, data, contact.joint, contact.placement, WORLD_ALIGNED
    )[0]
    momentum_by_q = pin.computeRNEADerivatives(robot.weightless_model, data, q, still, u)[0]
    pull_by_q = h @ velocity_by_q.reshape(3, robot.n)
    return inertia, -(inertia**2) * (2 * pull_by_q - u @ momentum_by_q)


def _inertia_and_response(
    robot: Robot, q: NDArray[np.float64], contact: Contact, h: NDArray[np.float64]
) -> tuple[float, NDArray[np.float64]]:
    jac = point_jacobian(robot.model, robot.data, q, contact)
    g = h @ jac
    u = response(robot.model, robot.data, q, g)
    mobility = float(g @ u)
    require_mobile(jac, mobility, contact, h)
    return 1.0 / mobility, u


def require_mobile(
    jacobian: NDArray[np.float64], mobility: float, contact: Contact, h: NDArray[np.float64]
) -> None:
    """Refuse a direction h that a contact of that Jacobian and mobility (1/kg) cannot move along.

    Raises:
        InfeasibleError: with the mobility, which is round-off.
    """
    if not moves(jacobian, h @ jacobian):
        raise InfeasibleError(
            f"infeasible direction: joint {contact.joint} cannot move along "
            f"({', '.join(f'{v:.4g}' for v in h)}) in this configuration",
            {"joint": contact.joint, "direction": h.tolist(), "mobility": mobility},
        )
