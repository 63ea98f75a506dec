"""Strictly convex programs with bounds and a few rows, answered without a solver and certified."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from hitjoints.kernels.formulas.active_bounds import follow_bounds, read_dense
from hitjoints.kernels.tape.counted import CountedProgram
from hitjoints.programs.problem import Program, Solution, residuals

if TYPE_CHECKING:
    from hitjoints.kernels.tape.trace import Scalar

MOST, MOST_ROWS = 8, 3
"""Variables and rows: the formulas of larger programs take long to compile."""
GUESSES, TOGETHER = 24, 4
"""Active sets tried, from none on; most programs need three. After the second number only one
variable changes at a time."""
CERTIFIED = 1e-12
"""Residuals up to which an answer needs no other: round-off, a little amplified."""
WORTH_COMPILING = 300
"""Guesses after which the formulas of a size are compiled."""


def certified_minimum(program: Program) -> Solution | None:
    """Return the minimiser of a program; None if none is certified."""
    p = program
    n, m = p.n, p.b.size
    if p.H is None or p.d.size or n > MOST or m > MOST_ROWS:
        return None
    run, sides = _formulas(n, m), [0.0] * n
    for guess in range(GUESSES):
        found = run(p.H, p.c, p.A, p.b, p.lower, p.upper, np.array(sides))
        if not found:
            return None
        following, urgency = found[:n], found[n : 2 * n]
        if max(urgency) < 0.0:
            break
        if guess < TOGETHER:
            sides = following
        else:  # all at once may go round in circles
            only = urgency.index(max(urgency))
            sides[only] = 0.0 if sides[only] else following[only]
    if not max(urgency) < 0.0:
        return None
    x, y, z = np.array(found[2 * n : 3 * n]), np.array(found[3 * n :]), np.empty(0)
    w = p.bound_multipliers(x, y, z)
    own = residuals(p, x, y, z, w)
    return Solution(x, y, z, w, p.objective(x), own) if own.worst <= CERTIFIED else None


@cache
def _formulas(n: int, m: int) -> CountedProgram:
    def answer(given: tuple[Scalar, ...]) -> list[Scalar]:
        found = follow_bounds(*read_dense(given, n, m))
        return [*found.sides, *found.urgency, *found.x, *found.y]

    return CountedProgram(answer, n * n + 4 * n + m * (n + 1), WORTH_COMPILING)
