"""The same small QP again and again with slowly changing numbers: warm starts, checked answers."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from hitjoints.errors import HitjointsError
from hitjoints.programs.problem import Program
from hitjoints.programs.proxqp import solve, warm_qp

if TYPE_CHECKING:
    from hitjoints.programs.problem import Matrix, Vector

ROWS = 1e-7
"""Largest violation of an equality that is accepted, in the row's unit."""
GAP = 1e-7
"""Largest distance from the optimal cost that is accepted, relative to 1 + |cost|."""


class WarmProgram:
    """Minimise 1/2 x^T H x + c^T x subject to A x = b, lower <= x <= upper, for a control loop.

    ProxQP starts from its previous answer. The new one is accepted only if, clipped to the bounds,
    it satisfies the equalities and its duality gap is small, both computed here. Otherwise the
    program is solved from scratch by `programs.proxqp.solve`, which certifies what it returns.

    Args:
        n: number of variables.
        m: number of equalities.

    Attributes:
        cold: how many answers took the second way.
    """

    def __init__(self, n: int, m: int) -> None:
        self.n, self.m, self.cold = n, m, 0
        self._qp: Any = None

    def solve(
        self, H: Matrix, c: Vector, A: Matrix, b: Vector, lower: Vector, upper: Vector
    ) -> Vector | None:
        """Return the minimiser (n,), within the bounds to the last bit; None if none is certified.

        Args:
            H: (n, n), symmetric positive definite.
            c: (n,). A, b: (m, n), (m,). lower, upper: (n,), finite.
        """
        if self._qp is None:
            self._qp = warm_qp(self.n, self.m)
            self._qp.init(H, c, A, b, None, None, None, lower, upper)
        else:
            self._qp.update(H=H, g=c, A=A, b=b, l_box=lower, u_box=upper)
        self._qp.solve()
        found = self._qp.results
        x = np.minimum(np.maximum(found.x, lower), upper)
        if certified(H, c, A, b, lower, upper, x, np.asarray(found.y)):
            return x
        self._qp = None  # the next program starts without this one's iterate
        self.cold += 1
        try:
            return solve(Program(c, lower, upper, H=H, A=A, b=b)).x
        except HitjointsError:
            return None


def certified(
    H: Matrix,
    c: Vector,
    A: Matrix,
    b: Vector,
    lower: Vector,
    upper: Vector,
    x: Vector,
    y: Vector,
) -> bool:
    """Tell whether x (n,), within the bounds, is a minimiser, by the multipliers y (m,).

    With r = H x + c + A^T y, the cost of any feasible point exceeds that of x by no less than
    -sum_i max(r_i (x_i - lower_i), r_i (x_i - upper_i)) - y^T (A x - b): strong duality with the
    best multipliers of the bounds. Numbers that are not finite fail every comparison.
    """
    miss = A @ x - b
    curved = H @ x
    r = curved + c + y @ A
    gap = np.maximum(r * (x - lower), r * (x - upper)).sum() + abs(y @ miss)
    size = 1.0 + abs(c @ x)
    return bool(np.abs(miss).max(initial=0.0) <= ROWS and gap <= GAP * size)
