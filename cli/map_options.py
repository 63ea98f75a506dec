"""What the commands that map object positions share: options, the run, what is written."""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

import typer

from .figure_options import FigureOptions
from .hit_options import HitOptions
from .kept import continues
from .option_groups import OptionGroup
from .options import JsonOption, SeedOption, check_outputs, spaced
from .output_options import tell_written
from .render import print_json
from .robot_options import RobotOptions

if TYPE_CHECKING:
    from xarray import Dataset

    from hitjoints.model.robot import Robot

    Row = dict[str, Any]

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


@dataclass(frozen=True)
class MapRun:
    """A map that is asked for."""

    robot: RobotOptions
    hit: HitOptions
    grid: GridOptions
    work: WorkOptions
    output: MapOutputs

    def map(self, sweep: Callable[..., Dataset], **further: Any) -> tuple[Robot, Dataset]:
        """Return the arm and its map, made or continued.

        Args:
            sweep: `sweep_workspace`, or another that takes its arguments.
            further: arguments that it has besides.

        Raises:
            HitjointsError: an option cannot be used.
        """
        from hitjoints.counting import tell

        asked, grid, out = self.hit.read(), self.grid, self.output.out
        self.output.check(self.robot.robot, self.hit.file)
        arm = self.robot.load()
        if out is not None:
            continues(out)
        swept = sweep(
            arm,
            spaced(grid.x, "x"),
            spaced(grid.y, "y"),
            spaced(grid.z, "z"),
            asked.directions,
            asked.mass,
            joints=asked.contacts(arm),
            samples=grid.samples,
            seed=grid.seed,
            out=out,
            scheduler=self.work.scheduler,
            threads=self.work.threads,
            progress=partial(tell, "positions"),
            command=" ".join(["hitjoints", *sys.argv[1:]]),
            **further,
        )
        return arm, swept

    def show(
        self,
        arm: Robot,
        swept: Dataset,
        rows: list[Row],
        show: Callable[[Dataset, list[Row]], None],
    ) -> None:
        """Write the copies and the picture that are asked for, and print a table or JSON."""
        output = self.output
        _write(arm, swept, output)
        if output.as_json:
            out = None if output.out is None else str(output.out)
            print_json({**swept.attrs, "out": out, "summary": rows})
        else:
            show(swept, rows)
        tell_written(output.out, output.netcdf, output.csv, output.plot)


def _write(arm: Robot, swept: Dataset, output: MapOutputs) -> None:
    """Write the copies and the picture of a map that are asked for."""
    from hitjoints.datasets.files import write_dataset
    from hitjoints.show import figures

    for path, argument in ((output.netcdf, "nc"), (output.csv, "csv")):
        if path is not None:
            write_dataset(swept, path, argument)
    output.save(figures.workspace, arm, swept)
