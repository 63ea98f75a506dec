"""Solve a small convex program, certify the answer, and say infeasible only when it is shown."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from hitjoints.errors import InfeasibleError, SolverError
from hitjoints.programs import proxqp
from hitjoints.programs.active_answer import certified_minimum
from hitjoints.programs.active_set import polish, settle
from hitjoints.programs.infeasibility import (
    Infeasibility,
    phase_one,
    show_blocked,
    show_conflict,
)
from hitjoints.programs.problem import Program, Solution, residuals
from hitjoints.programs.scaling import Scaled, scaled

if TYPE_CHECKING:
    from collections.abc import Iterator

    from hitjoints.programs.back_end import BackEnd
    from hitjoints.programs.problem import Vector

BACK_END: BackEnd = proxqp
"""What gives approximate answers."""
CERTIFIED = 1e-8  # residuals, relative, at or below which an answer counts as solved
EXACT = 1e-12  # residuals at which no other attempt is made: round-off, a little amplified
POLISHES = 3  # active set steps: a wrong first guess is mended by the second, rarely the third


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
    quick = certified_minimum(program)
    if quick is not None:
        return quick
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


def show_infeasible(program: Program) -> Infeasibility | None:
    """Return a proof that a program is infeasible, or None if none was found.

    Tried in turn: an empty box, single rows over the box, all rows together (a phase-1 problem).
    """
    blocked = show_blocked(program)
    if blocked is not None or program.b.size + program.d.size == 0:
        return blocked
    small = scaled(program)
    for answer in answers(phase_one(small.program)):
        proof = show_conflict(program, *small.multipliers(answer.y, answer.z))
        if proof is not None or answer.residuals.worst <= CERTIFIED:
            return proof
    return None


def answers(program: Program) -> Iterator[Solution]:
    """Yield the polished answer of each attempt, good or bad: its residuals tell."""
    small = scaled(program)
    for point in BACK_END.attempts(small.program):
        yield _polished(program, small, *point)


def _polished(program: Program, small: Scaled, u: Vector, y: Vector, z: Vector) -> Solution:
    point = tuple(np.where(np.isfinite(part), part, 0.0) for part in (u, y, z))
    first, best = point, None
    for _ in range(POLISHES):
        settled = _measured(program, small, *settle(small.program, *point))
        if settled.residuals.worst <= EXACT:
            return settled
        point = polish(small.program, *point)
        polished = _measured(program, small, *point)
        best = polished if best is None else _better(polished, best)
        if best.residuals.worst <= EXACT:
            return best
    raw = _measured(program, small, *first)
    return raw if best is None else _better(best, raw)


def _better(first: Solution, second: Solution) -> Solution:
    return first if first.residuals.worst <= second.residuals.worst else second


def _measured(program: Program, small: Scaled, u: Vector, y: Vector, z: Vector) -> Solution:
    x = np.clip(small.point(u), program.lower, program.upper)
    y, z = small.multipliers(y, np.maximum(z, 0))
    w = program.bound_multipliers(x, y, z)
    return Solution(x, y, z, w, program.objective(x), residuals(program, x, y, z, w))


def _refusal(proof: Infeasibility) -> InfeasibleError:
    multipliers = {"y": proof.y.tolist(), "z": proof.z.tolist()}
    return InfeasibleError(proof.reason, {"shortfall": proof.shortfall, **multipliers})
