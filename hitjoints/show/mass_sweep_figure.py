"""Draw a mass sweep: what each joint can do, and from which mass on another is the best."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hitjoints.show.figures import colour_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from xarray import Dataset


def draw_mass_sweep(sweep: Dataset) -> Figure:
    """Return the figure of a `sweep_mass` data set; dotted where the best joint changes."""
    from matplotlib.figure import Figure

    name = sweep.attrs["objective"].replace("-", "_")
    figure = Figure(figsize=(6.4, 4.2), layout="constrained")
    axis = figure.add_subplot()
    for k in sweep.joint.values:
        row = sweep[name].sel(joint=k)
        if bool(row.notnull().any()):
            colour = colour_of(int(k))
            axis.plot(sweep.mass, row, ".-", color=colour, label=f"joint {k}")
    for mass in sweep.crossing_mass.values if "crossing" in sweep.sizes else ():
        axis.axvline(mass, color="grey", linestyle=":")
        axis.text(mass, 0.02, f" {mass:.3g} kg", transform=axis.get_xaxis_transform())
    axis.set(xlabel="mass of the object (kg)", ylabel=f"greatest {name.replace('_', ' ')} (m/s)")
    axis.set_ylim(bottom=0)
    axis.grid(alpha=0.3)
    axis.spines[["top", "right"]].set_visible(False)
    axis.legend(frameon=False)
    return figure
