"""Draw recorded hits: the speeds through each impact, and predicted against measured speeds."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from hitjoints.evidence.recordings.fits import LENGTH, PUSH
from hitjoints.show.sheet import Sheet, below, sheet
from hitjoints.show.style import COLOURS, MARKS, Look

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from hitjoints.evidence.recordings.replayed_hit import ReplayedHit
    from hitjoints.evidence.recordings.replayer import Replay

FEW = 6
"""Up to so many hits each have a colour and a name."""
MANY = (COLOURS[1], COLOURS[0])
"""Colours of the robots and the objects when there are more."""
SPAN = (-0.1, 0.1)
"""s around the contact that are drawn."""
OUTLIER = 0.15
"""Off by more than this share of the prediction, a hit is named."""
NAMED = 8
"""At most so many of them, the farthest off first."""


def draw_replay(result: Replay, look: Look) -> Sheet:
    """Return the figure of the hits that could be used.

    On the left the speeds along the hitting direction, from the contact: the robot's row by row,
    the object's where a line was fitted to its motion. On the right what Eq. 3 predicts against
    what was measured.
    """
    figure, (speeds, judged) = sheet(look, 2, 2, (5.0, 4.6))
    hits = result.usable
    few = len(hits) <= FEW
    for i, hit in enumerate(hits):
        colours = (COLOURS[i], COLOURS[i]) if few else MANY
        alpha = 1.0 if few else max(0.05, min(0.6, 12 / len(hits)))
        _draw_speeds(speeds, hit, colours, MARKS[i] if few else "", alpha)
    _finish_speeds(speeds, few)
    draw_predicted(judged, result)
    unusable = len(result.hits) - len(hits)
    more = f"; {unusable} of {len(result.hits)} files not usable" if unusable else ""
    noun = "hit" if len(hits) == 1 else "hits"
    figure.headline(f"{len(hits)} recorded {noun}{more}")
    return figure


def _draw_speeds(
    axis: Axes, hit: ReplayedHit, colours: tuple[str, str], mark: str, alpha: float
) -> None:
    assert hit.series is not None
    near = (hit.series.time >= SPAN[0]) & (hit.series.time <= SPAN[1])
    time, speed = 1e3 * hit.series.time[near], hit.series.speed[near]
    axis.plot(time, speed, color=colours[0], lw=1.2, alpha=alpha, marker=mark, markevery=3)
    if hit.object_speed is not None and hit.object_time is not None:
        middle, half = 1e3 * hit.object_time, 1e3 * LENGTH / 2
        ends, level = [middle - half, middle + half], [hit.object_speed] * 2
        axis.plot(
            ends, level, color=colours[1], lw=3, alpha=alpha, solid_capstyle="butt", marker=mark,
            mec="white",
        )  # fmt: skip


def _finish_speeds(axis: Axes, few: bool) -> None:
    axis.axvspan(0, 1e3 * PUSH, color="grey", alpha=0.15, lw=0)
    top = axis.get_xaxis_transform()
    axis.text(
        1e3 * PUSH / 2, 0.99, "contact", color="dimgrey", fontsize="small", ha="center", va="top",
        transform=top,
    )  # fmt: skip
    robot, thing = ("k", "k") if few else MANY
    axis.plot([], [], color=robot, lw=1.2, label="robot, row by row")
    axis.plot([], [], color=thing, lw=3, label=f"object, over {1e3 * LENGTH:g} ms")
    axis.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2)
    axis.margins(y=0.08)
    axis.set_ylim(bottom=min(0.0, axis.get_ylim()[0]))
    axis.set_xlabel("time from the first touch (ms)")
    axis.set_ylabel("speed along the hitting direction (m/s)")


def draw_predicted(axis: Axes, result: Replay) -> None:
    """Draw predicted against measured speeds of the object; what is far off is named."""
    pairs = [
        (hit, hit.predicted_object_speed, hit.object_speed)
        for hit in result.usable
        if hit.predicted_object_speed is not None and hit.object_speed is not None
    ]
    if not pairs:
        axis.text(0.5, 0.5, "no object speed to compare", ha="center", transform=axis.transAxes)
        axis.set_axis_off()
        return
    predicted, measured = (np.array([pair[k] for pair in pairs], float) for k in (1, 2))
    if len(result.usable) <= FEW:
        for i, (hit, x, y) in enumerate(pairs):
            label = f"{_name(hit)}: restitution {hit.restitution:.2f}"
            axis.plot(x, y, MARKS[i], color=COLOURS[i], label=label)
        below(axis, 3, 1)
    else:
        axis.plot(predicted, measured, "o", color=MANY[1], ms=3, alpha=0.4, mew=0)
    most = 1.25 * float(max(predicted.max(), measured.max()))
    axis.plot([0, most], [0, most], "k--", lw=1)
    axis.text(0.9 * most, 0.88 * most, "equal", ha="left", va="top", color="dimgrey")
    _name_outliers(axis, [hit for hit, *_ in pairs], predicted, measured)
    axis.set_xlim(0, most)
    axis.set_ylim(0, most)
    axis.set_aspect("equal")
    axis.set_xlabel(r"predicted object speed $(1 + \epsilon)\,\phi$ (m/s)")
    axis.set_ylabel("measured object speed (m/s)")


def _name_outliers(
    axis: Axes, hits: list[ReplayedHit], predicted: np.ndarray, measured: np.ndarray
) -> None:
    off = measured / np.maximum(predicted, np.finfo(float).tiny) - 1
    for i in np.argsort(-np.abs(off))[:NAMED]:
        if abs(off[i]) > OUTLIER:
            axis.annotate(
                f"{_name(hits[i])}, {100 * off[i]:+.0f} %", (predicted[i], measured[i]), (-5, 4),
                textcoords="offset points", ha="right", fontsize="small",
            )  # fmt: skip


def _name(hit: ReplayedHit) -> str:
    return hit.file.replace("\\", "/").rpartition("/")[2].removesuffix(".csv")
