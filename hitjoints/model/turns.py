"""Joints that turn further than once: where to look, and which of many equal angles to answer."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from hitjoints.types import Array

    Flags = NDArray[np.bool_]

TURN = 2 * np.pi
FAR = 2 * TURN * (1 + 1e-6)  # rad; beyond two turns a limit stands for none
FAR_SLIDE = 20.0  # m, the same for a prismatic joint
SLIDE = 2.0  # m, the way along such a joint that is looked at


def middle(lower: Array, upper: Array, turning: Flags) -> Array:
    """Return the middle of the position limits; near zero where they are far apart or missing.

    Args:
        lower: (n,) rad or m, infinite where there is none.
        upper: (n,) as well.
        turning: (n,) whether a joint is revolute.
    """
    far = _far(lower, upper, turning)
    with np.errstate(invalid="ignore", over="ignore"):
        return np.where(far, np.clip(0.0, lower, upper), (lower + upper) / 2)


def search_range(lower: Array, upper: Array, home: Array, turning: Flags) -> tuple[Array, Array]:
    """Return the limits as far as there is something new to find: one turn around home of many.

    Args:
        lower: as `middle`.
        upper: as `middle`.
        turning: as `middle`.
        home: (n,) within the limits.

    Returns:
        (n,) and (n,), finite.
    """
    far = _far(lower, upper, turning)
    width = np.where(turning, TURN, SLIDE)
    low = np.minimum(np.maximum(home - width / 2, lower), upper - width)
    return np.where(far, low, lower), np.where(far, low + width, upper)


def nearest_turn(q: Array, lower: Array, upper: Array, home: Array, turning: Flags) -> Array:
    """Return the same configurations with every angle as near to home as the limits allow.

    Args:
        q: (n,) or (N, n) rad or m, within the limits.
        lower: as `search_range`.
        upper: as `search_range`.
        home: as `search_range`.
        turning: as `search_range`.
    """
    turns = np.where(turning, np.round((home - q) / TURN), 0.0)
    if not turns.any():
        return q
    for _ in range(2):
        moved = q + TURN * turns
        beyond = (moved < lower) | (moved > upper)
        turns = np.where(beyond, turns - np.sign(turns), turns)
    return np.asarray(np.where(turns == 0, q, q + TURN * turns))


def _far(lower: Array, upper: Array, turning: Flags) -> Flags:
    with np.errstate(over="ignore"):  # the largest number there is may stand for no limit
        return np.asarray(upper - lower > np.where(turning, FAR, FAR_SLIDE))
