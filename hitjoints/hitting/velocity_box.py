"""The joint velocities an arm can have in a configuration if it comes from rest and must stop.

A joint of velocity v has come the way v T / 2 from rest, and goes as far until it rests again, in
T = v / a + a / j with an acceleration that is built up and taken back at the greatest jerk. With
less than the greatest acceleration (v < a^2 / j) it would be faster, so the box is not too large.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from hitjoints.hitting.drive_limits import WITHIN

if TYPE_CHECKING:
    from hitjoints.hitting.drive_limits import DriveLimits
    from hitjoints.types import Array

ROOM = 0.98
"""Share of the way to a position limit that is used."""


def velocity_box(
    limits: DriveLimits, q: Array, lower: Array, upper: Array, coast: float | Array = 0.0
) -> tuple[Array, Array]:
    """Return the velocities that can be reached from rest, and stopped from, within positions.

    Args:
        limits: of the drives.
        q: (n,) or (N, n) rad, where the arm has these velocities.
        lower: (n,) rad, position limits, infinite where there are none.
        upper: (n,) rad, position limits, infinite where there are none.
        coast: s, how long they are kept afterwards; a number, or (N, 1).

    Returns:
        Lowest and highest velocities, as q, rad/s; both zero where there is no room.
    """
    behind, ahead = np.maximum(q - lower, 0.0), np.maximum(upper - q, 0.0)
    up = np.minimum(_fastest(limits, behind, 0.0), _fastest(limits, ahead, coast))
    down = np.minimum(_fastest(limits, ahead, 0.0), _fastest(limits, behind, coast))
    return (
        -np.minimum(down, -WITHIN * limits.velocity_lower),
        np.minimum(up, WITHIN * limits.velocity_upper),
    )


def _fastest(limits: DriveLimits, room: Array, coast: float | Array) -> Array:
    """Return the v with v^2 / a + v a / j + 2 v coast = 2 room, as room, in rad/s."""
    a = limits.acceleration_used
    linear = a / limits.jerk_used + 2.0 * coast
    with np.errstate(invalid="ignore"):  # infinite room
        half = 0.5 * a * linear
        v = 2.0 * ROOM * room * a / (half + np.sqrt(half**2 + 2.0 * ROOM * room * a))
    return np.where(np.isinf(room), np.inf, v)
