"""The straight hitting speed's linear program for rows of configurations."""

from __future__ import annotations

from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

PARALLEL = 1e-9  # sine of the angle below which two lateral velocities are parallel


def straight_velocities(pull: Array, across: Array, lower: Array, upper: Array) -> Array:
    """Return joint velocities of the fastest motion without lateral speed, (N, n) rad/s.

    The dual, min over mu (2,) of the support of the velocity box at g + mu . a, is attained where
    the reduced speeds of two joints vanish. Those two are then solved for; the others sit on the
    bound their sign asks for. Where fewer than two joints can balance each other the velocity is
    the best guess, to be corrected by who uses it.

    Args:
        pull: (N, n) m/rad, g = J^T h.
        across: (N, 2, n) m/rad, the lateral rows a = B^T J.
        lower, upper: (n,) rad/s.
    """
    rows, n = pull.shape
    pairs = np.array(list(combinations(range(n), 2)), dtype=int).reshape(-1, 2)
    first, second = across[:, :, pairs[:, 0]], across[:, :, pairs[:, 1]]
    det = first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]
    size = np.linalg.norm(first, axis=1) * np.linalg.norm(second, axis=1)
    usable = np.abs(det) > PARALLEL * np.maximum(size, PARALLEL)
    g1, g2 = pull[:, pairs[:, 0]], pull[:, pairs[:, 1]]
    scale = np.where(usable, 1.0 / np.where(usable, det, 1.0), 0.0)
    mu = np.stack(
        ((g2 * first[:, 1] - g1 * second[:, 1]), (g1 * second[:, 0] - g2 * first[:, 0])), axis=-1
    ) * scale[:, :, None]  # fmt: skip
    reduced = pull[:, None, :] + mu @ across
    dual = np.maximum(reduced * upper, reduced * lower).sum(axis=2)
    best = np.argmin(np.where(usable, dual, np.inf), axis=1)
    at = np.arange(rows)
    chosen = reduced[at, best]
    qd = np.where(chosen > 0, upper, lower)
    qd = np.where(np.any(across != 0, axis=1) | (pull != 0), qd, np.clip(0.0, lower, upper))
    i, j = pairs[best].T
    qd[at, i], qd[at, j] = 0.0, 0.0
    rest = -np.einsum("kan,kn->ka", across, qd)
    inverse = scale[at, best]
    p, r = across[at, :, i], across[at, :, j]
    qd[at, i] = (rest[:, 0] * r[:, 1] - rest[:, 1] * r[:, 0]) * inverse
    qd[at, j] = (p[:, 0] * rest[:, 1] - p[:, 1] * rest[:, 0]) * inverse
    return np.clip(qd, lower, upper)
