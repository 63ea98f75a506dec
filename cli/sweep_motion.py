"""`hitjoints sweep motion`: maps of the flux that motions really deliver."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

import typer

from .complaints import complain
from .hit_options import HitOptions
from .map_options import WISHES, GridOptions, MapOutputs, MapRun, WorkOptions
from .option_groups import OptionGroup, without
from .render import print_table
from .robot_options import RobotOptions

if TYPE_CHECKING:
    from xarray import Dataset

BEST = ("flux", "straight_flux", "inertia", "speed", "miss", "acceleration_ratio", "torque_ratio")


@dataclass(frozen=True)
class MotionOptions(OptionGroup):
    """The motions that are tried."""

    panel: ClassVar[str] = "The motions"

    tries: Annotated[
        int, typer.Option("--tries", help="Motions per position and joint, the best is kept.")
    ] = 8
    dt: Annotated[float, typer.Option("--dt", help="Control step (s).")] = 0.004


def sweep_motion(
    robot: RobotOptions,
    hit: Annotated[HitOptions, without("position", *WISHES)],
    grid: GridOptions,
    motions: MotionOptions,
    work: WorkOptions,
    output: MapOutputs,
) -> None:
    """Map the flux that hitting motions really deliver over a grid of object positions."""
    import hitjoints as hj

    asked = MapRun(robot, hit, grid, work, output)
    arm, swept = asked.map(hj.sweep_motion, tries=motions.tries, dt=motions.dt)
    rows = _summary(swept)
    asked.show(arm, swept, rows, _print)
    if not any(row["hit"] for row in rows):
        complain("no", "no motion hits an object at any position of the grid")
        raise typer.Exit(3)


def _summary(swept: Dataset) -> list[dict[str, Any]]:
    """Return, per joint and direction, how much is hit and where the most is delivered."""
    rows = []
    for k in swept.joint.values:
        reached = swept.reachable.sel(joint=k) > 0
        for d in swept.direction.values:
            part = swept.sel(joint=k, direction=d)
            row: dict[str, Any] = {
                "joint": int(k),
                "direction": part.direction_vector.values.tolist(),
                "reachable": float(reached.mean()),
                "hit": float((part.hits > 0).mean()),
            }
            if row["hit"]:
                best = part.isel(part.flux.argmax(("x", "y", "z")))
                share = (part.flux / part.straight_flux).median()
                row |= {name: float(best[name]) for name in BEST} | {
                    "position": [float(best[name]) for name in "xyz"],
                    "delivered": float(share),
                    "q": best.q.values,
                    "q0": best.q0.values,
                }
            rows.append(row)
    return rows


def _print(swept: Dataset, rows: list[dict[str, Any]]) -> None:
    names = (
        "hit with", "along", "reachable", "hit", "delivered", "most (m/s)", "there (m)",
        "torque there",
    )  # fmt: skip
    cells = [
        [
            f"joint {row['joint']}",
            row["direction"],
            f"{row['reachable']:.1%}",
            f"{row['hit']:.1%}",
            f"{row['delivered']:.1%}" if "delivered" in row else None,
            *(row.get(name) for name in ("flux", "position")),
            f"{row['torque_ratio']:.3g} x limit" if "torque_ratio" in row else None,
        ]
        for row in rows
    ]
    grid = " x ".join(str(swept.sizes[name]) for name in "xyz")
    print_table(
        f"{swept.attrs['robot']}: {grid} object positions, {swept.attrs['tries']} motions per "
        f"position and joint, object of {swept.attrs['mass']:g} kg",
        names,
        cells,
        caption=(
            "delivered: median share of the greatest straight flux of the hitting configuration"
        ),
    )
