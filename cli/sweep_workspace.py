"""`hitjoints sweep workspace`: maps over object positions, resumable and on a cluster if needed."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from .complaints import complain
from .options import (
    DIRECTION,
    MASS,
    ORIGIN,
    ROBOT,
    JointsOption,
    JsonOption,
    MassOption,
    OffsetOption,
    PlotOption,
    RobotOption,
    SeedOption,
    check_mass,
    check_outputs,
    numbers,
    spaced,
    triple,
)
from .render import print_json, print_table

if TYPE_CHECKING:
    from xarray import Dataset

    from hitjoints.maps.workspace import Progress

RANGE = "START:STOP:COUNT"


def sweep_workspace(
    robot: RobotOption = ROBOT,
    x: Annotated[str, typer.Option(metavar=RANGE, help="Object positions along x (m).")] = (
        "-0.8:0.8:33"
    ),
    y: Annotated[str, typer.Option(metavar=RANGE, help="Along y.")] = "-0.8:0.8:33",
    z: Annotated[str, typer.Option(metavar=RANGE, help="Along z.")] = "0.5",
    directions: Annotated[
        list[str] | None,
        typer.Option("--direction", metavar="X,Y,Z", help="Hitting direction; may be repeated."),
    ] = None,
    mass: MassOption = MASS,
    joints: JointsOption = None,
    offset: OffsetOption = ORIGIN,
    samples: Annotated[int, typer.Option(help="Configurations per position and joint.")] = 100,
    out: Annotated[
        Path | None,
        typer.Option(
            metavar="MAP.zarr", help="Zarr store; the same command continues a run that was killed."
        ),
    ] = None,
    netcdf: Annotated[
        Path | None, typer.Option("--nc", metavar="FILE", help="Write a NetCDF file too.")
    ] = None,
    csv: Annotated[Path | None, typer.Option(metavar="FILE", help="Write a CSV file too.")] = None,
    plot: PlotOption = None,
    scheduler: Annotated[
        str | None, typer.Option(metavar="ADDRESS", help="Dask scheduler to compute on.")
    ] = None,
    threads: Annotated[
        int | None, typer.Option(help="Threads of this process. [default: all processors]")
    ] = None,
    seed: SeedOption = 0,
    as_json: JsonOption = False,
) -> None:
    """Map inertia, speed and flux over a grid of object positions."""
    import hitjoints as hj
    from hitjoints.datasets.files import write_dataset

    check_mass(mass)
    check_outputs(
        plot,
        (out, "out", (".zarr",)),
        (netcdf, "nc", (".nc",)),
        (csv, "csv", (".csv",)),
        inputs=[robot],
    )
    arm = hj.load_robot(robot)
    contact_point = triple(offset, "offset")
    with _progress() as progress:
        swept = hj.sweep_workspace(
            arm,
            spaced(x, "x"),
            spaced(y, "y"),
            spaced(z, "z"),
            [numbers(text) for text in directions or [DIRECTION]],
            mass,
            joints=[hj.Contact(k, contact_point) for k in joints or arm.hitting_joints],
            samples=samples,
            seed=seed,
            out=out,
            scheduler=scheduler,
            threads=threads,
            progress=progress,
            command=" ".join(["hitjoints", *sys.argv[1:]]),
        )
    for path, argument in ((netcdf, "nc"), (csv, "csv")):
        if path is not None:
            write_dataset(swept, path, argument)
    if plot is not None:
        from hitjoints.show.figures import save_figure
        from hitjoints.show.workspace_figure import draw_workspace

        save_figure(draw_workspace(arm, swept), plot)
    rows = _summary(swept)
    if as_json:
        print_json({**swept.attrs, "out": None if out is None else str(out), "summary": rows})
    else:
        _print(swept, rows)
    for path in (out, netcdf, csv, plot):
        if path is not None:
            complain("written", str(path))
    if not any(row["reachable"] for row in rows):
        complain("no", "unreachable: no joint can be placed at any position of the grid")
        raise typer.Exit(3)


@contextmanager
def _progress() -> Iterator[Progress]:
    """Show on stderr how far a sweep is, its rate and the time left."""
    from rich.console import Console
    from rich.progress import (
        BarColumn,
        MofNCompleteColumn,
        Progress,
        TextColumn,
        TimeElapsedColumn,
        TimeRemainingColumn,
    )

    columns = (
        TextColumn("positions"),
        BarColumn(),
        MofNCompleteColumn(),
        TextColumn("{task.fields[rate]}"),
        TimeElapsedColumn(),
        TextColumn("left"),
        TimeRemainingColumn(),
    )
    console = Console(stderr=True)
    bar = Progress(*columns, console=console, transient=True, disable=not console.is_terminal)
    task = bar.add_task("sweep", total=None, rate="")

    def advance(done: int, total: int) -> None:
        bar.start()
        speed = bar.tasks[0].speed
        rate = f"{speed:.0f}/s" if speed else ""
        bar.update(task, completed=done, total=total, rate=rate)

    try:
        yield advance
    finally:
        bar.stop()


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
