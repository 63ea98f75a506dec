"""Draw the spread of the paper's kilograms over random setups."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from hitjoints.evidence.paper.scenario import PRINTED, PRINTED_MORE
from hitjoints.show.sheet import NARROWEST, Sheet, sheet
from hitjoints.show.style import COLOURS, Look, colour_of

if TYPE_CHECKING:
    from collections.abc import Mapping

    from matplotlib.axes import Axes

    from hitjoints.evidence.paper.reproduction import Experiments
    from hitjoints.evidence.paper.spread import Spread

BINS = 50
SHOWN = 98.0
"""Per cent of the setups that the axes hold; the rest is a long tail."""
PHANTOM = "iiwa14_phantom"


def draw_spread(arms: Mapping[str, Experiments], look: Look) -> Sheet:
    """Return histograms of the inertia at the impact with joints 7 and 6, and of their ratio.

    Beside them what joint 7's depends on.
    """
    spreads = {name: on.spread for name, on in arms.items() if on.spread is not None}
    ours = {name: on.hits for name, on in arms.items()}["iiwa14_bullet"]
    assert ours is not None
    impacts = {k: ours.shown(k).impact for k in PRINTED}
    here = {k: impact.inertia for k, impact in impacts.items() if impact is not None}
    figure, axes = sheet(look, 4, 2, (5.5, 4.0), NARROWEST)
    for axis, k in zip(axes, PRINTED, strict=False):
        values = {name: spread.inertia[k] for name, spread in spreads.items()}
        _draw_histogram(axis, values, PRINTED[k], here[k], colour_of(k))
        axis.set_xlabel(f"joint {k}: inertia at the impact (kg)")
    more = {name: spread.more for name, spread in spreads.items()}
    _draw_histogram(axes[2], more, PRINTED_MORE, (here[6] / here[7] - 1) * 100, COLOURS[3])
    axes[2].set_xlabel("joint 6 more than joint 7 (%)")
    for axis in axes[:3]:
        axis.set_ylabel("share of the setups (%)")
    _draw_angles(axes[3], spreads["iiwa14_bullet"])
    count = len(spreads["iiwa14_bullet"].start)
    figure.headline(f"{count} random setups on iiwa14_bullet")
    return figure


def _draw_angles(axis: Axes, spread: Spread) -> None:
    """Draw what joint 7's inertia hangs on."""
    inertia = spread.inertia[7]
    axis.plot(spread.angle, inertia, "o", color=colour_of(7), ms=3, alpha=0.5, mew=0)
    axis.axhline(PRINTED[7], color="k", lw=1.5, label=f"paper, {PRINTED[7]:g} kg")
    axis.set_ylim(0, 1.05 * np.percentile(inertia, SHOWN))
    axis.set_xticks(range(0, 91, 15))
    axis.set_xlabel("joint 7: angle of its last link to the direction at the impact (deg)")
    axis.set_ylabel("joint 7: inertia at the impact (kg)")
    axis.legend()


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
    axis.set_title(f"{(bullet < printed).mean() * 100:.0f} % below the paper's")
    axis.legend()
