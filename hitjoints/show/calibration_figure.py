"""Draw a calibration: landings foreseen from all others, and what is left."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from hitjoints.show.sheet import Sheet, sheet
from hitjoints.show.style import COLOURS, MARKS, Look

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from hitjoints.evidence.calibration.past_hits import Calibration


def draw_calibration(result: Calibration, look: Look) -> Sheet:
    """Return the figure: measured against foreseen with intervals, and the residuals by flux."""
    figure, (judged, left) = sheet(look, 2, 2, (5.0, 4.4))
    held = result.held_out
    if held is None:
        figure.suptitle("too few landings to foresee one from the others")
        return figure
    draw_foreseen(judged, result)
    _draw_residuals(left, result)
    figure.headline(
        f"{held.held} of {held.rows} within 90 % intervals of {held.width:.2f} m; mean error "
        f"{1e3 * held.error:.0f} mm, of distance = c flux^2 {1e3 * held.baseline_error:.0f} mm"
    )
    return figure


def draw_foreseen(axis: Axes, result: Calibration) -> None:
    """Draw each landing against what all the others foresee of it, with its interval of 90 %."""
    for i, arm in enumerate(_arms(result)):
        distance, told = _of_arm(result, arm)[1:]
        middle, low, high = told
        axis.errorbar(middle, distance, xerr=(middle - low, high - middle), **_style(i), label=arm)
    ends = np.array([row.distance for row, _ in result.foreseen])
    span = [0.0, 1.1 * float(ends.max(initial=0.0))]
    axis.plot(span, span, color="grey", lw=1, zorder=0)
    axis.set(xlabel="distance foreseen from all other hits (m)", ylabel="distance measured (m)")
    axis.legend(title="arm")


def _draw_residuals(axis: Axes, result: Calibration) -> None:
    for i, arm in enumerate(_arms(result)):
        flux, distance, (middle, low, high) = _of_arm(result, arm)
        axis.errorbar(flux, distance - middle, yerr=(middle - low, high - middle), **_style(i))
    axis.axhline(0, color="grey", lw=1, zorder=0)
    axis.set(xlabel="flux (m/s)", ylabel="measured less foreseen (m)")


def _arms(result: Calibration) -> list[str]:
    return sorted({row.arm for row, _ in result.foreseen})[: len(COLOURS)]


def _of_arm(result: Calibration, arm: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return flux, distance, and the middle and ends of what was foreseen, (3, N)."""
    pairs = [(row, told) for row, told in result.foreseen if row.arm == arm]
    flux = np.array([row.flux for row, _ in pairs])
    distance = np.array([row.distance for row, _ in pairs])
    return flux, distance, np.array([told for _, told in pairs]).T


def _style(place: int) -> dict[str, Any]:
    return {
        "color": COLOURS[place], "fmt": MARKS[place], "ms": 3.5, "lw": 0.7, "alpha": 0.75
    }  # fmt: skip
