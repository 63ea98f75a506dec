"""What is asked of the arm: hit this object, there, that way, with that flux."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import pinocchio as pin

from hitjoints.dynamics.inertia import inertia_and_gradient_along
from hitjoints.dynamics.kinematics import WORLD_ALIGNED
from hitjoints.errors import InputError
from hitjoints.vectors import points, unit

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from hitjoints.model.robot import Contact, Robot

    Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Hit:
    """A desired hit.

    Attributes:
        contact: joint number or Contact, what the object is hit with.
        position: (3,) m, where it is hit, robot base frame.
        direction: (3,) hitting direction, unit length after construction.
        mass: kg, of the object, at rest.
        flux: m/s, desired directional flux (Eq. 4).

    Raises:
        InputError: an argument is out of its range, of wrong shape or not finite.
    """

    contact: Contact | int
    position: Array
    direction: Array
    mass: float
    flux: float

    def __post_init__(self) -> None:
        position, direction = points(self.position, "position"), unit(self.direction)
        for name, vector in (("position", position), ("direction", direction)):
            if vector.shape != (3,):
                raise InputError(name, f"shape {vector.shape}", "three numbers x,y,z")
            fixed = np.array(vector)
            fixed.setflags(write=False)
            object.__setattr__(self, name, fixed)
        if not (math.isfinite(self.mass) and self.mass > 0):
            raise InputError("mass", self.mass, "an object weighs more than 0 kg")
        if not (math.isfinite(self.flux) and self.flux > 0):
            raise InputError("flux", self.flux, "a desired flux is finite and above 0 m/s")

    @property
    def words(self) -> str:
        """What is hit, where and which way, such as "2 kg at (0.5, 0.3, 0.5) m along (0, 1, 0)"."""
        at = ", ".join(f"{v:g}" for v in self.position)
        along = ", ".join(f"{v:.4g}" for v in self.direction)
        return f"{self.mass:g} kg at ({at}) m along ({along})"

    def speed(self, inertia: float) -> float:
        """Return the speed (m/s) that produces the flux at an inertia (kg): Eq. 4 solved for v."""
        return (1.0 + self.mass / inertia) * self.flux

    def flux_of(self, inertia: float, speed: float) -> float:
        """Return the flux (m/s) of an inertia (kg) and a speed (m/s), Eq. 4."""
        return inertia / (inertia + self.mass) * speed


class State(NamedTuple):
    """The arm seen from the contact point.

    Attributes:
        position: (3,) m. J: (3, n) m/rad. inertia: kg. gradient: (n,) kg/rad.
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
