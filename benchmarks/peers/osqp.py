"""OSQP, through qpsolvers as the authors use it, and by itself, set up once.

With its usual tolerance of 1e-3 the answer of Eq. 12, whose curvature is 1e-4 in most directions,
is wrong by as much as it is large. Polishing alone mends that only where few bounds are active.
"""

from __future__ import annotations

from typing import Any

import numpy as np

ACCURACY: dict[str, Any] = {"polishing": True, "eps_abs": 1e-6, "eps_rel": 1e-6, "max_iter": 20000}


class QpSolvers:
    """Minimise 1/2 x^T P x + c^T x, A x = b, lower <= x <= upper: each program from scratch."""

    def __init__(self) -> None:
        import osqp  # noqa: F401  (qpsolvers itself would miss it only later)
        import qpsolvers
        from scipy.sparse import csc_matrix

        self.solve_qp, self.sparse = qpsolvers.solve_qp, csc_matrix

    def __call__(self, P: Any, c: Any, A: Any, b: Any, lower: Any, upper: Any) -> Any:
        """Return x (n,)."""
        return self.solve_qp(
            self.sparse(P), c, A=self.sparse(A), b=b, lb=lower, ub=upper,
            solver="osqp", **ACCURACY,
        )  # fmt: skip


class OsqpInPlace:
    """The same for programs of one shape, whose numbers are exchanged and whose iterate stays."""

    def __init__(self) -> None:
        import osqp
        from scipy.sparse import csc_matrix

        self.library, self.sparse = osqp, csc_matrix
        self.solver: Any = None

    def __call__(self, P: Any, c: Any, A: Any, b: Any, lower: Any, upper: Any) -> Any:
        """Return x (n,)."""
        n, low, high = len(c), np.concatenate((b, lower)), np.concatenate((b, upper))
        if self.solver is None:
            self.solver = self.library.OSQP()
            self.column, self.row = np.tril_indices(n)  # of P's upper triangle, column by column
            full = self.sparse(np.triu(np.ones((n, n))))
            rows = self.sparse(np.vstack((np.ones_like(A), np.eye(n))))
            self.solver.setup(full, c, rows, low, high, verbose=False, **ACCURACY)
        rows = np.vstack((A, np.ones(n))).T.ravel()
        self.solver.update(Px=P[self.row, self.column], q=c, Ax=rows, l=low, u=high)
        return self.solver.solve(raise_error=True).x
