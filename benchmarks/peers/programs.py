"""Solvers of small programs, each called by hand.

An object of a class here is called with (P, c, A, b, lower, upper) and returns the x (n,) that
minimises 1/2 x^T P x + c^T x subject to A x = b, lower <= x <= upper. P may be None: linear.
"""

from __future__ import annotations

from typing import Any

import numpy as np


class Highs:
    """HiGHS through SciPy's linprog; linear programs only."""

    def __init__(self) -> None:
        from scipy.optimize import linprog

        self.linprog = linprog

    def __call__(self, P: Any, c: Any, A: Any, b: Any, lower: Any, upper: Any) -> Any:
        """Return x (n,)."""
        bounds = np.column_stack((lower, upper))
        return self.linprog(c, A_eq=A, b_eq=b, bounds=bounds, method="highs").x


class Daqp:
    """A dual active set method."""

    def __init__(self) -> None:
        import daqp

        self.daqp = daqp

    def __call__(self, P: Any, c: Any, A: Any, b: Any, lower: Any, upper: Any) -> Any:
        """Return x (n,)."""
        sense = np.zeros(len(c) + len(b), dtype=np.int32)
        sense[len(c) :] = 5  # equalities
        low, high = np.concatenate((lower, b)), np.concatenate((upper, b))
        return self.daqp.solve(P, c, A, high, low, sense)[0]


class Quadprog:
    """The dual method of Goldfarb and Idnani; strictly convex programs only."""

    def __init__(self) -> None:
        import quadprog

        self.quadprog = quadprog

    def __call__(self, P: Any, c: Any, A: Any, b: Any, lower: Any, upper: Any) -> Any:
        """Return x (n,)."""
        ones = np.eye(len(c))
        rows, sides = np.hstack((A.T, ones, -ones)), np.concatenate((b, lower, -upper))
        return self.quadprog.solve_qp(P, -c, rows, sides, len(b))[0]


class Clarabel:
    """An interior point method."""

    def __init__(self) -> None:
        import clarabel
        from scipy.sparse import csc_matrix

        self.clarabel, self.sparse = clarabel, csc_matrix
        self.settings = clarabel.DefaultSettings()
        self.settings.verbose = False
        # Its usual 1e-8 of the cost leaves the fifth digit of x open.
        for name in ("tol_gap_abs", "tol_gap_rel", "tol_feas"):
            setattr(self.settings, name, 1e-10)

    def __call__(self, P: Any, c: Any, A: Any, b: Any, lower: Any, upper: Any) -> Any:
        """Return x (n,)."""
        n, library = len(c), self.clarabel
        rows = self.sparse(np.vstack((A, np.eye(n), -np.eye(n))))
        cones = [library.ZeroConeT(len(b)), library.NonnegativeConeT(2 * n)]
        curved = self.sparse((n, n)) if P is None else self.sparse(np.triu(P))
        sides = np.concatenate((b, upper, -lower))
        return np.array(
            library.DefaultSolver(curved, c, rows, sides, cones, self.settings).solve().x
        )


class ProxQP:
    """ProxSuite's dense solver with bounds, as accurate as ours asks it to be, not certified."""

    def __init__(self) -> None:
        from proxsuite import proxqp

        self.proxqp = proxqp

    def __call__(self, P: Any, c: Any, A: Any, b: Any, lower: Any, upper: Any) -> Any:
        """Return x (n,)."""
        qp = self.new(len(c), len(b))
        qp.init(P, c, A, b, None, None, None, lower, upper)
        qp.solve()
        return np.array(qp.results.x)

    def new(self, n: int, m: int) -> Any:
        """Return an empty solver."""
        qp = self.proxqp.dense.QP(n, m, 0, True)
        qp.settings.eps_abs, qp.settings.eps_rel = 1e-9, 0.0
        # Its usual thresholds take small programs for infeasible.
        qp.settings.eps_primal_inf = qp.settings.eps_dual_inf = 1e-14
        return qp


class ProxQPInPlace(ProxQP):
    """The same, kept from one program to the next, which starts where the last one ended."""

    def __init__(self) -> None:
        super().__init__()
        self.qp: Any = None

    def __call__(self, P: Any, c: Any, A: Any, b: Any, lower: Any, upper: Any) -> Any:
        """Return x (n,)."""
        if self.qp is None:
            self.qp = self.new(len(c), len(b))
            guess = self.proxqp.InitialGuess
            self.qp.settings.initial_guess = guess.WARM_START_WITH_PREVIOUS_RESULT
            self.qp.init(P, c, A, b, None, None, None, lower, upper)
        else:
            self.qp.update(H=P, g=c, A=A, b=b, l_box=lower, u_box=upper)
        self.qp.solve()
        return np.array(self.qp.results.x)
