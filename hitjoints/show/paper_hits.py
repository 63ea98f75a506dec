"""Draw the paper's Fig. 5 and 6: the starts, and the inertia along the hits."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from hitjoints.evidence.paper.scenario import JOINTS, PRINTED
from hitjoints.show.drawn_arm import BOX, draw_arm
from hitjoints.show.figures import colour_of

if TYPE_CHECKING:
    from collections.abc import Mapping

    from matplotlib.figure import Figure

    from hitjoints.evidence.paper.reproduction import Experiments
    from hitjoints.evidence.paper.scenario import Scenario
    from hitjoints.rollouts.record import Rollout

ARMS = {"iiwa14_bullet": "-", "iiwa14": "--"}


VIEW = np.array([[-0.15, 0.85], [-0.15, 0.6], [0.0, 0.85]])
"""m, of every arm drawn, so that they compare."""


def same_view(axis: Any) -> None:
    """Show the same part of space on a 3-D axis as on all others."""
    from matplotlib.ticker import MultipleLocator

    axis.set(xlim=VIEW[0], ylim=VIEW[1], zlim=VIEW[2])
    axis.set_box_aspect(np.ptp(VIEW, axis=1), zoom=0.85)
    for side in (axis.xaxis, axis.yaxis, axis.zaxis):
        side.set_major_locator(MultipleLocator(0.4))


def until_impact(hit: Rollout, quantity: str) -> tuple[np.ndarray, np.ndarray]:
    """Return the distance to the object (m) and a quantity, up to the impact."""
    rows, asked = hit.rows, hit.hit
    ahead = (asked.position - rows["position"]) @ asked.direction
    return ahead[rows["approach"]], rows[quantity][rows["approach"]]


def draw_starts(scenario: Scenario, on: Experiments) -> Figure:
    """Return Fig. 5: the start configuration of each joint, the object and the way to it."""
    from matplotlib.figure import Figure

    assert on.hits is not None
    figure = Figure(figsize=(13, 5), layout="constrained")
    for column, k in enumerate(JOINTS):
        axis: Any = figure.add_subplot(1, 3, column + 1, projection="3d")
        start = on.hits.starts[k]
        draw_arm(axis, on.robot, start.posture.q, k, scenario.direction, ellipsoid=False)
        way = np.stack([scenario.start, scenario.position])
        axis.plot(*way.T, "k:", lw=1.2, zorder=28)
        axis.plot(*way[1:].T, "s", color=BOX, ms=11, mec="k", zorder=28)
        same_view(axis)
        axis.set_title(
            f"joint {k}: {start.posture.inertia:.3g} kg at the start",
            fontsize="medium",
            color=colour_of(k),
        )
    figure.suptitle(
        "Fig. 5: start configurations by Eq. 14, all from the same position; object in orange",
        fontsize="medium",
    )
    return figure


def draw_hits(arms: Mapping[str, Experiments]) -> Figure:
    """Return Fig. 6: the inertia along the motion, with its value at the impact and the paper's."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(13, 4.6), layout="constrained")
    axes = figure.subplots(1, 3)
    for axis, k in zip(axes, JOINTS, strict=True):
        for name, style in ARMS.items():
            hits = arms[name].hits
            assert hits is not None
            hit = hits.shown(k)
            assert hit.impact is not None
            axis.plot(*until_impact(hit, "inertia"), style, color=colour_of(k), label=name)
            axis.plot(0, hit.impact.inertia, "o", color=colour_of(k), clip_on=False)
        if k in PRINTED:
            axis.axhline(PRINTED[k], color="k", ls=":", lw=1.2, label=f"paper, {PRINTED[k]} kg")
        axis.set(xlabel="distance to the object (m)", ylabel="directional inertia (kg)")
        axis.set_ylim(0, 1.15 * max(axis.get_ylim()[1], PRINTED.get(k, 0)))
        axis.invert_xaxis()
        axis.grid(alpha=0.3)
        axis.spines[["top", "right"]].set_visible(False)
        axis.legend(frameon=False, loc="lower left")
        axis.set_title(_heading(arms, k), fontsize="medium", color=colour_of(k))
    figure.suptitle("Fig. 6: inertia along the hits, dot at the impact", fontsize="medium")
    return figure


def _heading(arms: Mapping[str, Experiments], joint: int) -> str:
    hits = arms["iiwa14_bullet"].hits
    assert hits is not None
    impact = hits.shown(joint).impact
    assert impact is not None
    asked = hits.shown(joint).hit.desired_flux
    short = f" of {asked:g}" if impact.flux < asked / 2 else ""
    return (
        f"joint {joint}: {impact.inertia:.3g} kg at the impact, flux {impact.flux:.2g}{short} m/s"
    )
