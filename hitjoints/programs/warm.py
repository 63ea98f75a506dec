"""The same small QP again and again with slowly changing numbers: warm starts, checked answers."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from hitjoints.errors import HitjointsError
from hitjoints.programs import solver
from hitjoints.programs.problem import Program

if TYPE_CHECKING:
    from hitjoints.programs.back_end import Warm
    from hitjoints.programs.problem import Matrix, Vector

ROWS = 1e-7
"""Largest violation of the equalities that is accepted, its norm in the rows' unit."""
GAP = 1e-7
"""Largest distance from the optimal cost that is accepted, relative to 1 + |cost|."""
GUESSES = 4
"""Active sets tried before ProxQP is asked."""


class WarmProgram:
    """Minimise 1/2 x^T H x + c^T x subject to A x = b, lower <= x <= upper, for a control loop.

    From one step to the next mostly the same bounds are active: with them known, the answer is
    that of one linear system. If it is not, a few steps of the primal-dual active set method mend
    the guess, and then ProxQP, starting from its previous answer, makes a new one. Whatever the
    way, an answer is returned only if its residuals, computed here, are small; else the program is
    solved from scratch by `programs.solver.solve`, which certifies what it returns.

    ProxQP's last digits depend on where in memory its numbers lie; those of the linear system do
    not. Same numbers in, same bits out.

    Args:
        n: number of variables.
        m: number of equalities.

    Attributes:
        warm: how many answers took ProxQP, and how many the certifying solver.
        cold: how many answers took ProxQP, and how many the certifying solver.
    """

    def __init__(self, n: int, m: int) -> None:
        self.n, self.m, self.warm, self.cold = n, m, 0, 0
        self._side = np.zeros(n)  # -1 at the lower bound, 1 at the upper, 0 between
        self._system = np.zeros((n + m, n + m))
        self._right = np.zeros(n + m)
        self._qp: Warm | None = None

    def solve(
        self, H: Matrix, c: Vector, A: Matrix, b: Vector, lower: Vector, upper: Vector
    ) -> Vector | None:
        """Return the minimiser (n,), within the bounds to the last bit; None if none is certified.

        Args:
            H: (n, n), symmetric positive definite.
            c: (n,).
            A: (m, n), (m,).
            b: (m, n), (m,).
            lower: (n,), finite.
            upper: (n,), finite.
        """
        known = self._follow(H, c, A, b, lower, upper, GUESSES)
        if known is not None:
            return known
        self.warm += 1
        x, y = self._proximal(H, c, A, b, lower, upper)
        self._guess(x, y, H, c, A, lower, upper)
        exact = self._follow(H, c, A, b, lower, upper, GUESSES)
        if exact is not None:
            return exact
        if certified(H, c, A, b, lower, upper, x, y):
            return x
        self._qp = None  # the next program starts without this one's iterate
        self.cold += 1
        try:
            return solver.solve(Program(c, lower, upper, H=H, A=A, b=b)).x
        except HitjointsError:
            return None

    def _follow(
        self, H: Matrix, c: Vector, A: Matrix, b: Vector, lower: Vector, upper: Vector, tries: int
    ) -> Vector | None:
        """Return the certified minimiser that a few guesses of the active bounds lead to."""
        n, K, right = self.n, self._system, self._right
        for _ in range(tries):
            K[:n, :n], K[:n, n:], K[n:, :n] = H, A.T, A
            right[:n], right[n:] = -c, b
            for i in self._side.nonzero()[0].tolist():
                K[i] = 0.0
                K[i, i] = 1.0
                right[i] = upper[i] if self._side[i] > 0 else lower[i]
            try:
                free: Vector = np.asarray(np.linalg.solve(K, right))
            except np.linalg.LinAlgError:  # equalities that depend on each other
                free = np.asarray(np.linalg.lstsq(K, right)[0])
            x: Vector = np.minimum(np.maximum(free[:n], lower), upper)
            y: Vector = free[n:]
            if certified(H, c, A, b, lower, upper, x, y):
                return x
            self._guess(free[:n], y, H, c, A, lower, upper)
        return None

    def _guess(
        self, x: Vector, y: Vector, H: Matrix, c: Vector, A: Matrix, lower: Vector, upper: Vector
    ) -> None:
        """Note which bounds are active: those whose multiplier exceeds their slack."""
        push = -(H @ x + c + y @ A)
        self._side = np.where(push > upper - x, 1.0, np.where(push < lower - x, -1.0, 0.0))

    def _proximal(
        self, H: Matrix, c: Vector, A: Matrix, b: Vector, lower: Vector, upper: Vector
    ) -> tuple[Vector, Vector]:
        """Return the back end's answer x (n,), within the bounds, and the multipliers y (m,)."""
        if self._qp is None:
            self._qp = solver.BACK_END.WarmStart(self.n, self.m)
        x, y = self._qp(H, c, A, b, lower, upper)
        return np.minimum(np.maximum(x, lower), upper), y


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
    gap = r @ np.where(r > 0.0, x - lower, x - upper) + abs(y @ miss)
    size = 1.0 + abs(c @ x)
    return bool(miss @ miss <= ROWS * ROWS and gap <= GAP * size)
