"""A contact on its robot, checked once: what a loop asks of it many thousand times a second."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import pinocchio as pin

from hitjoints.dynamics.inertia import inertia_along, inertia_and_gradient_along
from hitjoints.dynamics.kinematics import WORLD_ALIGNED, point_jacobian

if TYPE_CHECKING:
    from hitjoints.model.robot import Contact, Robot
    from hitjoints.types import Array


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


class ContactPoint:
    """A contact resolved against its robot; its methods take configurations as they come.

    Args:
        robot: the arm.
        contact: joint number or Contact.

    Raises:
        InputError: there is no such joint.
    """

    def __init__(self, robot: Robot, contact: Contact | int) -> None:
        self.robot, self.contact = robot, robot.contact(contact)
        self._offset = np.array(self.contact.offset)

    def position(self, q: Array) -> Array:
        """Return the point (3,) m at q (n,) rad."""
        data = self.robot.data
        pin.forwardKinematics(self.robot.model, data, q)
        return np.array(data.oMi[self.contact.joint].act(self._offset))

    def jacobian(self, q: Array) -> Array:
        """Return its translational Jacobian (3, n) m/rad at q (n,) rad."""
        return point_jacobian(self.robot.model, self.robot.data, q, self.contact)

    def inertia(self, q: Array, h: Array) -> float:
        """Return the inertia (kg) along a unit direction h (3,) at q (n,) rad.

        Raises:
            InfeasibleError: the contact cannot move along h.
        """
        return inertia_along(self.robot, q, self.contact, h)

    def observe(self, q: Array, h: Array) -> State:
        """Return what a control step along h (3,) needs at q (n,) rad, from one pass of kinematics.

        Raises:
            InfeasibleError: the contact cannot move along h.
        """
        robot, contact = self.robot, self.contact
        inertia, gradient = inertia_and_gradient_along(robot, q, contact, h)
        data, joint = robot.data, contact.joint
        # The call above has left the joints' placements and Jacobians in data.
        jac = pin.getFrameJacobian(robot.model, data, joint, contact.placement, WORLD_ALIGNED)
        where = data.oMi[joint].act(contact.placement.translation)
        return State(np.array(where), np.asarray(jac).reshape(6, robot.n)[:3], inertia, gradient)
