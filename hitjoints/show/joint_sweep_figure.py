"""Draw a joint sweep: three panels, as the paper's Fig. 2."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from hitjoints.show.joint_curves import broad, curve_of, set_quarters
from hitjoints.show.sheet import Sheet, sheet
from hitjoints.show.style import Look

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from xarray import Dataset

PANELS = {
    "inertia": r"directional inertia $\lambda_h$ (kg)",
    "speed": r"hitting speed $\dot\chi_{\max}$ (m/s)",
    "flux": r"hitting flux $\phi_{\max}$ (m/s)",
}


def draw_joint_sweep(sweep: Dataset, look: Look) -> Sheet:
    """Return the figure of a `sweep_joint` data set: inertia, speed and flux by joint angle.

    Full lines are the maxima of Eq. 9; dashed ones those of a motion exactly along the direction.
    """
    from matplotlib.lines import Line2D

    figure, axes = sheet(look, len(PANELS), 3, (3.7, 3.7))
    for axis, name in zip(axes, PANELS, strict=True):
        draw_over_angle(axis, sweep, name)
    handles = list(axes[0].lines)
    handles.append(Line2D([], [], color="grey", label="any motion"))
    handles.append(Line2D([], [], color="grey", ls="--", lw=1, label="straight along $h$"))
    figure.key(handles)
    figure.headline(_title(sweep))
    return figure


def draw_over_angle(axis: Axes, sweep: Dataset, name: str) -> None:
    """Draw inertia, speed or flux by joint angle, no curve hidden by another."""
    joints = [int(k) for k in sweep.joint.values[sweep.reachable.values]]
    for place, k in enumerate(joints):
        row, style = sweep.sel(joint=k), curve_of(k)
        angle, width = np.degrees(row.angle), broad(place, len(joints))
        axis.plot(angle, row[name], lw=width, **style, label=f"joint {k}")
        if name != "inertia":
            axis.plot(angle, row[f"straight_{name}"], ls="--", **style | {"lw": 1, "mfc": "white"})
    axis.set(xlabel="angle of the hitting joint (deg)", ylabel=PANELS[name])
    axis.set_ylim(bottom=0)
    set_quarters(axis)
    axis.grid(visible=True)


def _title(sweep: Dataset) -> str:
    words = {
        name: ", ".join(f"{value:g}" for value in np.atleast_1d(sweep.attrs[name]))
        for name in ("position", "direction", "mass")
    }
    missing = sweep.joint.values[~sweep.reachable.values]
    note = f"; out of reach for joint {', '.join(map(str, missing))}" if missing.size else ""
    return (
        f"{sweep.attrs['robot']}: object of {words['mass']} kg at ({words['position']}) m, "
        f"hit along ({words['direction']}){note}"
    )
