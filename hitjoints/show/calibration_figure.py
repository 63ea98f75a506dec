"""Draw a calibration: landings foreseen from all others, and what is left."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from hitjoints.show.figures import COLOURS

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from hitjoints.evidence.calibration.past_hits import Calibration


def draw_calibration(result: Calibration) -> Figure:
    """Return the figure: measured against foreseen with intervals, and the residuals by flux."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(10, 4.6), layout="constrained")
    judged, left = figure.subplots(1, 2)
    arms = sorted({row.arm for row, _ in result.foreseen})
    for arm, colour in zip(arms, COLOURS, strict=False):
        _draw_arm(judged, left, result, arm, colour)
    held = result.held_out
    if held is None:
        figure.suptitle("too few landings to foresee one from the others", fontsize="medium")
        return figure
    ends = np.array([row.distance for row, _ in result.foreseen])
    span = [0.0, 1.1 * float(ends.max())]
    judged.plot(span, span, color="grey", lw=1, zorder=0)
    judged.set(xlabel="distance foreseen from all other hits (m)", ylabel="distance measured (m)")
    left.axhline(0, color="grey", lw=1, zorder=0)
    left.set(xlabel="flux (m/s)", ylabel="measured less foreseen (m)")
    judged.legend(frameon=False, title="arm")
    for axis in (judged, left):
        axis.spines[["top", "right"]].set_visible(False)
    figure.suptitle(
        f"{held.held} of {held.rows} within 90 % intervals of {held.width:.2f} m; mean error "
        f"{1e3 * held.error:.0f} mm, of distance = c flux^2 {1e3 * held.baseline_error:.0f} mm",
        fontsize="medium",
    )
    return figure


def _draw_arm(judged: Axes, left: Axes, result: Calibration, arm: str, colour: str) -> None:
    pairs = [(row, told) for row, told in result.foreseen if row.arm == arm]
    flux = np.array([row.flux for row, _ in pairs])
    distance = np.array([row.distance for row, _ in pairs])
    middle, low, high = np.array([told for _, told in pairs]).T
    judged.errorbar(
        middle, distance, xerr=(middle - low, high - middle), fmt="o", ms=3.5, lw=0.7,
        color=colour, alpha=0.75, label=arm,
    )  # fmt: skip
    left.errorbar(
        flux, distance - middle, yerr=(middle - low, high - middle), fmt="o", ms=3.5, lw=0.7,
        color=colour, alpha=0.75,
    )  # fmt: skip
