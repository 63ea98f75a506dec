"""Draw the paper's figures from a reproduction, in its layout."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from hitjoints.show.drawn_arm import arm_picture, chain
from hitjoints.show.joint_curves import broad, curve_of, set_quarters
from hitjoints.show.paper_hits import draw_arms, draw_hits, draw_starts, until_impact
from hitjoints.show.paper_spread import draw_spread
from hitjoints.show.sheet import Sheet, sheet
from hitjoints.show.style import Look

if TYPE_CHECKING:
    from collections.abc import Mapping

    from matplotlib.axes import Axes
    from xarray import Dataset

    from hitjoints.evidence.paper.reproduction import Experiments, Reproduction

PAPERS = "iiwa14_bullet"
OTHERS = {
    "iiwa14": ("--", "the URDF's tensors"),
    "iiwa14_phantom": (":", "with the phantom inertia"),
}
"""Line style and name of the arms beside the paper's."""
PANELS = (
    ("inertia", "directional inertia (kg)"),
    ("speed", "maximum hitting speed (m/s)"),
    ("flux", "maximum hitting flux (m/s)"),
)
FOLLOWED = (
    ("inertia", "inertia (kg)"),
    ("speed", "speed (m/s)"),
    ("flux", "flux (m/s)"),
)


def draw_reproduction(result: Reproduction, look: Look) -> dict[str, Sheet]:
    """Return the figures of what was run, by name: fig2, fig4, fig5, fig6, spread."""
    arms, first = result.experiments, next(iter(result.experiments.values()))
    figures = {}
    if first.turn is not None:
        figures["fig2"] = _draw_turn(arms, look)
    if first.references is not None:
        figures["fig4"] = _draw_references(first, look)
    if first.hits is not None:
        figures["fig5"] = draw_starts(result.scenario, first, look)
        figures["fig6"] = draw_hits({name: arms[name] for name in (PAPERS, "iiwa14")}, look)
    if first.spread is not None:
        figures["spread"] = draw_spread(arms, look)
    return figures


def _draw_turn(arms: Mapping[str, Experiments], look: Look) -> Sheet:
    """Return Fig. 2: the arms with the hitting joint encircled, the graphs, and other tensors'."""
    from matplotlib.lines import Line2D

    first = arms[PAPERS]
    assert first.turn is not None
    figure, axes = sheet(look, 9, 3, (3.8, 3.1))
    joints = sorted(int(k) for k in first.turn.joint.values)
    pictures, seen = [], []
    for k in joints[::-1]:
        q = first.turn.sel(joint=k).q.values
        direction = first.turn.attrs["direction"]
        picture, _ = arm_picture(first.robot, q, k, direction, ellipsoid=False)
        pictures.append((picture, f"joint {k} at the object"))
        seen.append(chain(first.robot, q))
    draw_arms(axes[:3], pictures, np.vstack(seen))
    _draw_graphs(axes[3:6], first.turn, joints)
    for name, (style, _) in OTHERS.items():
        turn = arms[name].turn
        assert turn is not None
        _draw_graphs(axes[6:], turn, joints, style)
    handles = list(axes[3].lines)
    handles += [Line2D([], [], color="grey", ls=s, label=said) for s, said in OTHERS.values()]
    figure.key(handles)
    figure.headline(
        "Fig. 2: the hitting joint turns; object of 2 kg. Middle: PyBullet's tensors, which are "
        "the paper's; below: others"
    )
    return figure


def _draw_graphs(axes: list[Axes], turn: Dataset, joints: list[int], style: str = "-") -> None:
    for axis, (quantity, label) in zip(axes, PANELS, strict=True):
        for place, k in enumerate(joints):
            row, width = turn.sel(joint=k), broad(place, len(joints)) if style == "-" else 1.2
            axis.plot(
                np.degrees(row.angle), row[quantity], **curve_of(k, ls=style, lw=width, ms=4),
                label=f"joint {k}",
            )  # fmt: skip
        axis.set(xlabel="angle of the hitting joint (deg)", ylabel=label)
        set_quarters(axis)
        _finish(axis)


def _draw_references(on: Experiments, look: Look) -> Sheet:
    """Return Fig. 4: desired and achieved inertia, a column per reference, speed and flux below."""
    assert on.references is not None
    figure, axes = sheet(look, 6, 2, (4.8, 2.6))
    titles = {"constant": "constant reference", "optimised": "reference of Eq. 13"}
    for (k, reference), hit in on.references.items():
        column = axes[list(titles).index(reference) :: 2]
        column[0].set_title(titles[reference])
        for axis, (quantity, label) in zip(column, FOLLOWED, strict=True):
            width = broad(0 if k == 6 else 1, 2)
            style = curve_of(k, lw=width, label=f"joint {k}", zorder=3 - width / 10)
            axis.plot(*until_impact(hit, quantity), **style)
            if quantity == "inertia":
                wanted = until_impact(hit, "desired_inertia")
                axis.plot(*wanted, "k--", lw=1, zorder=4, label="desired" if k == 6 else None)
            if quantity == "flux" and k == 6:
                axis.axhline(hit.hit.desired_flux, color="k", ls="--", lw=1)
            axis.set(xlabel="distance to the object (m)", ylabel=label)
    for left, right in zip(axes[::2], axes[1::2], strict=True):
        top = max(_finish(axis) for axis in (left, right))
        for axis in (left, right):
            axis.set_ylim(0, top)
            axis.invert_xaxis()
            axis.label_outer()
    figure.key(axes[0].get_legend_handles_labels()[0])
    figure.headline(f"Fig. 4: desired and achieved inertia along the motion, {PAPERS}")
    return figure


def _finish(axis: Axes) -> float:
    """Set limits and grid when everything is drawn: zero is shown, and room above."""
    top = 1.12 * max(float(np.nanmax(np.asarray(line.get_ydata()))) for line in axis.lines)
    axis.set_ylim(0, top)
    axis.grid(visible=True)
    return top
