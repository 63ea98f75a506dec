"""`hitjoints sweep workspace`: maps over object positions, resumable and on a cluster if needed."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

import typer

from .complaints import complain
from .figure_options import FigureOptions
from .hit_options import HitOptions
from .kept import continues
from .option_groups import OptionGroup, without
from .options import JsonOption, SeedOption, check_outputs, spaced
from .output_options import tell_written
from .render import print_json, print_table
from .robot_options import RobotOptions

if TYPE_CHECKING:
    from xarray import Dataset

    from hitjoints.model.robot import Robot

WISHES = ("goal", "flux", "object_speed", "restitution", "friction")
RANGE = "START:STOP:COUNT"


@dataclass(frozen=True)
class GridOptions(OptionGroup):
    """Where objects are, and how many configurations are tried at each place."""

    panel: ClassVar[str] = "The grid"

    x: Annotated[str, typer.Option("--x", metavar=RANGE, help="Object positions along x (m).")] = (
        "-0.8:0.8:33"
    )
    y: Annotated[str, typer.Option("--y", metavar=RANGE, help="Along y.")] = "-0.8:0.8:33"
    z: Annotated[str, typer.Option("--z", metavar=RANGE, help="Along z.")] = "0.5"
    samples: Annotated[
        int, typer.Option("--samples", help="Configurations per position and joint.")
    ] = 100
    seed: SeedOption = 0


@dataclass(frozen=True)
class WorkOptions(OptionGroup):
    """What it is computed on."""

    panel: ClassVar[str] = "The work"

    scheduler: Annotated[
        str | None,
        typer.Option("--scheduler", metavar="ADDRESS", help="Dask scheduler to compute on."),
    ] = None
    threads: Annotated[
        int | None,
        typer.Option("--threads", help="Threads of this process. (default: all processors)"),
    ] = None


@dataclass(frozen=True)
class MapOutputs(FigureOptions):
    """The store, and copies of it."""

    out: Annotated[
        Path | None,
        typer.Option(
            "--out",
            metavar="MAP.zarr",
            help="Zarr store; the same command continues a run that was killed.",
        ),
    ] = None
    netcdf: Annotated[
        Path | None, typer.Option("--nc", metavar="FILE", help="Write a NetCDF file too.")
    ] = None
    csv: Annotated[
        Path | None, typer.Option("--csv", metavar="FILE", help="Write a CSV file too.")
    ] = None
    as_json: JsonOption = False

    def check(self, *inputs: str | Path | None) -> None:
        """Refuse paths before any work is done for them; `inputs` are read, not written.

        Raises:
            InputError: one cannot be written.
        """
        stores = (self.out, "out", (".zarr",)), (self.netcdf, "nc", (".nc",))
        check_outputs(self.plot, *stores, (self.csv, "csv", (".csv",)), inputs=inputs)
        self.check_look()


def sweep_workspace(
    robot: RobotOptions,
    hit: Annotated[HitOptions, without("position", *WISHES)],
    grid: GridOptions,
    work: WorkOptions,
    output: MapOutputs,
) -> None:
    """Map inertia, speed and flux over a grid of object positions."""
    import hitjoints as hj
    from hitjoints.counting import tell

    asked = hit.read()
    output.check(robot.robot, hit.file)
    arm = robot.load()
    if output.out is not None:
        continues(output.out)
    swept = hj.sweep_workspace(
        arm,
        spaced(grid.x, "x"),
        spaced(grid.y, "y"),
        spaced(grid.z, "z"),
        asked.directions,
        asked.mass,
        joints=asked.contacts(arm),
        samples=grid.samples,
        seed=grid.seed,
        out=output.out,
        scheduler=work.scheduler,
        threads=work.threads,
        progress=partial(tell, "positions"),
        command=" ".join(["hitjoints", *sys.argv[1:]]),
    )
    rows = _summary(swept)
    write_map(arm, swept, output)
    if output.as_json:
        out = None if output.out is None else str(output.out)
        print_json({**swept.attrs, "out": out, "summary": rows})
    else:
        _print(swept, rows)
    tell_written(output.out, output.netcdf, output.csv, output.plot)
    if not any(row["reachable"] for row in rows):
        complain("no", "unreachable: no joint can be placed at any position of the grid")
        raise typer.Exit(3)


def write_map(arm: Robot, swept: Dataset, output: MapOutputs) -> None:
    """Write the copies and the picture of a map that are asked for."""
    from hitjoints.datasets.files import write_dataset
    from hitjoints.show import figures

    for path, argument in ((output.netcdf, "nc"), (output.csv, "csv")):
        if path is not None:
            write_dataset(swept, path, argument)
    output.save(figures.workspace, arm, swept)


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
