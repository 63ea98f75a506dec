"""The straight hitting speed's linear program, answered in closed form and certified, or not."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np

from hitjoints.kernels.formulas.straight_motion import straight_motion_of
from hitjoints.kernels.tape.counted import CountedProgram

if TYPE_CHECKING:
    from hitjoints.programs.problem import Vector

FLOAT = np.dtype(float)
CERTIFIED = 1e-12
"""Residuals up to which an answer needs no other: round-off, a little amplified."""
WORTH_COMPILING = 600
"""Programs of one size after which their formulas are compiled."""


def certified_motion(
    jacobian: Any, direction: Any, lower: Any, upper: Any
) -> tuple[float, Vector, float, float] | None:
    """Return the greatest speed straight along a direction (m/s), velocities (n,) rad/s that have
    it, and the primal residual and duality gap; None if they are too large to believe it, or if
    the input is anything but arrays of floats that make sense.
    """
    for array in (jacobian, direction, lower, upper):
        if type(array) is not np.ndarray or array.dtype is not FLOAT:
            return None
    n = lower.size
    shapes = jacobian.shape, direction.shape, lower.shape, upper.shape
    if shapes != ((3, n), (3,), (n,), (n,)) or not n:
        return None
    found = _formulas(n)(jacobian, direction, lower, upper)
    if not found:
        return None
    usable, speed, primal, gap = found[0], found[1], found[n + 2], found[n + 3]
    if not (usable > 0.0 and primal <= CERTIFIED and gap <= CERTIFIED):
        return None
    return speed, np.array(found[2 : n + 2]), primal, gap


@cache
def _formulas(n: int) -> CountedProgram:
    return CountedProgram(straight_motion_of, 5 * n + 3, WORTH_COMPILING)
