"""Which bounds and constraints press against a climb, and the directions they leave free.

Rows of points are treated at once: A is (N, c, m), one row per constraint, zero where inactive.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from hitjoints.planning.search.climb import Problem, Values
    from hitjoints.types import Array

    Mask = NDArray[np.bool_]

PASSES = 8  # to settle which bounds and constraints press


@dataclass(frozen=True)
class Face:
    """What presses against a climb.

    Attributes:
        at: (N, m) the points, moved onto the bounds they press against.
        free: (N, m) the variables no bound stops.
        active: (N, c) the constraints that do.
        multipliers: (N, c).
    """

    at: Array
    free: Mask
    active: Mask
    multipliers: Array

    def take(self, rows: Any) -> Face:
        """Return some of the points."""
        return Face(self.at[rows], self.free[rows], self.active[rows], self.multipliers[rows])


def find_face(problem: Problem, x: Array, now: Values, near: Array) -> Face:
    """Find the bounds and constraints within `near` (N,) that the climb presses against.

    Without the tolerance a climb would creep along a bound a hair's breadth away from it.
    """
    low, high = x <= problem.lower + near[:, None], x >= problem.upper - near[:, None]
    locked = problem.upper <= problem.lower
    touching = now.residual >= -near[:, None]
    touching[:, : problem.equalities] = True
    free, active = ~(low | high), touching.copy()
    each = np.arange(len(x))
    for turn in range(PASSES):
        rows = now.slope * active[:, :, None] * free[:, None, :]
        multipliers = multipliers_of(rows, now.gradient * free)
        pressing = now.gradient - np.einsum("kcm,kc->km", now.slope, multipliers)
        rate = np.einsum("kcm,km->kc", now.slope, pressing * free)
        stopped = (low & (pressing <= 0)) | (high & (pressing >= 0)) | locked
        pushed = touching & np.where(active, multipliers >= 0, rate > 0)
        pushed[:, : problem.equalities] = True
        flips = np.concatenate((stopped == free, pushed != active), axis=1)
        if not flips.any():
            break
        if turn > 1:
            # All at once may flip back and forth; the worst alone does not.
            size = np.abs(np.concatenate((pressing, np.where(active, multipliers, rate)), axis=1))
            worst = np.argmax(np.where(flips, size, -1.0), axis=1)
            only = np.zeros_like(flips)
            only[each, worst] = flips[each, worst]
            flips = only
        free = free ^ flips[:, : x.shape[1]]
        active = active ^ flips[:, x.shape[1] :]
    at = np.where(low & ~free, problem.lower, np.where(high & ~free, problem.upper, x))
    return Face(at, free, active, multipliers)


def tangents(rows: Array, free: Mask) -> Array:
    """Return orthonormal bases (N, m, d) of what the rows (N, c, m) and bounds leave free.

    A point with less freedom than others has columns of zeros.
    """
    m = free.shape[1]
    projector = np.eye(m) * free[:, None, :]
    projector -= rows.transpose(0, 2, 1) @ np.linalg.solve(gram(rows), rows)
    # The trace of a projector is its rank, and as many random vectors, projected, span its range:
    # their QR decomposition takes a third of the time that its eigenvectors do.
    freedom = np.rint(np.trace(projector, axis1=1, axis2=2)).astype(int)
    count = max(1, int(freedom.max(initial=1)))
    basis = np.linalg.qr(projector @ _mixed(m)[:, :count])[0]
    return np.asarray(basis * (np.arange(count) < freedom[:, None])[:, None, :])


@cache
def _mixed(m: int) -> Array:
    """Random vectors (m, m), always the same."""
    return np.random.default_rng(m).standard_normal((m, m))


def gram(rows: Array) -> Array:
    """Return A A^T, regular: an inactive row counts as 1, dependent rows are damped."""
    square = np.ascontiguousarray(rows @ rows.transpose(0, 2, 1))
    count, c, _ = square.shape
    diagonal = square.reshape(count, c * c)[:, :: c + 1]
    scale = diagonal.max(axis=1, initial=0.0, keepdims=True)
    diagonal += np.where(diagonal > 0, 1e-13 * scale, 1.0)
    return square


def multipliers_of(rows: Array, vectors: Array) -> Array:
    """Return the multipliers (N, c) of the rows that come closest to the vectors (N, m)."""
    right = np.einsum("kcm,km->kc", rows, vectors)
    return np.linalg.solve(gram(rows), right[:, :, None])[:, :, 0]


def shortest(rows: Array, right: Array) -> Array:
    """Return the shortest solution of A x = r."""
    solved = np.linalg.solve(gram(rows), right[:, :, None])
    return np.asarray((rows.transpose(0, 2, 1) @ solved)[:, :, 0])
