"""The same program over the unit box, with rows and cost of size one: what the solver gets.

ProxQP's tolerances are absolute, so they mean something only when every quantity is of order one.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from hitjoints.programs.problem import Program

if TYPE_CHECKING:
    from hitjoints.programs.problem import Matrix, Vector

# A row that varies over the box by less than this share of its terms is not stretched further:
# the cancellation in b - A x would grow with it, from 1e-16 to beyond the certified 1e-8.
STRETCH = 1e-6
# Equalities of size one that depend on each other to this are one equality: demanding both takes
# multipliers of 1e9, whose round-off (1e-7) no answer could be certified through, while dropping
# one leaves a violation of a tenth of what is certified.
DEPENDENT = 1e-9


@dataclass(frozen=True, eq=False)
class Scaled:
    """A program with variables u in [-1, 1]^n, x = middle + half * u, and orthonormal equalities.

    A variable without room (half = 0) has a column of zeros. The equalities are combined into
    orthonormal ones, so that nearly parallel rows do not spoil the conditioning; an equality that
    depends on the others, or is round-off, leaves a row of zeros with what it misses on the right.

    Attributes:
        program: the scaled program.
        middle: (n,) centre and half width of the box.
        half: (n,) centre and half width of the box.
        turn: (m, m) the weights of the original equalities in each of the new ones.
        bounds: (p,) what the rows of C were divided by; inf for round-off.
        cost: what the objective was divided by.
    """

    program: Program
    middle: Vector
    half: Vector
    turn: Matrix
    bounds: Vector
    cost: float

    def point(self, u: Vector) -> Vector:
        """Return x for u, within the bounds up to round-off."""
        return np.asarray(self.middle + self.half * u)

    def multipliers(self, y: Vector, z: Vector) -> tuple[Vector, Vector]:
        """Return the multipliers of the original rows for those of the scaled ones."""
        return self.cost * (self.turn @ y), self.cost * z / self.bounds


def scaled(program: Program) -> Scaled:
    """Scale a program whose box is not empty."""
    p = program
    middle, half = p.lower + 0.5 * (p.upper - p.lower), 0.5 * (p.upper - p.lower)
    equal, unequal, roundoff = p.row_sizes
    A, b, rows = _rows(p.A * half, p.b - p.A @ middle, equal, roundoff)
    C, d, bounds = _rows(p.C * half, p.d - p.C @ middle, unequal, roundoff)
    c, H = (p.c + p.curvature(middle)) * half, None
    cost = float(np.abs(c).max(initial=0.0))
    if p.H is not None:
        H = p.H * np.outer(half, half)
        cost = max(cost, float(np.abs(H).max(initial=0.0)))
    cost = cost if cost > 0 else 1.0
    one = np.ones(p.n)
    A, b, turn = _orthonormal(A, b)
    unit = Program(c / cost, -one, one, None if H is None else H / cost, A, b, C, d)
    return Scaled(unit, middle, half, turn / rows[:, None], bounds, cost)


def _rows(
    matrix: Matrix, right: Vector, sizes: Vector, roundoff: float
) -> tuple[Matrix, Vector, Vector]:
    scale = np.maximum(np.linalg.norm(matrix, axis=1), STRETCH * sizes)
    scale[sizes <= roundoff] = np.inf
    return matrix / scale[:, None], right / scale, scale


def _orthonormal(A: Matrix, b: Vector) -> tuple[Matrix, Vector, Matrix]:
    """Return orthonormal rows with the same solutions, and how they are made of the given ones."""
    if b.size == 0:
        return A, b, np.zeros((0, 0))
    U, s, Vt = np.linalg.svd(A)
    rank = int((s > DEPENDENT).sum())
    turn = U.copy()
    turn[:, :rank] /= s[:rank]
    rows = np.zeros_like(A)
    rows[:rank] = Vt[:rank]
    return rows, b @ turn, turn
