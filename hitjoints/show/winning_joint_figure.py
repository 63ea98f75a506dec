"""Draw the map of the joint whose hit shows most inertia, one panel for each contact time."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from hitjoints.show.figures import colour_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from xarray import Dataset


def draw_winning_joint(found: Dataset) -> Figure:
    """Return the figure of a `winning_joint` data set: white where no joint hits."""
    from matplotlib.colors import BoundaryNorm, ListedColormap
    from matplotlib.figure import Figure
    from matplotlib.patches import Patch

    joints = [int(joint) for joint in found.joint.values]
    figure = Figure(figsize=(3.4 * found.time.size + 0.4, 4.7), layout="constrained")
    axes = np.atleast_1d(figure.subplots(1, found.time.size, sharey=True))
    colours = ListedColormap([colour_of(joint) for joint in joints])
    norm = BoundaryNorm(np.arange(len(joints) + 1) - 0.5, len(joints))
    for axis, time in zip(axes, found.time.values, strict=True):
        shown = found.equivalent.sel(time=time).transpose("joint", "y", "x").values
        hit = ~np.isnan(shown).all(axis=0)
        best = np.argmax(np.where(np.isnan(shown), -1.0, shown), axis=0)
        axis.pcolormesh(
            found.x.values, found.y.values, np.ma.masked_array(best, ~hit),
            cmap=colours, norm=norm, shading="nearest",
        )  # fmt: skip
        part = [100 * (best[hit] == i).mean() for i in range(len(joints))]
        shares = [f"{joint}: {share:.0f} %" for joint, share in zip(joints, part, strict=True)]
        axis.set(xlabel="x (m)", aspect="equal")
        axis.set_title(f"{1e3 * time:g} ms\n{'   '.join(shares)}", fontsize="medium")
    axes[0].set_ylabel("y (m)")
    handles = [Patch(color=colour_of(joint), label=f"joint {joint}") for joint in joints]
    figure.legend(handles=handles, loc="outside lower center", ncols=len(joints), frameon=False)
    along = ", ".join(f"{value:g}" for value in found.attrs["direction"])
    figure.suptitle(
        f"{found.attrs['robot']}: the joint whose hit on {found.attrs['mass']:g} kg at "
        f"z = {found.attrs['z']:g} m along ({along}) shows most inertia, by contact time",
        fontsize="medium",
    )
    return figure
