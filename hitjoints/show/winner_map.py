"""Draw which joint is best where: its colour and number, and stripes of two where they tie."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from typing import TYPE_CHECKING, Any

import numpy as np

from hitjoints.show.style import colour_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from hitjoints.types import Array

TIE = 0.05
"""Two joints tie where they differ by less than that share: which is ahead is chance there."""
TIES = f"stripes: two joints within {100 * TIE:g} %"
STRIPES = "////"
NAMED = 0.04
"""Areas of at least that share of all cells have their joints' numbers in them."""


def draw_winners(axis: Any, x: Array, y: Array, values: Array, joints: Sequence[int]) -> None:
    """Draw the joint of the greatest value in every cell; nothing where none has a value.

    Args:
        axis: what is drawn on.
        x: (X,) m, middles of the cells.
        y: (Y,) m.
        values: (joints, Y, X), nan where a joint has none.
        joints: their numbers, from 1.
    """
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path

    cells = _cells(x, y)
    for first, second, where in _areas(values):
        if where.any():
            path = Path.make_compound_path(
                *(Path(cells[r, c], closed=True) for r, c in np.argwhere(where))
            )
            face, stripe = colour_of(joints[first]), colour_of(joints[second])
            tied = {} if first == second else {"hatch": STRIPES, "edgecolor": stripe}
            axis.add_patch(PathPatch(path, facecolor=face, linewidth=0, **tied))
            if where.mean() >= NAMED:
                row, column = _inmost(where)
                named = dict.fromkeys((joints[first], joints[second]))
                axis.text(
                    x[column], y[row], ", ".join(map(str, named)), ha="center", va="center",
                    fontsize="small", zorder=5,
                    bbox={"boxstyle": "round,pad=0.2", "fc": "white", "ec": "none"},
                )  # fmt: skip
    axis.set(xlim=(cells[..., 0].min(), cells[..., 0].max()))
    axis.set(ylim=(cells[..., 1].min(), cells[..., 1].max()))


def winners(values: Array) -> NDArray[np.int64]:
    """Return the two best of every cell of values (joints, Y, X), in order of their place.

    Returns:
        (2, Y, X): the same twice where one is ahead by more than `TIE`, -1 where none has a value.
    """
    known = np.where(np.isnan(values), -np.inf, values)
    order = np.argsort(-known, axis=0, kind="stable")
    best, next_best = order[0], order[min(1, len(order) - 1)]
    top, second = (np.take_along_axis(known, one[None], 0)[0] for one in (best, next_best))
    tied = (best != next_best) & np.isfinite(second) & (second > (1 - TIE) * top)
    pair = np.sort(np.stack([best, np.where(tied, next_best, best)]), axis=0)
    return np.where(np.isfinite(top), pair, -1)


def _areas(values: Array) -> list[tuple[int, int, Any]]:
    """Return the areas of one joint, and of two that tie, each with its cells (Y, X)."""
    first, second = winners(values)
    count = len(values)
    pairs = [*((k, k) for k in range(count)), *combinations(range(count), 2)]
    return [(a, b, (first == a) & (second == b)) for a, b in pairs]


def _cells(x: Array, y: Array) -> Array:
    """Return the corners of every cell, closed: (Y, X, 5, 2) m."""
    left, right, low, high = *_edges(x), *_edges(y)
    corners = [(left, low), (right, low), (right, high), (left, high), (left, low)]
    shape = len(y), len(x)
    return np.stack(
        [np.stack([np.broadcast_to(a, shape), np.broadcast_to(b[:, None], shape)], -1)
         for a, b in corners], axis=-2,
    )  # fmt: skip


def _edges(middle: Array) -> tuple[Array, Array]:
    between = (middle[1:] + middle[:-1]) / 2
    first, last = 2 * middle[0] - between[0], 2 * middle[-1] - between[-1]
    return np.concatenate([[first], between]), np.concatenate([between, [last]])


def _inmost(where: Any) -> tuple[int, int]:
    """Return the cell of an area that is farthest from its border, about."""
    left = np.pad(where, 1)
    while True:
        inner = left.copy()
        for shift in (1, -1):
            for axis in (0, 1):
                inner &= np.roll(left, shift, axis)
        if not inner.any():
            cells = np.argwhere(left)
            row, column = cells[len(cells) // 2] - 1
            return int(row), int(column)
        left = inner
