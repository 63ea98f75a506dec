"""What the drives of an arm can do: the limits that a motion keeps, and which of them are known."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from hitjoints.errors import InputError
from hitjoints.vectors import positive_per_joint

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from hitjoints.model.robot import Robot
    from hitjoints.types import Array

WITHIN = 1.0 - 1e-9
"""Share of a limit that is used, so that rounding never leads beyond it."""
SHAPING = 100.0
"""1/s: without a known jerk limit the acceleration is built up in a hundredth of a second."""


@dataclass(frozen=True, eq=False)
class DriveLimits:
    """Limits of every joint.

    Attributes:
        velocity_lower: (n,) rad/s.
        velocity_upper: (n,) rad/s.
        acceleration: (n,) rad/s^2.
        jerk: (n,) rad/s^3, what motions are shaped with.
        jerk_known: it is a limit of the arm or was given; else it is `SHAPING` times the
            acceleration, no more than a shape.
        effort: (n,) N m, infinite where not known.
        rotor_inertia: (n,) kg m^2, reflected; zero where not known.
        rotors_known: it is.
    """

    velocity_lower: Array
    velocity_upper: Array
    acceleration: Array
    jerk: Array
    jerk_known: bool
    effort: Array
    rotor_inertia: Array
    rotors_known: bool

    @property
    def acceleration_used(self) -> Array:
        """What motions are made with, (n,) rad/s^2."""
        return WITHIN * self.acceleration

    @property
    def jerk_used(self) -> Array:
        """What motions are made with, (n,) rad/s^3."""
        return WITHIN * self.jerk

    @property
    def unknown(self) -> tuple[str, ...]:
        """Names of what is not known, and so not kept."""
        torque = bool(np.isfinite(self.effort).all())
        known = {"jerk": self.jerk_known, "torque": torque, "rotor inertia": self.rotors_known}
        return tuple(name for name, is_known in known.items() if not is_known)


def drive_limits(
    robot: Robot, acceleration: ArrayLike | None = None, jerk: ArrayLike | None = None
) -> DriveLimits:
    """Return the limits of an arm.

    Args:
        robot: the arm.
        acceleration: rad/s^2, one number or (n,); by default the robot's.
        jerk: rad/s^3, one number or (n,); by default the robot's.

    Raises:
        InputError: a limit is not above zero, or no acceleration limit is known.
    """
    n = robot.n
    given = positive_per_joint(acceleration, n, "acceleration")
    most = robot.acceleration if given is None else given
    if most is None:
        expected = (
            f"{robot.name} does not tell its acceleration limits: give one number or {n}, in "
            "rad/s^2 (--acceleration), or add them to its TOML"
        )
        raise InputError("acceleration", None, expected)
    given = positive_per_joint(jerk, n, "jerk")
    shape = robot.jerk if given is None else given
    if not ((robot.velocity_lower <= 0) & (robot.velocity_upper >= 0)).all():
        raise InputError("robot", robot.name, "its velocity limits must allow standing still")
    told = np.isfinite(robot.effort) & (robot.effort > 0)
    rotors = robot.rotor_inertia
    return DriveLimits(
        robot.velocity_lower,
        robot.velocity_upper,
        np.asarray(most, dtype=float),
        SHAPING * most if shape is None else np.asarray(shape, dtype=float),
        shape is not None,
        np.where(told, robot.effort, np.inf),
        np.zeros(n) if rotors is None else rotors,
        rotors is not None,
    )
