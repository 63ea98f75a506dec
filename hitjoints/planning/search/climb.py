"""Climb to local optima: a projected Newton method on the constraint manifold, many starts at once.

Why not an SQP with a QP per start and step: the problems have few free dimensions and one set of
constraints, so all starts can take every step together in array operations, and a hundred local
searches cost about what two would one by one. Each step moves in the tangent space of the active
constraints by Newton's method, with the eigenvalues of the reduced Hessian made negative (so that
it climbs away from saddles), and is pulled back onto the manifold by Gauss-Newton steps with the
bounds clamped exactly. A step that does not climb is retried shorter, along the projected gradient.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np

from hitjoints.planning.search.face import Face, find_face, shortest, tangents

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from hitjoints.types import Array

    Mask = NDArray[np.bool_]

ON_MANIFOLD = 1e-10
"""Largest residual (m) of an equality, and largest excess of an inequality, after pulling back."""

SNAP = 1e-2
"""Within this of a bound (rad), or of an inequality's limit, a climb against it goes onto it."""

LONGEST, SHORTEST = 0.5, 1e-8  # of a step, rad
STATIONARY = 1e-7  # projected gradient of the log objective, per rad
DIFFERENCE = 1e-6  # step of the Hessian's forward difference, rad


@dataclass(frozen=True)
class Values:
    """A problem at N points x.

    Attributes:
        value: (N,) to be maximised.
        gradient: (N, m).
        residual: (N, c) the equalities first, zero when met; then the inequalities, met when <= 0.
        slope: (N, c, m) their Jacobian.
    """

    value: Array
    gradient: Array
    residual: Array
    slope: Array

    def take(self, rows: NDArray[np.intp] | Mask) -> Values:
        """Return some of the points."""
        return Values(self.value[rows], self.gradient[rows], self.residual[rows], self.slope[rows])

    def put(self, rows: NDArray[np.intp], other: Values) -> None:
        """Overwrite some of the points with all of `other`."""
        for name in ("value", "gradient", "residual", "slope"):
            getattr(self, name)[rows] = getattr(other, name)


class Problem(Protocol):
    """Something to maximise under equalities, inequalities and bounds.

    Attributes:
        lower: (m,) lower bounds of x.
        upper: (m,) upper bounds; equal ones keep a variable fixed.
        equalities: how many of the residuals are equalities.
    """

    lower: Array
    upper: Array
    equalities: int

    def evaluate(self, x: Array) -> Values:
        """Evaluate at x (N, m)."""


def climb(problem: Problem, x: Array, steps: int) -> tuple[Array, Values]:
    """Return local optima reached from the starts.

    Args:
        problem: what to climb.
        x: (N, m) starts within the bounds; those off the manifold are pulled onto it first.
        steps: at most this many.

    Returns:
        x (N, m), within the bounds exactly, and the values there; see `feasible`.
    """
    x, now = pull_back(problem, x, steps=15)
    radius = np.full(len(x), LONGEST)
    refused = np.zeros(len(x), dtype=bool)
    alive = np.flatnonzero(feasible(problem, now))
    for _ in range(steps):
        here, at = now.take(alive), x[alive]
        near = np.minimum(SNAP, 0.1 * radius[alive])
        face = find_face(problem, at, here, near)
        rows = here.slope * face.active[:, :, None] * face.free[:, None, :]
        basis = tangents(rows, face.free)
        uphill = np.einsum("kmd,km->kd", basis, here.gradient)
        moving = lengths(uphill) > STATIONARY
        # Bounds and limits pressed against, but not quite met yet.
        short = face.active & (np.abs(here.residual) > ON_MANIFOLD)
        moving |= ((at != face.at).any(axis=1) | short.any(axis=1)) & ~refused[alive]
        moving &= radius[alive] > SHORTEST
        if not moving.any():
            break
        if not moving.all():
            alive, at, here, uphill = alive[moving], at[moving], here.take(moving), uphill[moving]
            face, basis, near = face.take(moving), basis[moving], near[moving]
        again = refused[alive]
        step, length = _step(problem, at, here, face, basis, uphill, again)
        # Newton's step may press against a bound that the gradient does not: without it, then.
        gap = np.where(step > 0, problem.upper, problem.lower) - at
        pressed = face.free & (np.abs(gap) < near[:, None]) & (step != 0)
        held = np.flatnonzero(pressed.any(axis=1))
        if held.size:
            part = face.take(held)
            part = Face(part.at, part.free & ~pressed[held], part.active, part.multipliers)
            rows = here.slope[held] * part.active[:, :, None] * part.free[:, None, :]
            basis = tangents(rows, part.free)
            uphill = np.einsum("kmd,km->kd", basis, here.gradient[held])
            step[held], length[held] = _step(
                problem, at[held], here.take(held), part, basis, uphill, again[held]
            )
        # A retry along the gradient takes the whole radius; Newton's step knows its own length.
        cut = radius[alive] / np.maximum(length, 1e-300)
        factor = np.where(again, cut, np.minimum(1.0, cut))
        factor = np.minimum(factor, _room(problem, at, step))
        tried, there = pull_back(problem, face.at + step * factor[:, None], face.free, face.active)
        better = feasible(problem, there) & (there.value > here.value)
        shorter = 0.25 * np.minimum(radius[alive], np.maximum(length * factor, SNAP * 0.1))
        radius[alive] = np.where(better, np.minimum(LONGEST, 2 * radius[alive]), shorter)
        refused[alive] = ~better
        x[alive[better]] = tried[better]
        now.put(alive[better], there.take(better))
    return x, now


def feasible(problem: Problem, values: Values) -> Mask:
    """Tell which points (N,) meet the equalities and inequalities."""
    off = values.residual.copy()
    off[:, : problem.equalities] = np.abs(off[:, : problem.equalities])
    ok = (off <= ON_MANIFOLD).all(axis=1) & np.isfinite(values.value)
    return np.asarray(ok & np.isfinite(values.gradient).all(axis=1))


def pull_back(
    problem: Problem,
    x: Array,
    free: Mask | None = None,
    active: Mask | None = None,
    steps: int = 5,
) -> tuple[Array, Values]:
    """Return the points pulled onto the constraints and into the bounds, and the values there.

    Args:
        problem: whose constraints.
        x: (N, m).
        free: (N, m) the variables that may move; all when not given.
        active: (N, c) the constraints to be met as equalities; others only when violated.
        steps: at most this many.
    """
    x = np.minimum(np.maximum(x, problem.lower), problem.upper)
    now = problem.evaluate(x)
    if not now.residual.shape[1]:
        return x, now
    held = np.zeros(now.residual.shape, dtype=bool) if active is None else active.copy()
    held[:, : problem.equalities] = True
    for _ in range(steps):
        met = (now.residual <= 0.1 * ON_MANIFOLD) & ~held
        off = np.where(met, 0.0, now.residual)
        todo = np.flatnonzero((np.abs(off) > 0.1 * ON_MANIFOLD).any(axis=1))
        if not todo.size:
            break
        slope = now.slope[todo] * ~met[todo, :, None]
        at = x[todo]
        usable = np.ones_like(at, dtype=bool) if free is None else free[todo]
        for _ in range(2):
            rows = slope * usable[:, None, :]
            move = -shortest(rows, off[todo])
            blocked = ((at <= problem.lower) & (move < 0)) | ((at >= problem.upper) & (move > 0))
            if not (blocked & usable).any():
                break
            usable = usable & ~blocked
        x[todo] = np.minimum(np.maximum(at + move, problem.lower), problem.upper)
        now.put(todo, problem.evaluate(x[todo]))
    return x, now


def lengths(vectors: Array) -> Array:
    """Return the lengths (N,) of vectors (N, d)."""
    return np.asarray(np.sqrt(np.einsum("kd,kd->k", vectors, vectors)))


def _room(problem: Problem, x: Array, step: Array) -> Array:
    """Return the share (N,) of a step after which its first variable meets a bound."""
    gap = np.where(step > 0, problem.upper, problem.lower) - x
    moved = np.abs(step) > 1e-14
    share = np.where(moved, gap / np.where(moved, step, 1.0), np.inf)
    return np.asarray(share.min(axis=1))


def _step(
    problem: Problem,
    x: Array,
    now: Values,
    face: Face,
    basis: Array,
    uphill: Array,
    again: Mask,
) -> tuple[Array, Array]:
    """Return steps (N, m) and their lengths: Newton's, or the gradient after a refusal."""
    newton = _newton(problem, x, now, face.multipliers, basis, uphill)
    step = np.where(again[:, None], uphill, newton)
    return np.einsum("kmd,kd->km", basis, step), lengths(step)


def _newton(
    problem: Problem, x: Array, now: Values, multipliers: Array, basis: Array, uphill: Array
) -> Array:
    """Return Newton steps (N, d) of the Lagrangian in the tangent space.

    Its Hessian is the forward difference of its exact gradient.
    """
    count, m, d = basis.shape
    at = x[:, None, :] + DIFFERENCE * basis.transpose(0, 2, 1)
    near = problem.evaluate(at.reshape(-1, m))
    sloped = np.einsum("kjcm,kc->kjm", near.slope.reshape(count, d, -1, m), multipliers)
    gradients = near.gradient.reshape(count, d, m) - sloped
    base = now.gradient - np.einsum("kcm,kc->km", now.slope, multipliers)
    hessian = (gradients - base[:, None, :]) @ basis / DIFFERENCE
    hessian = 0.5 * (hessian + hessian.transpose(0, 2, 1))
    hessian = np.where(np.isfinite(hessian), hessian, 0.0)
    curvature, vectors = np.linalg.eigh(hessian)
    along = np.einsum("kij,ki->kj", vectors, uphill)
    floor = 1e-6 + 1e-6 * np.abs(curvature).max(axis=1, keepdims=True)
    step = np.einsum("kij,kj->ki", vectors, along / np.maximum(np.abs(curvature), floor))
    return np.asarray(step)
