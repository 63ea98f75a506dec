"""Joint velocities for one control step: for a desired flux (Eq. 12), and along the field (Eq. 7).

Both programs are strictly convex. `build_*` returns them to look at, `solve_*` solves them from
scratch with certificates; a controller solves the same terms with `programs.warm`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from hitjoints.errors import InputError
from hitjoints.impact.flux import flux as flux_at
from hitjoints.impact.flux import speed_for
from hitjoints.programs.problem import Program, Residuals
from hitjoints.programs.solver import solve
from hitjoints.programs.warm import ROWS
from hitjoints.vectors import points, real, unit

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from hitjoints.programs.problem import Matrix, Vector

RHO = 1e-4
"""Weight of the joint motion in Eq. 12, (m/s)^2 per (rad/s)^2; it makes the minimiser unique."""
FLOOR = 0.1
"""Least weight of a joint, relative to the largest, when the inertia's gradient weighs them."""
WITHIN_REACH = 1.0 - 1e-6
"""Share of the largest reachable speed asked for when the desired one is out of reach."""
PROGRESS = 1e3
"""Reward for the part of the flux that is within reach, (m/s)^2."""
CUTOFF = 1e-6
"""m/rad, singular values below which J^+ treats a motion as impossible."""
SLOPE = 1e-9
"""Largest derivative of the cost of Eq. 12 that its closed form may leave, (m/s)^2 per rad/s."""
REGULAR = 1e-8
"""det / trace^3 above which a matrix is far enough from singular for Cramer's rule."""


class Terms(NamedTuple):
    """Minimise 1/2 x^T H x + c^T x subject to A x = b, within bounds kept elsewhere."""

    H: Matrix
    c: Vector
    A: Matrix
    b: Vector


@dataclass(frozen=True, eq=False)
class JointVelocity:
    """The answer of Eq. 12.

    Attributes:
        qd: (n,) rad/s, within the limits to the last bit.
        flux: m/s, produced by qd: the desired one, or the greatest within reach.
        saturated: the desired flux was out of reach.
        residuals: how well the answer is certified.
    """

    qd: Vector
    flux: float
    saturated: bool
    residuals: Residuals


def reachable_speed(pull: Vector, lower: Vector, upper: Vector) -> float:
    """Return max pull . qd within the bounds (Eq. 9 in closed form), m/s, for checked arguments."""
    return float(pull @ np.where(pull > 0.0, upper, lower))


def least_norm(J: Matrix, velocity: Vector) -> Vector:
    """Return J^+ v (n,): of the joint velocities that come nearest to v (3,), the smallest."""
    squared = J @ J.T
    solved = _solve_three(squared, velocity)
    if solved is not None:
        return np.asarray(solved @ J)
    squares, axes = np.linalg.eigh(squared)
    inverse = np.where(squares > CUTOFF**2, 1.0 / np.maximum(squares, CUTOFF**2), 0.0)
    return np.asarray((axes @ (inverse * (velocity @ axes))) @ J)


def is_regular(S: Matrix) -> bool:
    """Tell whether a symmetric matrix (3, 3) is far enough from singular for Cramer's rule."""
    (a, b, c), (_, d, e), (_, _, f) = S.tolist()
    det = a * (d * f - e * e) + b * (c * e - b * f) + c * (b * e - c * d)
    return bool(det > REGULAR * (a + d + f) ** 3)


def _solve_three(S: Matrix, v: Vector) -> Vector | None:
    """Return S^-1 v (3,) for a symmetric positive definite S; None if it is nearly singular.

    By Cramer's rule: a general solver takes several times as long for three unknowns.
    """
    (a, b, c), (_, d, e), (_, _, f) = S.tolist()
    A, B, C = d * f - e * e, c * e - b * f, b * e - c * d
    det = a * A + b * B + c * C
    if not det > REGULAR * (a + d + f) ** 3:
        return None
    x, y, z = v.tolist()
    D, E, F = a * f - c * c, b * c - a * e, a * d - b * b
    sides = (A * x + B * y + C * z, B * x + D * y + E * z, C * x + E * y + F * z)
    return np.asarray(np.array(sides) / det)


def gradient_weights(gradient: Vector) -> Vector:
    """Return W = diag(|grad lambda| / max |grad lambda|) + floor, its diagonal (n,)."""
    size = np.abs(gradient)
    largest = float(size.max(initial=0.0))
    return size / largest + FLOOR if largest > 0 else np.ones_like(size)


def flux_terms(
    J: Matrix, f: Vector, pull: Vector, speed: float, weights: Vector, rho: float
) -> Terms:
    """Return |J qd - f|^2 + rho |qd - J^+ f|_W^2 under h^T J qd = speed (Eq. 12), halved."""
    small = rho * weights
    H = J.T @ J
    H.flat[:: H.shape[0] + 1] += small
    return Terms(H, -(f @ J + small * least_norm(J, f)), pull[None, :], np.array([speed]))


def unbounded_flux(
    J: Matrix, f: Vector, h: Vector, speed: float, weights: Vector, rho: float
) -> Vector | None:
    """Return the minimiser (n,) of Eq. 12 where no limit is in the way, in closed form.

    It is J^+ f + z, where z makes up for what the field lacks along h at the least cost,
    |J z|^2 + rho |z|_W^2: with D = rho W a multiple of
    (J^T J + D)^-1 J^T h = D^-1 J^T (I + J D^-1 J^T)^-1 h.

    Returns:
        None if its residuals, computed from the data, do not certify it, as near a singularity.
    """
    nearest, D, pull = least_norm(J, f), rho * weights, h @ J
    easy = J / D
    solved = _solve_three(np.eye(3) + easy @ J.T, h)
    if solved is None:
        return None
    faster = solved @ easy
    gain = float(pull @ faster)
    if not gain > 0.0:
        return None
    share = (speed - float(pull @ nearest)) / gain
    z = share * faster
    qd = nearest + z
    slope = (J @ qd - f) @ J + D * z - share * pull
    miss = abs(float(pull @ qd) - speed)
    return qd if miss <= ROWS and float(slope @ slope) <= SLOPE**2 else None


def most_flux_terms(
    J: Matrix, f: Vector, pull: Vector, speed: float, weights: Vector, rho: float
) -> Terms:
    """Return Eq. 12 with a flux row that asks for as much of the speed as other rows leave.

    The row is h^T J qd = t speed, and -PROGRESS t + t^2 / 2 is added to the cost; variables
    (qd, t), with t <= 1. Whatever part is within reach is reached: PROGRESS exceeds what the
    other terms gain, (m/s)^2, by missing it.
    """
    n = weights.size
    terms = flux_terms(J, f, pull, 0.0, weights, rho)
    H = np.zeros((n + 1, n + 1))
    H[:n, :n], H[n, n] = terms.H, 1.0
    A = np.append(terms.A, [[-speed]], axis=1)
    return Terms(H, np.append(terms.c, -PROGRESS), A, terms.b)


def build_joint_velocity(  # noqa: PLR0913
    jacobian: ArrayLike,
    velocity: ArrayLike,
    direction: ArrayLike,
    inertia: float,
    mass: float,
    flux: float,
    lower: ArrayLike,
    upper: ArrayLike,
    weights: ArrayLike | None = None,
    rho: float = RHO,
) -> Program:
    """Return the program of Eq. 12: the joint velocity nearest to the field that has the flux.

    A flux beyond reach is replaced by the greatest within the limits.

    Args:
        jacobian: (3, n) m/rad.
        velocity: (3,) m/s, f of the field.
        direction: (3,), of any length but zero.
        inertia: kg, now; the flux is linear in qd because it is not that of the next step.
        mass: kg, of the object.
        flux: m/s, > 0.
        lower: (n,) rad/s, from `programs.speed.step_bounds`.
        upper: (n,) rad/s, from `programs.speed.step_bounds`.
        weights: (n,) the diagonal of W, > 0; ones when not given. See `gradient_weights`.
        rho: weight of the joint motion, > 0.

    Raises:
        InputError: wrong shapes, a number that is not finite or out of its range.
    """
    return _flux_program(
        jacobian, velocity, direction, inertia, mass, flux, lower, upper, weights, rho
    )[0]


def solve_joint_velocity(  # noqa: PLR0913
    jacobian: ArrayLike,
    velocity: ArrayLike,
    direction: ArrayLike,
    inertia: float,
    mass: float,
    flux: float,
    lower: ArrayLike,
    upper: ArrayLike,
    weights: ArrayLike | None = None,
    rho: float = RHO,
) -> JointVelocity:
    """Solve Eq. 12; arguments as `build_joint_velocity`.

    Raises:
        InputError: wrong shapes, a number that is not finite or out of its range.
        InfeasibleError: no velocity within the limits meets the flux row.
        SolverError: the answer could not be certified.
    """
    program, saturated = _flux_program(
        jacobian, velocity, direction, inertia, mass, flux, lower, upper, weights, rho
    )
    found = solve(program)
    reached = flux_at(1.0 / inertia, mass, float(program.A[0] @ found.x))
    return JointVelocity(found.x, reached, saturated, found.residuals)


def _flux_program(  # noqa: PLR0913
    jacobian: ArrayLike,
    velocity: ArrayLike,
    direction: ArrayLike,
    inertia: float,
    mass: float,
    flux: float,
    lower: ArrayLike,
    upper: ArrayLike,
    weights: ArrayLike | None,
    rho: float,
) -> tuple[Program, bool]:
    J = real(jacobian, "jacobian", "three rows of finite numbers")
    if J.ndim != 2 or J.shape[0] != 3 or not np.isfinite(J).all():
        raise InputError("jacobian", f"shape {J.shape}", "three rows of finite numbers")
    n = J.shape[1]
    f, h = points(velocity, "velocity"), unit(direction)
    each = f"{n} numbers, one per joint"
    low, high = real(lower, "lower", each), real(upper, "upper", each)
    W = np.ones(n) if weights is None else real(weights, "weights", each)
    for name, array, shape in (
        ("velocity", f, (3,)),
        ("direction", h, (3,)),
        ("lower", low, (n,)),
        ("upper", high, (n,)),
        ("weights", W, (n,)),
    ):
        if array.shape != shape:
            raise InputError(name, f"shape {array.shape}", f"shape {shape} is needed")
    positive = {"inertia": inertia, "mass": mass, "flux": flux, "rho": rho, "weights": W.min()}
    for name, value in positive.items():
        if not (math.isfinite(value) and value > 0):
            raise InputError(name, value, "a finite number above zero")
    pull = h @ J
    wanted, reach = speed_for(1.0 / inertia, mass, flux), reachable_speed(pull, low, high)
    saturated = wanted > reach
    terms = flux_terms(J, f, pull, WITHIN_REACH * reach if saturated else wanted, W, rho)
    return Program(terms.c, low, high, H=terms.H, A=terms.A, b=terms.b), saturated
