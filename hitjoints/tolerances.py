"""Where a number counts as zero: one place, so that every path draws the same line."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

MOBILITY_FLOOR = 1e-16
"""Below this h^T J M^-1 J^T h (1/kg) an inertia is not told from an infinite one."""

RANK = 1e-6
"""Motion below this share of a Jacobian's size, its Frobenius norm, counts as none.

Robot files write pi/2 as 1.5708, which gives a Jacobian of rank two a third singular value of up
to half of this; a direction kept to within it is kept to a millionth of a radian.
"""

AT_MAXIMUM = 1e-6
"""A wish that exceeds a maximum by no more than this share is at the maximum, and granted."""

STILL = 1e-9
"""Motion below this (m/rad) counts as none however small the Jacobian: a point on the axes."""


def moves(jacobian: NDArray[np.float64], pull: NDArray[np.float64]) -> bool:
    """Tell whether a point moves along h at all, by its Jacobian (3, n) and the pull J^T h (n,)."""
    return math.sqrt(pull @ pull) > float(rank_floor(jacobian))


def rank_floor(jacobian: NDArray[np.float64]) -> Any:
    """Return the size up to which a motion that a Jacobian tells of counts as none.

    The one notion of rank: singular values, rows across a direction and J^T h are compared with
    it, by the planner, the programs and the compiled formulas alike.

    Args:
        jacobian: (3, n), or (N, 3, n) for rows, m/rad.

    Returns:
        m/rad, a float or (N,).
    """
    return np.maximum(RANK * np.sqrt((jacobian * jacobian).sum(axis=(-2, -1))), STILL)


def exceeds(wish: float, most: float) -> bool:
    """Tell whether a wish is beyond a maximum by more than round-off and solvers may leave."""
    return wish > most * (1.0 + AT_MAXIMUM)


def told_apart(wish: float, most: float) -> tuple[str, str]:
    """Return two different numbers in words that differ, with four digits or as many as it takes.

    A refusal that says "1.14 of the 1.14 asked for" contradicts itself.
    """
    for digits in range(4, 17):
        words = f"{wish:.{digits}g}", f"{most:.{digits}g}"
        if words[0] != words[1]:
            break
    return words
