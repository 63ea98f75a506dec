"""Draw the paper's Fig. 5 and 6: the starts, and the inertia along the hits."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from hitjoints.evidence.paper.scenario import JOINTS, PRINTED
from hitjoints.show.drawn_arm import BOX, add_ground, arm_picture, chain
from hitjoints.show.sheet import Sheet, sheet
from hitjoints.show.style import Look, colour_of

if TYPE_CHECKING:
    from collections.abc import Mapping

    from matplotlib.axes import Axes

    from hitjoints.evidence.paper.reproduction import Experiments
    from hitjoints.evidence.paper.scenario import Scenario
    from hitjoints.rollouts.record import Rollout
    from hitjoints.show.picture import Picture
    from hitjoints.types import Array

ARMS = {"iiwa14_bullet": "-", "iiwa14": "--"}


def until_impact(hit: Rollout, quantity: str) -> tuple[np.ndarray, np.ndarray]:
    """Return the distance to the object (m) and a quantity, up to the impact."""
    rows, asked = hit.rows, hit.hit
    ahead = (asked.position - rows["position"]) @ asked.direction
    return ahead[rows["approach"]], rows[quantity][rows["approach"]]


def draw_arms(axes: list[Axes], pictures: list[tuple[Picture, str]], seen: Array) -> None:
    """Draw arms side by side, the same part of space of each.

    Args:
        axes: of each.
        pictures: each with its title.
        seen: (N, 3) m, what is to be in all of them.
    """
    for picture, _ in pictures:
        add_ground(picture, seen)
    all_bounds = np.array([picture.bounds() for picture, _ in pictures])
    bounds = np.stack([all_bounds[..., 0].min(axis=0), all_bounds[..., 1].max(axis=0)], axis=1)
    for axis, (picture, title) in zip(axes, pictures, strict=True):
        picture.draw(axis, bounds)
        axis.set_title(title)


def draw_starts(scenario: Scenario, on: Experiments, look: Look) -> Sheet:
    """Return Fig. 5: the start configuration of each joint, the object and the way to it."""
    assert on.hits is not None
    figure, axes = sheet(look, len(JOINTS), 3, (4.2, 3.5), 1.1)
    way = np.stack([scenario.start, scenario.position])
    pictures, seen = [], [way]
    for k in JOINTS:
        start = on.hits.starts[k]
        q = start.posture.q
        picture, _ = arm_picture(on.robot, q, k, scenario.direction, ellipsoid=False)
        picture.line(way, ls=":", color="k", lw=1.2)
        picture.line(way[1:], ls="", marker="s", color=BOX, mec="k")
        pictures.append((picture, f"joint {k}: {start.posture.inertia:.3g} kg at the start"))
        seen.append(chain(on.robot, q))
    draw_arms(axes, pictures, np.vstack(seen))
    figure.headline("Fig. 5: starts by Eq. 14, all from the same position; object in orange")
    return figure


def draw_hits(arms: Mapping[str, Experiments], look: Look) -> Sheet:
    """Return Fig. 6: the inertia along the motion, with its value at the impact and the paper's."""
    figure, axes = sheet(look, len(JOINTS), 3, (4.2, 3.8))
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
        axis.grid(visible=True)
        axis.legend(loc="lower left")
        axis.set_title(_heading(arms, k), fontsize="small")
    figure.headline("Fig. 6: inertia along the hits, dot at the impact")
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
