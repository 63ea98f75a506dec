"""Draw the spread of the paper's kilograms over random setups."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from hitjoints.evidence.paper.scenario import PRINTED, PRINTED_MORE
from hitjoints.show.figures import COLOURS, colour_of

if TYPE_CHECKING:
    from collections.abc import Mapping

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from hitjoints.evidence.paper.reproduce import Experiments

BINS = 50
SHOWN = 98.0
"""Per cent of the setups that the axes hold; the rest is a long tail."""
PHANTOM = "iiwa14_phantom"


def draw_spread(arms: Mapping[str, Experiments]) -> Figure:
    """Return histograms of the inertia at the impact with joints 7 and 6, and of their ratio."""
    from matplotlib.figure import Figure

    spreads = {name: on.spread for name, on in arms.items() if on.spread is not None}
    ours = {name: on.hits for name, on in arms.items()}["iiwa14_bullet"]
    assert ours is not None
    impacts = {k: ours.shown(k).impact for k in PRINTED}
    here = {k: impact.inertia for k, impact in impacts.items() if impact is not None}
    figure = Figure(figsize=(13, 4.6), layout="constrained")
    axes = figure.subplots(1, 3)
    for axis, k in zip(axes, PRINTED, strict=False):
        values = {name: spread.inertia[k] for name, spread in spreads.items()}
        _draw_histogram(axis, values, PRINTED[k], here[k], colour_of(k))
        axis.set_xlabel(f"joint {k}: inertia at the impact (kg)")
    more = {name: spread.more for name, spread in spreads.items()}
    _draw_histogram(axes[2], more, PRINTED_MORE, (here[6] / here[7] - 1) * 100, COLOURS[3])
    axes[2].set_xlabel("joint 6 more than joint 7 (%)")
    axes[0].set_ylabel("share of the setups (%)")
    count = len(spreads["iiwa14_bullet"].start)
    figure.suptitle(f"{count} random setups on iiwa14_bullet", fontsize="medium")
    return figure


def _draw_histogram(
    axis: Axes, values: Mapping[str, np.ndarray], printed: float, ours: float, colour: str
) -> None:
    bullet, phantom = values["iiwa14_bullet"], values[PHANTOM]
    both = np.concatenate([bullet, phantom])
    edges = np.linspace(both.min(), np.percentile(both, SHOWN), BINS + 1).tolist()
    shares = [np.full(len(v), 100 / len(v)) for v in (bullet, phantom)]
    axis.hist(bullet, edges, weights=shares[0], color=colour, alpha=0.6, label="iiwa14_bullet")
    axis.hist(
        phantom, edges, weights=shares[1], histtype="step", color="grey", label="with the phantom"
    )
    axis.axvline(printed, color="k", lw=1.5, label=f"paper, {printed:g}")
    axis.axvline(ours, color="k", ls="--", lw=1.2, label=f"fig6, {ours:.3g}")
    axis.set_title(f"{(bullet < printed).mean() * 100:.0f} % below the paper's", fontsize="medium")
    axis.spines[["top", "right"]].set_visible(False)
    axis.legend(frameon=False)
