"""Which samples to climb from: good ones, and different ones."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from hitjoints.planning.objectives.hit_problem import HitProblem
    from hitjoints.types import Array

PENALTY = 3.0
"""Of an excess, against the logarithm of the objective."""


def starts_of(
    problem: HitProblem, q: Array, value: Array, excess: Array, count: int, scale: Array
) -> Array:
    """Choose what to climb from (S, n): the best admissible rows, or else those nearest to it.

    A demanded flux leaves small islands that samples miss; climbs that have to be pulled onto them
    from good values find more.

    Args:
        problem: to be climbed.
        q: (N, n) rad, the samples.
        value: (N,) what they screened at.
        excess: (N,) likewise.
        count: at most so many, or twice as many where a flux is demanded.
        scale: (n,) 1/rad, what makes starts different: they are 1 apart.
    """
    chosen = _diverse(q * scale, value, excess, count)
    if problem.flux is not None:
        usable = np.isfinite(excess)
        short = np.where(usable, PENALTY * excess, np.inf)
        bold = _diverse(q * scale, value - short, np.where(usable, 0.0, np.inf), count)
        chosen = np.union1d(chosen, bold)
    return np.asarray(q[chosen])


def _diverse(q: Array, value: Array, excess: Array, count: int) -> NDArray[np.intp]:
    """Choose rows (<= count) of high value, 1 apart at least, the admissible ones first."""
    usable = np.isfinite(excess) & np.isfinite(value)
    order = np.lexsort((-value, excess))
    order = order[usable[order]]
    chosen: list[int] = []
    while order.size and len(chosen) < count:
        chosen.append(int(order[0]))
        order = order[((q[order] - q[order[0]]) ** 2).sum(axis=1) > 1.0]
    return np.array(chosen, dtype=int)
