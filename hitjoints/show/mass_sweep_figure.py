"""Draw a mass sweep: what each joint can do, and from which mass on another is the best."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hitjoints.show.joint_curves import broad, curve_of
from hitjoints.show.sheet import Sheet, sheet
from hitjoints.show.style import Look

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from xarray import Dataset


def draw_mass_sweep(sweep: Dataset, look: Look) -> Sheet:
    """Return the figure of a `sweep_mass` data set; dotted where the best joint changes."""
    figure, (axis,) = sheet(look, 1, 1, (6.4, 4.2))
    draw_over_mass(axis, sweep)
    at, along = (", ".join(f"{v:g}" for v in sweep.attrs[n]) for n in ("position", "direction"))
    figure.headline(f"{sweep.attrs['robot']}: object at ({at}) m, hit along ({along})")
    return figure


def draw_over_mass(axis: Axes, sweep: Dataset) -> None:
    """Draw the greatest flux of every joint by the object's mass."""
    name = sweep.attrs["objective"].replace("-", "_")
    joints = [int(k) for k in sweep.joint.values if sweep[name].sel(joint=k).notnull().any()]
    for place, k in enumerate(joints):
        style = curve_of(k) | {"markevery": None, "lw": broad(place, len(joints))}
        axis.plot(sweep.mass, sweep[name].sel(joint=k), **style, label=f"joint {k}")
    for mass in sweep.crossing_mass.values if "crossing" in sweep.sizes else ():
        axis.axvline(mass, color="grey", linestyle=":")
        axis.text(mass, 0.02, f" {mass:.3g} kg", transform=axis.get_xaxis_transform())
    axis.set(xlabel="mass of the object (kg)", ylabel=f"greatest {name.replace('_', ' ')} (m/s)")
    axis.set_ylim(bottom=0)
    axis.grid(visible=True)
    axis.legend()
