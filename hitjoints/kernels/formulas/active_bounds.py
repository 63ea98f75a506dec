"""A small strictly convex program with bounds: one step of the active set method, as formulas.

A guess that the next step would not change is right (M. Hintermueller, K. Ito, K. Kunisch, SIAM J.
Optim. 13(3), 2002). `bounded` does the same for the two programs of a control step, whose structure
it knows; here nothing is known of H but that it is definite.
"""

from __future__ import annotations

from typing import NamedTuple

from hitjoints.kernels.formulas.definite import solve_definite
from hitjoints.kernels.formulas.speeds import product
from hitjoints.kernels.tape.trace import Scalar, absolute, maximum, minimum, where_less

SINGULAR = 1e-9
"""Share of what a row's entry in the Schur complement is with all variables free, at least."""


class DenseProgram(NamedTuple):
    """Minimise 1/2 x^T H x + c^T x subject to A x = b and bounds, over abstract numbers."""

    H: list[list[Scalar]]
    c: list[Scalar]
    A: list[list[Scalar]]
    b: list[Scalar]
    lower: list[Scalar]
    upper: list[Scalar]


class DenseAnswer(NamedTuple):
    """What a guess of the active bounds gives.

    Attributes:
        sides: the next guess: -1 at the lower bound, 1 at the upper, 0 between.
        urgency: how clearly it differs from the guess, -1 where it does not: for an answer, all.
        x: the variables, within the bounds.
        y: multipliers of the rows.
    """

    sides: list[Scalar]
    urgency: list[Scalar]
    x: list[Scalar]
    y: list[Scalar]


def read_dense(given: tuple[Scalar, ...], n: int, m: int) -> tuple[DenseProgram, list[Scalar]]:
    """Return the program and the guess that numbers say: H, c, A, b, lower, upper, sides."""
    rest = list(given)

    def take(count: int) -> list[Scalar]:
        taken, rest[:] = rest[:count], rest[count:]
        return taken

    H = [take(n) for _ in range(n)]
    c, A = take(n), [take(n) for _ in range(m)]
    return DenseProgram(H, c, A, take(m), take(n), take(n)), take(n)


def follow_bounds(program: DenseProgram, sides: list[Scalar]) -> DenseAnswer:
    """Return what a guess of the active bounds gives.

    Args:
        program: n variables, m rows.
        sides: (n) the guess.
    """
    H, c, A, b, lower, upper = program
    n, m = len(c), len(b)
    free = [where_less(absolute(side), 0.5, 1.0, 0.0) for side in sides]
    held = [
        (1.0 - f) * where_less(0.0, side, high, low)
        for f, side, low, high in zip(free, sides, lower, upper, strict=True)
    ]
    # A held variable keeps a row of its own in the system: x_i = its bound.
    system: list[list[Scalar]] = [
        [free[i] * free[j] * H[i][j] for j in range(i)] + [free[i] * H[i][i] + (1.0 - free[i])]
        for i in range(n)
    ]
    right = [f * -(c[i] + product(H[i], held)) + held[i] for i, f in enumerate(free)]
    x0 = solve_definite(system, right)
    masked = [[f * entry for f, entry in zip(free, row, strict=True)] for row in A]
    moved = [solve_definite(system, row) for row in masked]
    y: list[Scalar] = []
    if m:
        short = [product(row, x0) - value for row, value in zip(A, b, strict=True)]
        schur: list[list[Scalar]] = [
            [product(masked[i], moved[j]) for j in range(i + 1)] for i in range(m)
        ]
        # With fewer free variables than rows the multipliers grow until they free some.
        floor = [
            SINGULAR * product(row, [entry / H[j][j] for j, entry in enumerate(row)]) for row in A
        ]
        y = solve_definite(schur, short, floor)
    best = list(x0)
    for factor, column in zip(y, moved, strict=True):
        best = [value - factor * entry for value, entry in zip(best, column, strict=True)]
    push = _push(program, best, y)
    following: list[Scalar] = []
    urgency: list[Scalar] = []
    for i, old in enumerate(sides):
        above = push[i] - H[i][i] * (upper[i] - best[i])
        below = H[i][i] * (lower[i] - best[i]) - push[i]
        new = where_less(0.0, above, 1.0, where_less(0.0, below, -1.0, 0.0))
        # Of a variable that is freed, how clearly its bound lets it go.
        left = where_less(0.0, old, -above, -below)
        clear = where_less(0.0, above, above, where_less(0.0, below, below, left))
        following.append(new)
        urgency.append(where_less(0.5, absolute(new - old), clear, -1.0))
    x = [
        minimum(maximum(value, low), high)
        for value, low, high in zip(best, lower, upper, strict=True)
    ]
    return DenseAnswer(following, urgency, x, y)


def _push(program: DenseProgram, x: list[Scalar], y: list[Scalar]) -> list[Scalar]:
    """Return -(H x + c + A^T y)."""
    H, c, A = program[:3]
    push: list[Scalar] = []
    for i, row in enumerate(H):
        total = product(row, x) + c[i]
        for factor, entries in zip(y, A, strict=True):
            total = total + factor * entries[i]
        push.append(-total)
    return push
