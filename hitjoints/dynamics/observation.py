"""The arm seen from a contact: where it is, how it moves, what it weighs there."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import pinocchio as pin

from hitjoints.dynamics.inertia import inertia_and_gradient_along
from hitjoints.dynamics.kinematics import WORLD_ALIGNED

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from hitjoints.model.robot import Contact, Robot

    Array = NDArray[np.float64]


class State(NamedTuple):
    """The arm seen from the contact point.

    Attributes:
        position: (3,) m.
        J: (3, n) m/rad.
        inertia: kg.
        gradient: (n,) kg/rad.
    """

    position: Array
    J: Array
    inertia: float
    gradient: Array


def observe(robot: Robot, q: Array, contact: Contact, direction: Array) -> State:
    """Return what a control step needs to know, from one pass of kinematics.

    Raises:
        InfeasibleError: the contact cannot move along the direction.
    """
    inertia, gradient = inertia_and_gradient_along(robot, q, contact, direction)
    data, joint = robot.data, contact.joint
    # The call above has left the joints' placements and Jacobians in data.
    jac = pin.getFrameJacobian(robot.model, data, joint, contact.placement, WORLD_ALIGNED)
    where = data.oMi[joint].act(contact.placement.translation)
    return State(np.array(where), np.asarray(jac).reshape(6, robot.n)[:3], inertia, gradient)
