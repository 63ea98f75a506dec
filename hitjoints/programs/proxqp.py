"""The one door to ProxSuite: solve, certify, and say infeasible only when it is shown.

ProxQP's own verdicts are not trusted. Its default infeasibility thresholds (1e-4) call feasible
small programs infeasible, so they are switched off; its
"solved" is checked with our residuals; and its iteration caps are set for programs of a dozen
variables, where the defaults can run for seconds.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from proxsuite import proxqp

from hitjoints.errors import InfeasibleError, SolverError
from hitjoints.programs.active_set import polish
from hitjoints.programs.infeasibility import Infeasibility, show_blocked, show_infeasible
from hitjoints.programs.problem import Program, Solution, residuals
from hitjoints.programs.scaling import Scaled, scaled

if TYPE_CHECKING:
    from collections.abc import Iterator

    from hitjoints.programs.problem import Vector

CERTIFIED = 1e-8  # residuals, relative, at or below which an answer counts as solved
EXACT = 1e-12  # residuals at which no other attempt is made: round-off, a little amplified
POLISHES = 3  # active set steps: a wrong first guess is mended by the second, rarely the third


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


def solve(program: Program) -> Solution:
    """Solve a small convex program.

    Returns:
        A solution whose residuals are at most `CERTIFIED`, its x within the bounds exactly.

    Raises:
        InfeasibleError: no x meets the constraints; `data` holds the multipliers that prove it.
        SolverError: neither a solution nor a proof of infeasibility was found. It can happen
            within about 1e-8 of where feasibility ends, and with rows that are parallel to
            between 1e-9 and 1e-7, whose multipliers are too large to certify an answer.
    """
    proof = show_blocked(program)
    if proof is not None and proof.relative > CERTIFIED:
        raise _refusal(proof)
    best: Solution | None = None
    for answer in answers(program):
        if best is None and answer.residuals.worst > CERTIFIED:
            proof = show_infeasible(program)
            if proof is not None and proof.relative > CERTIFIED:
                raise _refusal(proof)
        best = answer if best is None else _better(best, answer)
        if best.residuals.worst <= EXACT:
            return best
    if best is not None and best.residuals.worst <= CERTIFIED:
        return best
    if proof is not None:
        raise _refusal(proof)
    raise SolverError(
        f"no certified solution of {program.n} variables and no proof that there is none: "
        f"{best and best.residuals}, {CERTIFIED:.0e} is asked"
    )


def warm_qp(n: int, m: int) -> Any:
    """Return an empty dense QP, n variables with bounds and m equalities, that starts warm.

    Its duality gap is left unchecked, which costs half its time: who uses it checks the answer.
    """
    qp: Any = proxqp.dense.QP(n, m, 0, True)
    chosen = qp.settings
    chosen.eps_abs, chosen.eps_rel = ATTEMPTS[0].accuracy, 0.0
    chosen.eps_primal_inf = chosen.eps_dual_inf = NEVER
    chosen.max_iter = chosen.max_iter_in = CAP
    chosen.initial_guess = proxqp.InitialGuess.WARM_START_WITH_PREVIOUS_RESULT
    return qp


def answers(program: Program) -> Iterator[Solution]:
    """Yield the polished answer of each attempt, good or bad: its residuals tell."""
    small = scaled(program)
    for settings in ATTEMPTS:
        yield _polished(program, small, *_attempt(small.program, settings))


def _polished(program: Program, small: Scaled, u: Vector, y: Vector, z: Vector) -> Solution:
    point = tuple(np.where(np.isfinite(part), part, 0.0) for part in (u, y, z))
    best = _measured(program, small, *point)
    for _ in range(POLISHES):
        point = polish(small.program, *point)
        best = _better(_measured(program, small, *point), best)
        if best.residuals.worst <= EXACT:
            break
    return best


def _better(first: Solution, second: Solution) -> Solution:
    return first if first.residuals.worst <= second.residuals.worst else second


def _measured(program: Program, small: Scaled, u: Vector, y: Vector, z: Vector) -> Solution:
    x = np.clip(small.point(u), program.lower, program.upper)
    y, z = small.multipliers(y, np.maximum(z, 0))
    w = program.bound_multipliers(x, y, z)
    return Solution(x, y, z, w, program.objective(x), residuals(program, x, y, z, w))


def _attempt(unit: Program, settings: Settings) -> tuple[Vector, Vector, Vector]:
    """Return ProxQP's last iterate (u, y, z) of a scaled program, from a cold start."""
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


def _refusal(proof: Infeasibility) -> InfeasibleError:
    multipliers = {"y": proof.y.tolist(), "z": proof.z.tolist()}
    return InfeasibleError(proof.reason, {"shortfall": proof.shortfall, **multipliers})
