"""When a contact crosses the plane through the object, within a step."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from hitjoints.types import Array

ROUNDS = 60
NARROW = 1e-15
"""Share of the step, and m, below which a bracket or a distance is rounding."""


def crossing(ahead: Callable[[float], float], dt: float) -> float:
    """Return the time in [0, dt] at which ahead(t), positive at 0 and not at dt, vanishes."""
    return float(crossings(lambda t: np.array([ahead(float(t[0]))]), np.array([dt]))[0])


def crossings(ahead: Callable[[Array], Array], dt: Array) -> Array:
    """Return the same for many at once: (N,) times, of distances ahead(t) (N,), within dt (N,).

    By the Illinois variant of the secant method, to rounding.
    """
    early, late, side = np.zeros_like(dt), dt.copy(), np.zeros_like(dt)
    before, after = ahead(early), ahead(late)
    for _ in range(ROUNDS):
        on = (after != 0) & (late - early > NARROW * dt)
        if not on.any():
            break
        gap = np.where(on, after - before, 1.0)
        middle = np.where(on, (early * after - late * before) / gap, late)
        value = ahead(middle)
        near, far = on & (value > 0), on & ~(value > 0)
        early, before = np.where(near, middle, early), np.where(near, value, before)
        after = np.where(near & (side == 1), after / 2, after)
        late, after = np.where(far, middle, late), np.where(far, value, after)
        before = np.where(far & (side == -1), before / 2, before)
        side = np.where(near, 1.0, np.where(far, -1.0, side))
        there = on & (np.abs(value) < NARROW)
        late, after = np.where(there, middle, late), np.where(there, 0.0, after)
    return late
