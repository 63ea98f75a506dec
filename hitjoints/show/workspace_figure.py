"""Draw a workspace map: a slice per joint of inertia and flux, and which joint hits best."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from hitjoints.dynamics.kinematics import position
from hitjoints.errors import InputError
from hitjoints.maps.map_kinds import MOTION, WORKSPACE, kind_of
from hitjoints.maps.workspace import best_joint
from hitjoints.model.robot import Contact
from hitjoints.show.figures import colour_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from xarray import Dataset

    from hitjoints.model.robot import Robot

PANELS = {
    WORKSPACE.name: (
        ("inertia_median", r"median inertia $\lambda_h$ (kg)", "viridis", "heaviest"),
        ("flux", r"greatest flux $\phi_{\max}$ (m/s)", "inferno", "hits hardest"),
    ),
    MOTION.name: (
        ("inertia", r"inertia at the impact $\lambda_h$ (kg)", "viridis", "heaviest"),
        ("flux", r"delivered flux $\phi$ (m/s)", "inferno", "hits hardest"),
    ),
}
"""Of each kind of map: variable, label, colours, and what the joint of the greatest is."""
UNREACHABLE = "#d9d9d9"


def draw_workspace(robot: Robot, swept: Dataset, direction: int = 0) -> Figure:
    """Return the figure of a map, of what is possible or of motions, for one of its directions.

    A map of one layer is drawn as it is; of a thicker one, the middle layer of the axis with the
    fewest coordinates. Hatched grey is out of reach; the line is the arm at home.

    Raises:
        InputError: the map is no plane: fewer than two axes have two coordinates or more.
    """
    from matplotlib.figure import Figure

    layer, across, up = _plane(swept)
    middle = swept.sizes[layer] // 2
    cut = swept.isel({layer: middle, "direction": direction})
    joints = [int(k) for k in swept.joint.values]
    columns = len(joints) + 1
    aspect = float(np.ptp(swept[up].values) / np.ptp(swept[across].values))
    size = (3.1 * columns + 1, 5.4 * min(max(aspect, 0.4), 2.2) + 1.3)
    figure = Figure(figsize=size, layout="constrained")
    axes = figure.subplots(2, columns, sharex=True, sharey=True)
    kind = kind_of(swept.attrs)
    for row, (name, label, colours, praise) in zip(axes, PANELS[kind.name], strict=True):
        scale, ends = _shared_scale(name, cut[name].values)
        for axis, k in zip(row, joints, strict=False):
            values = cut[name].sel(joint=k).transpose(up, across)
            drawn = _shade(axis, cut, (across, up), values, cmap=colours, **scale)
            axis.set_title(f"joint {k}")
        figure.colorbar(
            drawn, ax=row[: len(joints)], label=label, shrink=0.9, format="{x:g}", **ends
        )
        _shade_joints(row[-1], cut, (across, up), best_joint(cut, name).transpose(up, across))
        row[-1].set_title(praise)
    _legend(figure, joints, "no motion hits" if kind is MOTION else "out of reach")
    for axis in axes.flat:
        _draw_arm(axis, robot, ("xyz".index(across), "xyz".index(up)))
        axis.set(xlim=_span(cut[across]), ylim=_span(cut[up]), aspect="equal")
    for axis in axes[-1]:
        axis.set_xlabel(f"{across} (m)")
    for axis in axes[:, 0]:
        axis.set_ylabel(f"{up} (m)")
    h = ", ".join(f"{v:.3g}" for v in swept.direction_vector.values[direction])
    what = ("tries", "motions") if kind is MOTION else ("samples", "configurations")
    figure.suptitle(
        f"{swept.attrs['robot']}: object of {swept.attrs['mass']:g} kg hit along ({h}), "
        f"{layer} = {float(swept[layer][middle]):.3g} m, "
        f"{swept.attrs[what[0]]} {what[1]} per position",
        fontsize="medium",
    )
    return figure


def _plane(swept: Dataset) -> tuple[str, str, str]:
    """Return the axis that is cut, and the two that span the picture."""
    layer = min("zyx", key=lambda name: int(swept.sizes[name]))
    across, up = (name for name in "xyz" if name != layer)
    if min(swept.sizes[across], swept.sizes[up]) < 2:
        raise InputError(
            "plot", f"{dict(swept.sizes)}", "a picture needs two axes of 2 coordinates or more"
        )
    return layer, across, up


def _shared_scale(name: str, values: Any) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return colour limits shared by all joints, and the colour bar's ends and ticks.

    A few extreme values saturate.

    Inertia spans a decade from the last joint to the elbow side, so its scale is logarithmic.
    """
    from matplotlib.colors import LogNorm, Normalize

    finite = values[np.isfinite(values) & (values > 0)]
    low, high = np.percentile(finite, (1, 98)) if finite.size else (0.1, 1.0)
    if name.startswith("inertia"):
        ticks = [tick for tick in (0.5, 1, 2, 3, 5, 10, 20, 30, 50, 100) if low < tick < high]
        return {"norm": LogNorm(low, max(high, 1.01 * low))}, {"extend": "both", "ticks": ticks}
    return {"norm": Normalize(0.0, high)}, {"extend": "max"}


def _shade(axis: Any, cut: Dataset, plane: tuple[str, str], values: Any, **options: Any) -> Any:
    axis.set_facecolor(UNREACHABLE)
    axis.patch.set(hatch="////", edgecolor="white")
    shown = np.ma.masked_invalid(values.values)
    return axis.pcolormesh(cut[plane[0]], cut[plane[1]], shown, shading="nearest", **options)


def _shade_joints(axis: Any, cut: Dataset, plane: tuple[str, str], values: Any) -> None:
    from matplotlib.colors import BoundaryNorm, ListedColormap

    ordered = sorted(int(k) for k in cut.joint.values)
    edges = [ordered[0] - 0.5, *(k + 0.5 for k in ordered)]
    colours = ListedColormap([colour_of(k) for k in ordered])
    _shade(axis, cut, plane, values, cmap=colours, norm=BoundaryNorm(edges, len(ordered)))


def _legend(figure: Figure, joints: list[int], absent: str) -> None:
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    handles: list[Any] = [Patch(color=colour_of(k), label=f"joint {k}") for k in joints]
    handles.append(Patch(facecolor=UNREACHABLE, hatch="////", edgecolor="white", label=absent))
    handles.append(Line2D([], [], color="black", marker="s", label="arm at home"))
    figure.legend(handles=handles, loc="outside lower center", ncols=len(handles), frameon=False)


def _draw_arm(axis: Any, robot: Robot, plane: tuple[int, int]) -> None:
    contacts = [*(Contact(k) for k in range(1, robot.n + 1)), robot.flange]
    points = [np.zeros(3), *(position(robot, robot.home, c) for c in contacts)]
    line = np.array(points)[:, plane]
    axis.plot(*line.T, color="white", linewidth=3.5, solid_capstyle="round")
    axis.plot(*line.T, color="black", linewidth=1.5, marker="o", markersize=2.5)
    axis.plot(*line[0], color="black", marker="s", markersize=8)


def _span(coordinate: Any) -> tuple[float, float]:
    """Return limits that show whole cells."""
    values = coordinate.values
    half = float(np.diff(values).min()) / 2
    return float(values[0]) - half, float(values[-1]) + half
