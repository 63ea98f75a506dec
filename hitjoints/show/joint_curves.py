"""A curve for each joint, told apart by colour, by mark, and where they lie on each other."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from hitjoints.show.style import colour_of, mark_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from hitjoints.types import Array

APART = 0.22
"""Of the axis, along a curve from mark to mark."""
BROADER = 1.3
"""Points that each curve is broader than the one drawn upon it."""


def curve_of(joint: int, **more: Any) -> dict[str, Any]:
    """Return how a joint's curve is drawn: marks of different joints do not meet."""
    begin = APART * ((7 - joint) % 7 + 0.5) / 7
    return {
        "color": colour_of(joint), "marker": mark_of(joint), "markevery": (begin, APART), **more
    }  # fmt: skip


def broad(place: int, count: int) -> float:
    """Return the width (pt) of a curve, drawn as number `place` of so many, that none hides it."""
    from matplotlib import rcParams

    return float(rcParams["lines.linewidth"]) + BROADER * (count - 1 - place)


def set_quarters(axis: Axes) -> None:
    """Set ticks at quarters of a turn (deg), or fewer where there is no room."""
    from matplotlib.ticker import MaxNLocator

    axis.xaxis.set_major_locator(MaxNLocator("auto", steps=[1, 1.8, 4.5, 9, 10]))


def draw_shares(axis: Axes, times: Array, values: Array, limit: Array, label: str) -> None:
    """Draw a curve per joint in units of its limit.

    Args:
        axis: what is drawn on.
        times: (N,) s.
        values: (N, n).
        limit: (n,) or (N, n), above 0 where there is one.
        label: of the shares.
    """
    limit = np.broadcast_to(limit, values.shape)
    share = np.divide(values, limit, out=np.zeros_like(values), where=limit > 0)
    for i, curve in enumerate(share.T):
        axis.plot(times, curve, lw=1, label=f"joint {i + 1}", **curve_of(i + 1))
    most = float(np.abs(share).max(initial=0.0))
    for end in (-1.0, 1.0):
        axis.axhline(end, color="grey", ls=":", lw=0.8, zorder=1)
    top = 1.08 * max(1.0, most)
    axis.set(xlabel="time (s)", ylabel=label, ylim=(-top, top))
    if float(share.min(initial=0.0)) >= 0:
        axis.set_ylim(bottom=-0.05)


def draw_impact(axis: Axes, time: float | None) -> None:
    """Mark the time of the impact (s), if there was one."""
    if time is not None:
        axis.axvline(time, color="grey", lw=0.8, zorder=1)
