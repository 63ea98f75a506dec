"""A convex quadratic or linear program, its solution, and the residuals that certify one."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Vector = NDArray[np.float64]
    Matrix = NDArray[np.float64]


@dataclass(frozen=True)
class Program:
    """Minimise 1/2 x^T H x + c^T x subject to A x = b, C x <= d, lower <= x <= upper.

    Attributes:
        c: (n,).
        lower, upper: (n,), finite.
        H: (n, n) positive semidefinite, or None for a linear program.
        A, b: (m, n), (m,); C, d: (p, n), (p,); empty when there are no such rows.
    """

    c: Vector
    lower: Vector
    upper: Vector
    H: Matrix | None = None
    A: Matrix = field(default_factory=lambda: np.empty((0, 0)))
    b: Vector = field(default_factory=lambda: np.empty(0))
    C: Matrix = field(default_factory=lambda: np.empty((0, 0)))
    d: Vector = field(default_factory=lambda: np.empty(0))

    @property
    def n(self) -> int:
        """Number of variables."""
        return self.c.size

    def objective(self, x: Vector) -> float:
        """Return the value minimised."""
        quadratic = 0.0 if self.H is None else 0.5 * float(x @ self.H @ x)
        return quadratic + float(self.c @ x)


@dataclass(frozen=True)
class Residuals:
    """How far a primal-dual pair is from optimal, each relative to the size of its own terms.

    Attributes:
        primal: largest violation of a row (the bounds hold exactly).
        dual: largest entry of H x + c + A^T y + C^T z + w.
        gap: primal minus dual objective.
    """

    primal: float
    dual: float
    gap: float

    @property
    def worst(self) -> float:
        """The largest of the three."""
        return max(self.primal, self.dual, self.gap)


@dataclass(frozen=True)
class Solution:
    """A certified minimiser.

    Attributes:
        x: (n,), within the bounds to the last bit.
        y, z, w: multipliers of the equalities, the inequalities (>= 0) and the bounds (its sign
            tells which).
        residuals: computed here from the data and this answer, whatever the solver says.
    """

    x: Vector
    y: Vector
    z: Vector
    w: Vector
    objective: float
    residuals: Residuals


def residuals(program: Program, x: Vector, y: Vector, z: Vector) -> tuple[Residuals, Vector]:
    """Return the residuals of (x, y, z) and the bounds' multipliers w they imply.

    The multipliers of the bounds are what stationarity leaves over, so the dual residual is the
    part of them that no bound can carry: here none, because every variable has both bounds. What
    is left to check is feasibility of the rows and the duality gap, in which a wrong multiplier
    shows as a bound paid for that is not touched.
    """
    p = program
    Hx = np.zeros(p.n) if p.H is None else p.H @ x
    terms = [Hx, p.c]
    primal = 0.0
    if p.b.size:
        terms.append(p.A.T @ y)
        primal = max(primal, _row_error(p.A, x, p.b, np.abs(p.A @ x - p.b)))
    dual = 0.0
    if p.d.size:
        terms.append(p.C.T @ z)
        primal = max(primal, _row_error(p.C, x, p.d, p.C @ x - p.d))
        dual = float(np.maximum(-z, 0).max()) / (1 + float(np.abs(z).max()))
    w = -np.sum(terms, axis=0)
    # Lagrangian bound: c x + 1/2 x H x >= -1/2 x H x - b y - d z - max over the box of w x.
    box = np.where(w > 0, p.upper, p.lower) @ w
    quadratic = float(x @ Hx)
    linear = float(p.c @ x)
    by, dz = float(p.b @ y), float(p.d @ z)
    gap = abs(quadratic + linear + by + dz + float(box))
    scale = 1 + max(abs(quadratic), abs(linear), abs(by), abs(dz), abs(float(box)))
    return Residuals(primal, dual, gap / scale), w


def _row_error(rows: Matrix, x: Vector, right: Vector, violation: Vector) -> float:
    """Return the largest violation relative to the terms that make up its row."""
    scale = np.maximum(np.abs(rows) @ np.abs(x), np.abs(right))
    scale = np.maximum(scale, np.abs(rows).max(axis=1))
    return float((violation / np.where(scale > 0, scale, 1.0)).max(initial=0.0))
