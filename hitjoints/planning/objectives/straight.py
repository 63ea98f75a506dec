"""The straight hitting speed's linear program for rows of configurations."""

from __future__ import annotations

from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from hitjoints.types import Array

PARALLEL = 1e-9  # sine of the angle below which two lateral velocities are parallel
LEVEL = 1e-9  # reduced speeds below this share of the greatest pull vanish
RELATIVE, TINY = 1e-13, 1e-18  # damping (TINY in (m/rad)^2) where fewer than two joints balance
PASSES = 4  # of balancing; a joint that meets its bound leaves the others to it


def straight_velocities(pull: Array, across: Array, lower: Array, upper: Array) -> Array:
    """Return joint velocities of the fastest motion without lateral speed, (N, n) rad/s.

    The dual, min over mu (2,) of the support of the velocity box at g + mu . a, is attained where
    the reduced speeds of two joints vanish, or of more: those of the three joints of a spherical
    shoulder always vanish together; of one joint, where all lateral motion is along one line. They
    balance the lateral motion of the others, which sit on the bound their sign asks for. What
    rounding or the bounds leave of it has to be corrected by who uses the velocity.

    Args:
        pull: (N, n) m/rad, g = J^T h.
        across: (N, 2, n) m/rad, the lateral rows a = B^T J.
        lower: (n,) or (N, n) rad/s.
        upper: (n,) or (N, n) rad/s.
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
    if not (len(pairs) and usable.any(axis=1).all()):
        # Sideways all joints move the contact along one line, or not at all.
        square = (across**2).sum(axis=1)
        moving = square > 0
        single = across * (-pull / np.where(moving, square, 1.0))[:, None, :]
        mu = np.concatenate((mu, single.transpose(0, 2, 1), np.zeros((rows, 1, 2))), axis=1)
        usable = np.concatenate((usable, moving, np.ones((rows, 1), dtype=bool)), axis=1)
    reduced = pull[:, None, :] + mu @ across
    low, high = np.atleast_2d(lower)[:, None, :], np.atleast_2d(upper)[:, None, :]
    dual = np.maximum(reduced * high, reduced * low).sum(axis=2)
    best = np.argmin(np.where(usable, dual, np.inf), axis=1)
    chosen = reduced[np.arange(rows), best]
    size = np.abs(pull).max(axis=1, initial=0.0, keepdims=True)
    balancing = np.abs(chosen) <= LEVEL * size
    qd = np.where(chosen > 0, upper, lower)
    qd = np.where(balancing, np.clip(0.0, lower, upper), qd)
    for _ in range(PASSES):
        # The least further motion of the balancing joints that stops the lateral one.
        a = across * balancing[:, None, :]
        gram = a @ a.transpose(0, 2, 1)
        trace = gram[:, 0, 0] + gram[:, 1, 1]
        gram[:, (0, 1), (0, 1)] += (RELATIVE * trace + TINY)[:, None]
        lateral = across @ qd[:, :, None]
        qd = qd - (a.transpose(0, 2, 1) @ np.linalg.solve(gram, lateral))[:, :, 0]
        balancing &= (qd > lower) & (qd < upper)
        qd = np.clip(qd, lower, upper)
    return qd
