"""Where a number counts as zero: one place, so that every path draws the same line."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

MOBILITY_FLOOR = 1e-16
"""Below this h^T J M^-1 J^T h (1/kg) a contact cannot move along h: an infeasible direction."""

RANK = 1e-6
"""Motion below this share of a Jacobian's size, its Frobenius norm, counts as none.

Robot files write pi/2 as 1.5708, which gives a Jacobian of rank two a third singular value of up
to half of this; a direction kept to within it is kept to a millionth of a radian.
"""

STILL = 1e-9
"""Motion below this (m/rad) counts as none however small the Jacobian: a point on the axes."""


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
