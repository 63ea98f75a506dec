"""`hitjoints sweep workspace`: maps over object positions, resumable and on a cluster if needed."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import typer

from .complaints import complain
from .hit_options import HitOptions
from .map_options import WISHES, GridOptions, MapOutputs, MapRun, WorkOptions
from .option_groups import without
from .render import print_table
from .robot_options import RobotOptions

if TYPE_CHECKING:
    from xarray import Dataset


def sweep_workspace(
    robot: RobotOptions,
    hit: Annotated[HitOptions, without("position", *WISHES)],
    grid: GridOptions,
    work: WorkOptions,
    output: MapOutputs,
) -> None:
    """Map inertia, speed and flux over a grid of object positions."""
    import hitjoints as hj

    asked = MapRun(robot, hit, grid, work, output)
    arm, swept = asked.map(hj.sweep_workspace)
    rows = _summary(swept)
    asked.show(arm, swept, rows, _print)
    if not any(row["reachable"] for row in rows):
        complain("no", "unreachable: no joint can be placed at any position of the grid")
        raise typer.Exit(3)


def _summary(swept: Dataset) -> list[dict[str, Any]]:
    """Return, per joint and direction, how much is reachable and where the flux is greatest."""
    import numpy as np

    rows = []
    for k in swept.joint.values:
        reached = swept.reachable.sel(joint=k)
        for d in swept.direction.values:
            part = swept.sel(joint=k, direction=d)
            row: dict[str, Any] = {
                "joint": int(k),
                "direction": part.direction_vector.values.tolist(),
                "reachable": float((reached > 0).mean()),
            }
            if bool((reached > 0).any()):
                best = part.isel(part.flux.argmax(("x", "y", "z")))
                row |= {
                    "position": [float(best[name]) for name in "xyz"],
                    "inertia_median": float(np.nanmedian(part.inertia_median)),
                    **{
                        name: float(best[name])
                        for name in ("inertia", "speed", "flux", "straight_flux")
                    },
                    "q": best.q.values,
                    "away": float((part.away == 1).sum() / (reached > 0).sum()),
                }
            rows.append(row)
    return rows


def _print(swept: Dataset, rows: list[dict[str, Any]]) -> None:
    names = (
        "hit with", "along", "reachable", "can point away", "median inertia (kg)",
        "greatest flux (m/s)", "there (m)",
    )  # fmt: skip
    cells = [
        [
            f"joint {row['joint']}",
            row["direction"],
            f"{row['reachable']:.1%}",
            f"{row['away']:.1%}" if "away" in row else None,
            *(row.get(name) for name in ("inertia_median", "flux", "position")),
        ]
        for row in rows
    ]
    grid = " x ".join(str(swept.sizes[name]) for name in "xyz")
    print_table(
        f"{swept.attrs['robot']}: {grid} object positions, {swept.attrs['samples']} configurations "
        f"per position and joint, object of {swept.attrs['mass']:g} kg",
        names,
        cells,
        caption="can point away: share of the reachable positions, for the links beyond (Eq. 14)",
    )
