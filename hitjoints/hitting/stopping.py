"""How fast a joint may be to stop in time, and how hard it must brake to, counted in steps."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from hitjoints.types import Array

TINY = 1e-12
"""In place of zero where a ratio has no bound."""


def stopping_speed(distance: Array, rate: Array, dt: float) -> Array:
    """Return the greatest speeds (..., n) from which joints stop within distances (..., n).

    Step by step: with v the speed of the coming step and a deceleration `rate` (n,) from then on,
    the way is dt (v + (v - rate dt) + (v - 2 rate dt) + ...); this solves it for v.
    """
    with np.errstate(invalid="ignore"):  # a joint without limits is infinitely far from them
        more = np.floor((np.sqrt(1.0 + 8.0 * distance / (rate * dt**2)) - 1.0) / 2.0)
        speed = distance / ((more + 1.0) * dt) + rate * dt * more / 2.0
    return np.where(np.isfinite(distance), np.maximum(speed, 0.0), np.inf)


def stopping_rate(distance: Array, speed: Array, dt: float) -> Array:
    """Return the decelerations (n,) with which joints stop within distances (n,) after a step.

    The step at `speed` (n,) ends here; the way still to come is dt ((v - a dt) + (v - 2 a dt) +
    ...), and this solves it for a.
    """
    share = np.maximum(distance, 0.0) / np.maximum(speed * dt, TINY)
    with np.errstate(invalid="ignore"):  # a joint without limits has all the way it wants
        steps = np.floor(2.0 * share) + 1.0
        rate = 2.0 * speed * (steps - share) / (steps * (steps + 1.0) * dt)
    return np.where(np.isfinite(distance), rate, 0.0)
