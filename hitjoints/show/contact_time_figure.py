"""Draw what each joint shows in a hit, by the length of the contact."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hitjoints.maps.contact_time_sweep import crossings
from hitjoints.show.joint_curves import curve_of
from hitjoints.show.sheet import Sheet, sheet
from hitjoints.show.style import Look, colour_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from xarray import Dataset

PANELS = {
    "equivalent": "inertia that the hit shows (kg)",
    "object_speed": "speed of the object (m/s)",
}


def draw_contact_time_sweep(swept: Dataset, look: Look) -> Sheet:
    """Return the figure: shown inertia and object speed, a line for each joint, crossings marked.

    Marks at the left edge are the links alone, at the right edge with rotors.
    """
    figure, axes = sheet(look, 2, 2, (5.0, 4.2))
    for axis, variable in zip(axes, PANELS, strict=True):
        draw_over_contact_time(axis, swept, variable)
    figure.key(axes[0].get_legend_handles_labels()[0])
    place = ", ".join(f"{value:g}" for value in swept.attrs["position"])
    along = ", ".join(f"{value:g}" for value in swept.attrs["direction"])
    figure.headline(
        f"{swept.attrs['robot']}: {swept.attrs['mass']:g} kg at ({place}) m, hit along ({along}), "
        f"restitution {swept.attrs['restitution']:g}, each joint at its greatest straight speed"
    )
    return figure


def draw_over_contact_time(axis: Axes, swept: Dataset, variable: str) -> None:
    """Draw "equivalent" or "object_speed" by contact time."""
    _draw(axis, swept, variable)
    axis.set(xscale="log", xlabel="contact time of the rigid pair (ms)", ylabel=PANELS[variable])
    axis.xaxis.set_major_formatter("{x:g}")
    axis.grid(visible=True)
    if variable == "equivalent":
        axis.set_yscale("log")
        axis.yaxis.set_major_formatter("{x:g}")
        axis.yaxis.set_minor_formatter("{x:g}")
        axis.tick_params(which="minor", labelsize="small")
        _draw_limits(axis, swept)
    else:
        axis.set_ylim(bottom=0)


def _draw(axis: Axes, swept: Dataset, variable: str) -> None:
    time = 1e3 * swept.time.values
    for joint in swept.joint.values:
        values = swept[variable].sel(joint=joint)
        axis.plot(time, values, **curve_of(int(joint)), label=f"joint {joint}")
    for i, cross in enumerate(crossings(swept, variable)):
        axis.plot(1e3 * cross.time, cross.value, "o", ms=7, mfc="none", color="black")
        beside = (-14, 10) if i % 2 else (4, -14)
        axis.annotate(
            f"{1e3 * cross.time:.3g} ms", (1e3 * cross.time, cross.value), beside,
            textcoords="offset points", fontsize="small",
        )  # fmt: skip


def _draw_limits(axis: Axes, swept: Dataset) -> None:
    first, last = 1e3 * swept.time.values[[0, -1]]
    for joint in swept.joint.values:
        row, colour = swept.sel(joint=joint), colour_of(int(joint))
        axis.plot(first, float(row.rigid), "<", color=colour, ms=6)
        axis.plot(last, float(row.rotor), ">", color=colour, ms=6)
    axis.plot([], [], "<", color="grey", label="links alone (left edge)")
    axis.plot([], [], ">", color="grey", label="with rotors (right edge)")
