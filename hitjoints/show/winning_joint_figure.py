"""Draw the map of the joint whose hit shows most inertia, one panel for each contact time."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hitjoints.show.sheet import NARROW, Sheet, sheet
from hitjoints.show.style import Look, colour_of
from hitjoints.show.winner_map import STRIPES, TIES, draw_winners, winners

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from xarray import Dataset


def draw_winning_joint(found: Dataset, look: Look) -> Sheet:
    """Return the figure of a `winning_joint` data set: white where no joint hits."""
    from matplotlib.patches import Patch

    count = found.time.size
    figure, axes = sheet(look, count, count, (3.4, 3.9), NARROW)
    joints = [int(joint) for joint in found.joint.values]
    for axis, time in zip(axes, found.time.values, strict=True):
        draw_winning_joint_at(axis, found, float(time))
    handles = [Patch(color=colour_of(joint), label=f"joint {joint}") for joint in joints]
    figure.key([*handles, Patch(fc="white", ec="grey", hatch=STRIPES, label=TIES)])
    along = ", ".join(f"{value:g}" for value in found.attrs["direction"])
    figure.headline(
        f"{found.attrs['robot']}: the joint whose hit on {found.attrs['mass']:g} kg at "
        f"z = {found.attrs['z']:g} m along ({along}) shows most inertia, by contact time"
    )
    return figure


def draw_winning_joint_at(axis: Axes, found: Dataset, time: float) -> None:
    """Draw the map for one contact time (s)."""
    joints = [int(joint) for joint in found.joint.values]
    shown = found.equivalent.sel(time=time).transpose("joint", "y", "x").values
    draw_winners(axis, found.x.values, found.y.values, shown, joints)
    first, second = winners(shown)
    hit = first >= 0
    alone = [100 * ((first == i) & (second == i))[hit].mean() for i in range(len(joints))]
    tied = 100 * (first != second)[hit].mean()
    shares = [f"{joint}: {share:.0f} %" for joint, share in zip(joints, alone, strict=True)]
    if tied >= 0.5:
        shares.append(f"tied: {tied:.0f} %")
    axis.set(xlabel="x (m)", ylabel="y (m)", aspect="equal")
    axis.set_title(f"{1e3 * time:g} ms\n{'  '.join(shares)}", fontsize="small")
    axis.spines[["top", "right"]].set_visible(True)
    axis.label_outer()
