"""The one file that speaks ProxSuite: its answers, which are approximate and not to be believed.

ProxQP's own verdicts are not trusted. Its default infeasibility thresholds (1e-4) call feasible
small programs infeasible, so they are switched off; its "solved" is checked elsewhere, with our
residuals; and its iteration caps are set for programs of a dozen variables, where the defaults can
run for seconds.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from proxsuite import proxqp

if TYPE_CHECKING:
    from collections.abc import Iterator

    from hitjoints.programs.problem import Matrix, Program, Vector


class Settings(NamedTuple):
    """What differs between attempts: ProxQP's accuracy and proximal parameters."""

    accuracy: float
    rho: float
    mu_eq: float
    mu_in: float


# The first settles nearly everything. The second, with little damping, decides multipliers that
# the first cannot tell from zero; the third, with much, and the fourth get through where the others
# stall. All start cold. At an accuracy of 1e-5 a linear program can be 13 % off.
ATTEMPTS = (
    Settings(1e-9, 1e-6, 1e-3, 1e-1),
    Settings(1e-12, 1e-7, 1e-6, 1e-5),
    Settings(1e-9, 1e-3, 1e-2, 1.0),
    Settings(1e-9, 1e-6, 1e-2, 1e-2),
)
# Infeasibility is not for ProxQP to decide: at its default threshold of 1e-4 a third of feasible
# programs, at 1e-13 still one in a hundred that are only just feasible, are given up as infeasible.
NEVER = 0.0
CAP = 50  # outer, and inner per outer, iterations: a dozen variables need at most about 20


def attempts(unit: Program) -> Iterator[tuple[Vector, Vector, Vector]]:
    """Yield ProxQP's last iterate (u, y, z) of a scaled program, one setting after the other."""
    for settings in ATTEMPTS:
        yield _attempt(unit, settings)


class WarmStart:
    """A dense QP, n variables with bounds and m equalities, that starts from its previous answer.

    Its duality gap is left unchecked, which costs half its time: who uses it checks the answer.
    """

    def __init__(self, n: int, m: int) -> None:
        self._qp: Any = proxqp.dense.QP(n, m, 0, True)
        self._begun = False
        chosen = self._qp.settings
        chosen.eps_abs, chosen.eps_rel = ATTEMPTS[0].accuracy, 0.0
        chosen.eps_primal_inf = chosen.eps_dual_inf = NEVER
        chosen.max_iter = chosen.max_iter_in = CAP
        chosen.initial_guess = proxqp.InitialGuess.WARM_START_WITH_PREVIOUS_RESULT

    def __call__(
        self, H: Matrix, c: Vector, A: Matrix, b: Vector, lower: Vector, upper: Vector
    ) -> tuple[Vector, Vector]:
        """Return x (n,), which may leave the bounds a little, and the multipliers y (m,)."""
        if self._begun:
            self._qp.update(H=H, g=c, A=A, b=b, l_box=lower, u_box=upper)
        else:
            self._qp.init(H, c, A, b, None, None, None, lower, upper)
            self._begun = True
        self._qp.solve()
        return np.array(self._qp.results.x), np.array(self._qp.results.y)


def _attempt(unit: Program, settings: Settings) -> tuple[Vector, Vector, Vector]:
    n, m, p = unit.n, unit.b.size, unit.d.size
    kind = proxqp.dense.HessianType.Zero if unit.H is None else proxqp.dense.HessianType.Dense
    qp: Any = proxqp.dense.QP(n, m, p, True, hessian_type=kind)
    chosen = qp.settings
    chosen.eps_abs, chosen.eps_rel = settings.accuracy, 0.0
    chosen.check_duality_gap = True
    chosen.eps_duality_gap_abs, chosen.eps_duality_gap_rel = settings.accuracy, 0.0
    chosen.eps_primal_inf = chosen.eps_dual_inf = NEVER
    chosen.max_iter = chosen.max_iter_in = CAP
    chosen.initial_guess = proxqp.InitialGuess.NO_INITIAL_GUESS
    qp.init(
        unit.H,
        unit.c,
        unit.A if m else None,
        unit.b if m else None,
        unit.C if p else None,
        np.full(p, -np.inf) if p else None,
        unit.d if p else None,
        unit.lower,
        unit.upper,
        rho=settings.rho,
        mu_eq=settings.mu_eq,
        mu_in=settings.mu_in,
    )
    qp.solve()
    found = qp.results  # its arrays are views of memory that dies with qp
    return np.array(found.x), np.array(found.y), np.array(found.z[:p])
