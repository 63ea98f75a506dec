"""A convex quadratic or linear program, its solution, and the residuals that certify one."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from hitjoints.errors import InputError
from hitjoints.vectors import all_finite, real

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Vector = NDArray[np.float64]
    Matrix = NDArray[np.float64]

# A row whose terms are all below this share of the largest row's (or of 1, in SI units) is
# round-off of the products it came from, such as B^T J of a singular Jacobian: about 50 eps.
ROUNDOFF = 1e-14
# Eigenvalues of J^T J + rho I come out this negative, relative to the largest, by round-off.
CONVEX = 1e-10


@dataclass(frozen=True, eq=False)
class Program:
    """Minimise 1/2 x^T H x + c^T x subject to A x = b, C x <= d, lower <= x <= upper.

    Attributes:
        c: (n,).
        lower: (n,), finite. Equal bounds fix a variable; crossed ones are accepted here and found
            infeasible by the solver.
        upper: (n,), finite. Equal bounds fix a variable; crossed ones are accepted here and found
            infeasible by the solver.
        H: (n, n) symmetric positive semidefinite, or None for a linear program.
        A: (m, n), (m,);
        b: (m, n), (m,);
        C: (p, n), (p,); empty when there are no such rows.
        d: (p, n), (p,); empty when there are no such rows.

    Raises:
        InputError: shapes that do not fit, a number that is not finite, H not convex.
    """

    c: Vector
    lower: Vector
    upper: Vector
    H: Matrix | None = None
    A: Matrix = field(default_factory=lambda: np.empty((0, 0)))
    b: Vector = field(default_factory=lambda: np.empty(0))
    C: Matrix = field(default_factory=lambda: np.empty((0, 0)))
    d: Vector = field(default_factory=lambda: np.empty(0))

    def __post_init__(self) -> None:
        c, b, d = (real(getattr(self, name), name, "numbers").reshape(-1) for name in "cbd")
        n = c.size
        shapes: dict[str, tuple[int, ...]] = {
            "c": (n,),
            "lower": (n,),
            "upper": (n,),
            "b": (b.size,),
            "d": (d.size,),
        }
        shapes |= {"A": (b.size, n), "C": (d.size, n)}
        if self.H is not None:
            shapes["H"] = (n, n)
        for name, shape in shapes.items():
            value = real(getattr(self, name), name, "numbers")
            if value.size == 0 and 0 in shape:
                value = value.reshape(shape)
            if value.shape != shape:
                raise InputError(name, f"shape {value.shape}", f"shape {shape} is needed")
            if not all_finite(value):
                raise InputError(name, value.tolist(), "every number must be finite")
            object.__setattr__(self, name, value)
        if self.H is not None:
            size = float(np.abs(self.H).max(initial=0.0))
            if np.abs(self.H - self.H.T).max(initial=0.0) > CONVEX * size:
                raise InputError("H", self.H.tolist(), "must be symmetric")
            if not _convex(self.H, CONVEX * size):
                raise InputError("H", self.H.tolist(), "must be positive semidefinite")

    @property
    def n(self) -> int:
        """Number of variables."""
        return self.c.size

    @cached_property
    def reach(self) -> Vector:
        """(n,) the largest magnitude each variable can take."""
        return np.maximum(np.abs(self.lower), np.abs(self.upper))

    def objective(self, x: Vector) -> float:
        """Return the value minimised."""
        return 0.5 * float(x @ self.curvature(x)) + float(self.c @ x)

    def curvature(self, x: Vector) -> Vector:
        """Return H x, (n,)."""
        return np.zeros(self.n) if self.H is None else np.asarray(self.H @ x)

    def bound_multipliers(self, x: Vector, y: Vector, z: Vector) -> Vector:
        """Return the multipliers of the bounds that stationarity asks for, (n,).

        Every variable has both bounds, so any value can be carried: > 0 by the upper, < 0 by the
        lower one. One carried by a bound that x does not touch shows in the gap.
        """
        return -np.asarray(self.curvature(x) + self.c + self.A.T @ y + self.C.T @ z)

    @cached_property
    def row_sizes(self) -> tuple[Vector, Vector, float]:
        """The size of each row's terms over the box, (m,) and (p,), and their round-off."""
        equalities = np.abs(self.A) @ self.reach + np.abs(self.b)
        inequalities = np.abs(self.C) @ self.reach + np.abs(self.d)
        largest = max(1.0, equalities.max(initial=0.0), inequalities.max(initial=0.0))
        return equalities, inequalities, ROUNDOFF * float(largest)


def _convex(H: Matrix, slack: float) -> bool:
    """Tell whether no eigenvalue is below -slack: a Cholesky factor is proof, and found faster."""
    try:
        np.linalg.cholesky(H)
    except np.linalg.LinAlgError:
        return bool(np.linalg.eigvalsh(H).min(initial=0.0) >= -slack)
    return True


@dataclass(frozen=True)
class Residuals:
    """How far a primal-dual pair is from optimal, each part relative to the size of its terms.

    Attributes:
        primal: largest violation of a row or bound.
        dual: largest entry of H x + c + A^T y + C^T z + w, or an inequality's multiplier of the
            wrong sign.
        gap: primal minus dual objective, relative to what the cost can amount to in the box.
    """

    primal: float
    dual: float
    gap: float

    @property
    def worst(self) -> float:
        """The largest of the three."""
        return max(self.primal, self.dual, self.gap)


@dataclass(frozen=True, eq=False)
class Solution:
    """A certified minimiser.

    Attributes:
        x: (n,), within the bounds to the last bit.
        y: (m,), (p,) multipliers of the equalities and of the inequalities (>= 0).
        z: (m,), (p,) multipliers of the equalities and of the inequalities (>= 0).
        w: (n,) multipliers of the bounds: > 0 for the upper, < 0 for the lower.
        objective: the value reached at x.
        residuals: computed from the data and this answer, whatever the solver says.
    """

    x: Vector
    y: Vector
    z: Vector
    w: Vector
    objective: float
    residuals: Residuals


def residuals(program: Program, x: Vector, y: Vector, z: Vector, w: Vector) -> Residuals:
    """Return how far x (n,) with the multipliers y (m,), z (p,), w (n,) is from optimal."""
    return Residuals(
        primal_residual(program, x),
        dual_residual(program, x, y, z, w),
        duality_gap(program, x, y, z, w),
    )


def primal_residual(program: Program, x: Vector) -> float:
    """Return the largest violation of a row or a bound by x (n,), relative to its terms."""
    p = program
    equal, unequal, roundoff = p.row_sizes
    violations = np.concatenate([np.abs(p.A @ x - p.b), p.C @ x - p.d]) - roundoff
    outside = np.maximum(p.lower - x, x - p.upper)
    relative = _relative(violations, np.concatenate([equal, unequal]))
    return max(relative, _relative(outside, p.reach))


def dual_residual(program: Program, x: Vector, y: Vector, z: Vector, w: Vector) -> float:
    """Return the largest error of stationarity or of the multipliers' signs, relative."""
    p = program
    curved = 0.0 if p.H is None else np.abs(p.H) @ p.reach
    sizes = np.abs(p.c) + curved + np.abs(p.A.T) @ np.abs(y) + np.abs(p.C.T) @ np.abs(z)
    stationarity = _relative(np.abs(w - p.bound_multipliers(x, y, z)), sizes)
    largest = np.full(z.size, np.abs(z).max(initial=0.0))
    return max(stationarity, _relative(-z, largest))


def duality_gap(program: Program, x: Vector, y: Vector, z: Vector, w: Vector) -> float:
    """Return |primal - dual objective|, relative to the sum of the cost's terms over the box.

    The dual objective is -1/2 x^T H x - b^T y - d^T z - max over the box of w^T x.
    """
    p = program
    paid = np.maximum(w * p.lower, w * p.upper).sum()
    gap = abs(float(x @ p.curvature(x) + p.c @ x + p.b @ y + p.d @ z + paid))
    curved = 0.0 if p.H is None else float(p.reach @ np.abs(p.H) @ p.reach)
    size = float(np.abs(p.c) @ p.reach) + curved
    return gap / size if size > 0 else gap


def _relative(errors: Vector, sizes: Vector) -> float:
    if not errors.size:
        return 0.0
    return float((errors / np.where(sizes > 0, sizes, 1.0)).max(initial=0.0))
