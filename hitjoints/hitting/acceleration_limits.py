"""Acceleration limits on the way: what a step may change, and that every joint can stop in time.

A joint that is as fast as it can stop from before its position limit, step by step, finds itself
there again after a step: from v it goes on at v - a dt. So the bounds of a step are never empty, as
long as an arm starts in such a state, as at rest.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from hitjoints.hitting.drive_limits import drive_limits
from hitjoints.hitting.stopping import stopping_speed

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from hitjoints.model.robot import Robot
    from hitjoints.types import Array

RECKONED = 1.0 - 1e-9
"""Share of the deceleration that stopping is reckoned with: rounding never asks for more."""


class Allowed(NamedTuple):
    """Joint velocities (n,) rad/s of a step, from `lower` to `upper`.

    Attributes:
        lower: rad/s.
        upper: rad/s.
        kept: the acceleration limits hold within; else positions or velocities left no such step.
    """

    lower: Array
    upper: Array
    kept: bool


class AccelerationLimits:
    """The acceleration limits of an arm that is commanded every dt.

    Args:
        robot: the arm.
        dt: s.
        acceleration: rad/s^2, one number or (n,); None for the robot's.

    Raises:
        InputError: a limit is not above zero, or the robot tells none.
    """

    def __init__(self, robot: Robot, dt: float, acceleration: ArrayLike | None = None) -> None:
        limits = drive_limits(robot, acceleration)
        self._robot, self._dt = robot, dt
        self.told = limits.acceleration
        self.rates = limits.acceleration_used

    def stopping(self, q: Array, lower: Array, upper: Array) -> tuple[Array, Array]:
        """Return the bounds (n,) rad/s with which joints also stop at their position limits."""
        robot, rates = self._robot, RECKONED * self.rates
        most = stopping_speed(robot.upper - q, rates, self._dt)
        least = -stopping_speed(q - robot.lower, rates, self._dt)
        return np.maximum(lower, least), np.minimum(upper, most)

    def near(self, qd: Array, lower: Array, upper: Array) -> Allowed:
        """Return the part of the bounds (n,) that a step from qd (n,) rad/s can reach.

        Where there is none, a joint goes as near to them as its bounds are to qd: positions and
        velocities come first.
        """
        change = self._dt * self.rates
        low, high = qd - change, qd + change
        kept = bool((low <= upper).all() and (high >= lower).all())
        return Allowed(
            np.minimum(np.maximum(lower, low), upper),
            np.maximum(np.minimum(upper, high), lower),
            kept,
        )
