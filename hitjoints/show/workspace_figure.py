"""Draw a workspace map: a slice per joint of inertia and flux, and which joint hits best."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from hitjoints.errors import InputError
from hitjoints.maps.map_kinds import MOTION, WORKSPACE, kind_of
from hitjoints.show.drawn_arm import chain
from hitjoints.show.sheet import Sheet, fitted
from hitjoints.show.style import Look, colour_of
from hitjoints.show.winner_map import STRIPES, TIES, draw_winners

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from xarray import Dataset

    from hitjoints.model.robot import Robot

PANELS = {
    WORKSPACE.name: {
        "inertia_median": (r"median inertia $\lambda_h$ (kg)", "viridis", "heaviest"),
        "flux": (r"greatest flux $\phi_{\max}$ (m/s)", "inferno", "hits hardest"),
    },
    MOTION.name: {
        "inertia": (r"inertia at the impact $\lambda_h$ (kg)", "viridis", "heaviest"),
        "flux": (r"delivered flux $\phi$ (m/s)", "inferno", "hits hardest"),
    },
}
"""Of each kind of map: variables, their label, colours, and what the joint of the most is."""
UNREACHABLE = "#d9d9d9"
TICKS = (0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 3, 5, 7, 10, 15, 20, 30, 50, 100, 200)


def draw_workspace(robot: Robot, swept: Dataset, look: Look, direction: int = 0) -> Sheet:
    """Return the figure of a map, of what is possible or of motions, for one of its directions.

    A map of one layer is drawn as it is; of a thicker one, the middle layer of the axis with the
    fewest coordinates. Hatched grey is out of reach; the line is the arm at home.

    Raises:
        InputError: the map is no plane: fewer than two axes have two coordinates or more.
    """
    layer, across, up = _plane(swept)
    joints = [int(k) for k in swept.joint.values]
    aspect = min(max(float(np.ptp(swept[up].values) / np.ptp(swept[across].values)), 0.4), 2.2)
    panels = len(joints) + 1
    columns, _, size = fitted(look, 2 * panels, panels, (3.1, 2.7 * aspect + 0.6))
    wide = columns == panels
    if not wide and look.inches is not None and look.inches[1] is None:
        size = size[0], size[0] / 2 * (aspect + 0.05) * panels + 1.0
    figure = Sheet(look, figsize=size)
    grid = figure.subplots(*((2, panels) if wide else (panels, 2)), sharex=True, sharey=True)
    kind = kind_of(swept.attrs)
    for row, name in zip(grid if wide else grid.T, PANELS[kind.name], strict=True):
        _draw_row(figure, row, swept, name, direction, wide)
    for axis in grid.flat:
        _draw_arm(axis, robot, ("xyz".index(across), "xyz".index(up)))
        axis.label_outer()
    _legend(figure, joints, "no motion hits" if kind is MOTION else "out of reach")
    h = ", ".join(f"{v:.3g}" for v in swept.direction_vector.values[direction])
    middle = swept.sizes[layer] // 2
    tried = "motions" if kind is MOTION else "configurations"
    figure.headline(
        f"{swept.attrs['robot']}: object of {swept.attrs['mass']:g} kg hit along ({h}), "
        f"{layer} = {float(swept[layer][middle]):.3g} m, "
        f"{swept.attrs['tries' if kind is MOTION else 'samples']} {tried} per position"
    )
    return figure


def _draw_row(
    figure: Sheet, row: Any, swept: Dataset, name: str, direction: int, wide: bool
) -> None:
    """Draw a quantity of each joint, with one scale, and the joint that has most of it."""
    label = _panel(swept, name)[0]
    joints = [int(k) for k in swept.joint.values]
    for axis, k in zip(row, joints, strict=False):
        drawn, ends = draw_quantity(axis, swept, name, k, direction)
    bar = figure.colorbar(
        drawn, ax=row[: len(joints)], label=label, shrink=0.9, format="{x:g}",
        location="right" if wide else "top", aspect=20 if wide else 12, **ends,
    )  # fmt: skip
    bar.ax.minorticks_off()
    draw_best(row[-1], swept, name, direction)


def draw_quantity(
    axis: Axes, swept: Dataset, name: str, joint: int, direction: int = 0
) -> tuple[Any, dict[str, Any]]:
    """Draw a quantity of `PANELS` of a joint, on a scale that all joints share.

    Returns:
        what is drawn, for a colour bar; the bar's ends and ticks.
    """
    cut, across, up = _cut(swept, direction)
    scale, ends = _shared_scale(name, cut[name].values)
    values = cut[name].sel(joint=joint).transpose(up, across)
    _frame(axis, cut, across, up)
    drawn = axis.pcolormesh(
        cut[across], cut[up], np.ma.masked_invalid(values.values), shading="nearest",
        cmap=_panel(swept, name)[1], rasterized=True, **scale,
    )  # fmt: skip
    axis.set_title(f"joint {joint}")
    return drawn, ends


def draw_best(axis: Axes, swept: Dataset, name: str = "flux", direction: int = 0) -> None:
    """Draw which joint has most of a quantity, and where two tie."""
    cut, across, up = _cut(swept, direction)
    _frame(axis, cut, across, up)
    values = cut[name].transpose("joint", up, across).values
    joints = [int(k) for k in swept.joint.values]
    draw_winners(axis, cut[across].values, cut[up].values, values, joints)
    axis.set_title(_panel(swept, name)[2])


def _panel(swept: Dataset, name: str) -> tuple[str, str, str]:
    return PANELS[kind_of(swept.attrs).name][name]


def _cut(swept: Dataset, direction: int) -> tuple[Dataset, str, str]:
    """Return the layer that is drawn, and the axes of the picture."""
    layer, across, up = _plane(swept)
    return swept.isel({layer: swept.sizes[layer] // 2, "direction": direction}), across, up


def _frame(axis: Axes, cut: Dataset, across: str, up: str) -> None:
    axis.set_facecolor(UNREACHABLE)
    axis.patch.set(hatch="////", edgecolor="white")
    axis.set(xlim=_span(cut[across]), ylim=_span(cut[up]), aspect="equal")
    axis.set(xlabel=f"{across} (m)", ylabel=f"{up} (m)")
    axis.spines[["top", "right"]].set_visible(True)


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
        ticks = [tick for tick in TICKS if low <= tick <= high]
        return {"norm": LogNorm(low, max(high, 1.01 * low))}, {"extend": "both", "ticks": ticks}
    return {"norm": Normalize(0.0, high)}, {"extend": "max"}


def _legend(figure: Sheet, joints: list[int], absent: str) -> None:
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    handles: list[Any] = [Patch(color=colour_of(k), label=f"joint {k}") for k in joints]
    handles.append(Patch(facecolor="white", edgecolor="grey", hatch=STRIPES, label=TIES))
    handles.append(Patch(facecolor=UNREACHABLE, hatch="////", edgecolor="white", label=absent))
    handles.append(Line2D([], [], color="black", marker="s", label="arm at home"))
    figure.key(handles)


def _draw_arm(axis: Any, robot: Robot, plane: tuple[int, int]) -> None:
    line = chain(robot, robot.home)[:, plane]
    axis.plot(*line.T, color="white", linewidth=3.5, solid_capstyle="round")
    axis.plot(*line.T, color="black", linewidth=1.5, marker="o", markersize=2.5)
    axis.plot(*line[0], color="black", marker="s", markersize=6)


def _span(coordinate: Any) -> tuple[float, float]:
    """Return limits that show whole cells."""
    values = coordinate.values
    half = float(np.diff(values).min()) / 2
    return float(values[0]) - half, float(values[-1]) + half
