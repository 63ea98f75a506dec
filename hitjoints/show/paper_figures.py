"""Draw the paper's figures from a reproduction, in its layout."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from hitjoints.show.figures import colour_of
from hitjoints.show.paper_hits import draw_hits, draw_starts, same_view, until_impact
from hitjoints.show.paper_spread import draw_spread

if TYPE_CHECKING:
    from collections.abc import Mapping

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from xarray import Dataset

    from hitjoints.evidence.paper.reproduction import Experiments, Reproduction

ARMS = {
    "iiwa14_bullet": ("-", "PyBullet's tensors"),
    "iiwa14": ("--", "the URDF's"),
    "iiwa14_phantom": (":", "with the phantom inertia"),
}
"""Line style and name of each arm, the paper's first."""
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


def draw_reproduction(result: Reproduction) -> dict[str, Figure]:
    """Return the figures of what was run, by name: fig2, fig4, fig5, fig6, spread."""
    arms, first = result.experiments, next(iter(result.experiments.values()))
    figures = {}
    if first.turn is not None:
        figures["fig2"] = _draw_turn(arms)
    if first.references is not None:
        figures["fig4"] = _draw_references(first)
    if first.hits is not None:
        figures["fig5"] = draw_starts(result.scenario, first)
        figures["fig6"] = draw_hits({name: arms[name] for name in ARMS})
    if first.spread is not None:
        figures["spread"] = draw_spread(arms)
    return figures


def _draw_turn(arms: Mapping[str, Experiments]) -> Figure:
    """Return Fig. 2: the arms with the hitting joint encircled, and the three graphs below."""
    from matplotlib.figure import Figure

    from hitjoints.show.drawn_arm import draw_arm

    first = next(iter(arms.values()))
    assert first.turn is not None
    figure = Figure(figsize=(11, 7.5), layout="constrained")
    joints = [int(k) for k in first.turn.joint.values][::-1]
    for column, k in enumerate(joints):
        axis: Any = figure.add_subplot(2, 3, column + 1, projection="3d")
        q = first.turn.sel(joint=k).q.values
        draw_arm(axis, first.robot, q, k, first.turn.attrs["direction"], ellipsoid=False)
        same_view(axis)
        axis.set_zlabel("")  # no room for it beside the next arm
        axis.set_title(f"joint {k} at the object", fontsize="medium", color=colour_of(k))
    graphs = [figure.add_subplot(2, 3, 4 + i) for i in range(3)]
    for name, (style, _) in ARMS.items():
        turn = arms[name].turn
        assert turn is not None
        _draw_graphs(graphs, turn, joints, style, labelled=name == "iiwa14_bullet")
    for axis, (_, label) in zip(graphs, PANELS, strict=True):
        axis.set(xlabel="angle of the hitting joint (deg)", ylabel=label)
        axis.set_xticks(range(-180, 181, 90))
        _finish(axis)
    for style, said in ARMS.values():
        graphs[0].plot([], [], color="grey", linestyle=style, label=said)
    handles = graphs[0].get_legend_handles_labels()
    figure.legend(*handles, loc="outside lower center", ncols=6, frameon=False)
    figure.suptitle("Fig. 2: the hitting joint turns; object of 2 kg", fontsize="medium")
    return figure


def _draw_graphs(
    graphs: list[Axes], turn: Dataset, joints: list[int], style: str, labelled: bool
) -> None:
    for axis, (quantity, _) in zip(graphs, PANELS, strict=True):
        for k in joints:
            row = turn.sel(joint=k)
            label = f"joint {k}" if labelled else None
            axis.plot(
                np.degrees(row.angle), row[quantity], style, color=colour_of(k), lw=1.5, label=label
            )


def _draw_references(on: Experiments) -> Figure:
    """Return Fig. 4: desired and achieved inertia, a column per reference, speed and flux below."""
    from matplotlib.figure import Figure

    assert on.references is not None
    figure = Figure(figsize=(10, 8), layout="constrained")
    axes = figure.subplots(3, 2, sharex=True, sharey="row")
    titles = {"constant": "constant reference", "optimised": "reference of Eq. 13"}
    for (k, reference), hit in on.references.items():
        column = axes[:, list(titles).index(reference)]
        column[0].set_title(titles[reference], fontsize="medium")
        for axis, (quantity, label) in zip(column, FOLLOWED, strict=True):
            axis.plot(*until_impact(hit, quantity), color=colour_of(k), lw=1.5, label=f"joint {k}")
            if quantity == "inertia":
                wanted = until_impact(hit, "desired_inertia")
                axis.plot(*wanted, "k--", lw=1, label="desired" if k == 6 else None)
            if quantity == "flux" and k == 6:
                axis.axhline(hit.hit.desired_flux, color="k", ls="--", lw=1)
            if reference == "constant":
                axis.set_ylabel(label)
        column[-1].set_xlabel("distance to the object (m)")
    for axis in axes.flat:
        _finish(axis)
    axes[0, 0].invert_xaxis()
    figure.legend(
        *axes[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=3, frameon=False
    )
    figure.suptitle(
        "Fig. 4: desired and achieved inertia along the motion, iiwa14_bullet", fontsize="medium"
    )
    return figure


def _finish(axis: Axes) -> None:
    """Set limits and grid when everything is drawn: zero is shown, and room above."""
    axis.set_ylim(0, 1.08 * axis.get_ylim()[1])
    axis.grid(alpha=0.3)
    axis.spines[["top", "right"]].set_visible(False)
