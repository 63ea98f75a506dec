"""Draw recorded hits: the speeds through each impact, and predicted against measured speeds."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from hitjoints.evidence.recordings.fits import LENGTH, PUSH
from hitjoints.show.figures import COLOURS

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from hitjoints.evidence.recordings.replayed_hit import ReplayedHit
    from hitjoints.evidence.recordings.replayer import Replay

FEW = 6
"""Up to so many hits each have a colour and a name."""

MANY = (COLOURS[1], COLOURS[0])
"""Colours of the robots and the objects when there are more."""

SPAN = (-0.1, 0.1)
"""s around the contact that are drawn."""


def draw_replay(result: Replay) -> Figure:
    """Return the figure of the hits that could be used.

    On the left the speeds along the hitting direction, from the contact: the robot's row by row,
    the object's where a line was fitted to its motion. On the right what Eq. 3 predicts against
    what was measured.
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=(10, 4.6), layout="constrained")
    speeds, judged = figure.subplots(1, 2)
    hits = result.usable
    few = len(hits) <= FEW
    for i, hit in enumerate(hits):
        colours = (COLOURS[i], COLOURS[i]) if few else MANY
        _draw_speeds(speeds, hit, colours, 1.0 if few else max(0.05, min(0.6, 12 / len(hits))))
    _finish_speeds(speeds, few)
    _draw_predicted(judged, hits, few)
    for axis in (speeds, judged):
        axis.spines[["top", "right"]].set_visible(False)
    unusable = len(result.hits) - len(hits)
    more = f"; {unusable} of {len(result.hits)} files not usable" if unusable else ""
    noun = "hit" if len(hits) == 1 else "hits"
    figure.suptitle(f"{len(hits)} recorded {noun}{more}", fontsize="medium")
    return figure


def _draw_speeds(axis: Axes, hit: ReplayedHit, colours: tuple[str, str], alpha: float) -> None:
    assert hit.series is not None
    near = (hit.series.time >= SPAN[0]) & (hit.series.time <= SPAN[1])
    time, speed = 1e3 * hit.series.time[near], hit.series.speed[near]
    axis.plot(time, speed, color=colours[0], lw=1.2, alpha=alpha)
    if hit.object_speed is not None and hit.object_time is not None:
        middle, half = 1e3 * hit.object_time, 1e3 * LENGTH / 2
        ends, level = [middle - half, middle + half], [hit.object_speed] * 2
        axis.plot(ends, level, color=colours[1], lw=3, alpha=alpha, solid_capstyle="butt")


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
    axis.legend(
        frameon=False, fontsize="small", loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2
    )
    axis.margins(y=0.08)
    axis.set_ylim(bottom=min(0.0, axis.get_ylim()[0]))
    axis.set_xlabel("time from the first touch (ms)")
    axis.set_ylabel("speed along the hitting direction (m/s)")


def _draw_predicted(axis: Axes, hits: tuple[ReplayedHit, ...], few: bool) -> None:
    pairs = [
        (i, hit, hit.predicted_object_speed, hit.object_speed)
        for i, hit in enumerate(hits)
        if hit.predicted_object_speed is not None and hit.object_speed is not None
    ]
    if not pairs:
        axis.text(0.5, 0.5, "no object speed to compare", ha="center", transform=axis.transAxes)
        axis.set_axis_off()
        return
    predicted, measured = (np.array([pair[k] for pair in pairs], float) for k in (2, 3))
    if few:
        for i, hit, x, y in pairs:
            name = hit.file.replace("\\", "/").rpartition("/")[2].removesuffix(".csv")
            label = f"{name}: restitution {hit.restitution:.2f}"
            axis.plot(x, y, "o", color=COLOURS[i], label=label)
        axis.legend(frameon=False, fontsize="small", loc="lower right")
    else:
        axis.plot(predicted, measured, "o", color=MANY[1], ms=3, alpha=0.4, mew=0)
    most = 1.25 * float(max(predicted.max(), measured.max()))
    axis.plot([0, most], [0, most], "k--", lw=1)
    axis.text(0.9 * most, 0.88 * most, "equal", ha="left", va="top", color="dimgrey")
    axis.set_xlim(0, most)
    axis.set_ylim(0, most)
    axis.set_aspect("equal")
    axis.set_xlabel(r"predicted object speed $(1 + \epsilon)\,\phi$ (m/s)")
    axis.set_ylabel("measured object speed (m/s)")
