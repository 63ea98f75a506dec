"""Draw a joint sweep: three panels, as the paper's Fig. 2."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from hitjoints.show.figures import colour_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from xarray import Dataset

PANELS = (
    ("inertia", r"directional inertia $\lambda_h$ (kg)"),
    ("speed", r"hitting speed $\dot\chi_{\max}$ (m/s)"),
    ("flux", r"hitting flux $\phi_{\max}$ (m/s)"),
)


def draw_joint_sweep(sweep: Dataset) -> Figure:
    """Return the figure of a `sweep_joint` data set: inertia, speed and flux by joint angle.

    Full lines are the maxima of Eq. 9; dashed ones those of a motion exactly along the direction.
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=(11, 3.9), layout="constrained")
    axes = figure.subplots(1, 3)
    for k in sweep.joint.values[sweep.reachable.values]:
        row, colour = sweep.sel(joint=k), colour_of(int(k))
        angle = np.degrees(row.angle)
        for axis, (name, _) in zip(axes, PANELS, strict=True):
            axis.plot(angle, row[name], color=colour, label=f"joint {k}")
            if name != "inertia":
                axis.plot(angle, row[f"straight_{name}"], color=colour, linestyle="--", linewidth=1)
    for axis, (_, label) in zip(axes, PANELS, strict=True):
        axis.set(xlabel="angle of the hitting joint (deg)", ylabel=label)
        axis.set_ylim(bottom=0)
        axis.set_xticks(range(-180, 181, 90))
        axis.grid(alpha=0.3)
        axis.spines[["top", "right"]].set_visible(False)
    axes[1].plot([], [], color="grey", label="any motion")
    axes[1].plot([], [], color="grey", linestyle="--", linewidth=1, label="straight along $h$")
    handles = [*axes[0].lines, *axes[1].lines[-2:]]
    figure.legend(handles=handles, loc="outside lower center", ncols=len(handles), frameon=False)
    figure.suptitle(_title(sweep), fontsize="medium")
    return figure


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
