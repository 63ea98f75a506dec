"""The options that several commands share, and how their values are read."""

from __future__ import annotations

import math
from collections.abc import Iterable
from pathlib import Path
from typing import Annotated, Any

import typer

from .kept import watch

MOST = 2**63 - 1  # what files can hold


def numbers(text: str) -> list[float]:
    """Read "x,y,z"."""
    try:
        return [float(word) for word in text.split(",")]
    except ValueError:
        raise typer.BadParameter(f"{text!r} is not a list of numbers like 0.5,0.3,0.5") from None


def spaced(text: str, argument: str) -> Any:
    """Read a range "start:stop:count", ends included, or a single number.

    Args:
        text: as it was typed.
        argument: the option's name.

    Raises:
        InputError: it asks for more numbers than a grid's axis can have.
    """
    import numpy as np

    from hitjoints.maps.grid import MOST_COORDINATES
    from hitjoints.vectors import whole

    try:
        first, last, number = text.split(":") if ":" in text else (text, text, "1")
        start, stop, count = float(first), float(last), int(number)
    except ValueError:
        raise typer.BadParameter(f"{text!r} is not a range like -0.5:0.5:20") from None
    if not math.isfinite(start) or not math.isfinite(stop):
        raise typer.BadParameter(f"{text!r} is not a range of finite numbers")
    return np.linspace(start, stop, whole(max(0, count), argument, 0, MOST_COORDINATES))


def triple(text: str, argument: str) -> tuple[float, float, float]:
    """Read "x,y,z" and refuse any other count.

    Raises:
        InputError: not three numbers.
    """
    from hitjoints.errors import InputError

    values = numbers(text)
    if len(values) != 3:
        raise InputError(argument, text, "three numbers x,y,z in metres")
    return values[0], values[1], values[2]


def for_joints(text: str | None) -> list[float] | float | None:
    """Read one number for all joints, or "x1,x2,..." for each."""
    if text is None:
        return None
    values = numbers(text)
    return values[0] if len(values) == 1 else values


def check_outputs(
    plot: Path | None,
    *outputs: tuple[Path | None, str, tuple[str, ...]],
    inputs: Iterable[str | Path | None] = (),
) -> None:
    """Refuse output paths before any work is done for them.

    Args:
        plot: of the figure, if one is asked for.
        outputs: other paths, each with its option's name and the endings it may have.
        inputs: what is read: no output may overwrite it.

    Raises:
        InputError: an ending is not one of those, a path cannot be written to, or two are one.
    """
    from hitjoints.datasets.files import check_apart, check_writable
    from hitjoints.show.style import FIGURE_ENDINGS

    asked = []
    for path, argument, endings in (*outputs, (plot, "plot", FIGURE_ENDINGS)):
        if path is not None:
            check_writable(path, argument, endings)
            watch(path)
            asked.append((path, argument))
    check_apart(asked, (name for name in inputs if name is not None))


ConfigurationOption = Annotated[
    str | None, typer.Option("--q", metavar="Q1,Q2,...", help="Joint positions. (default: home)")
]
TorquesOption = Annotated[
    bool,
    typer.Option("--torque-limits", help="Keep the effort limits too: start at rest, speed up."),
]
AccelerationOption = Annotated[
    str | None,
    typer.Option(
        "--acceleration",
        metavar="A|A1,A2,...",
        help="Acceleration limits (rad/s^2), for all joints or each. (default: the robot's)",
    ),
]
JsonOption = Annotated[bool, typer.Option("--json", help="Print one JSON object instead.")]
OutOption = Annotated[
    Path | None,
    typer.Option("--out", metavar="FILE", help="Write the data set: .zarr, .nc or .csv."),
]
PlotOption = Annotated[
    Path | None, typer.Option("--plot", metavar="FILE", help="Draw the figure: .png, .pdf or .svg.")
]
SeedOption = Annotated[
    int, typer.Option("--seed", min=0, max=MOST, help="Seed of everything random.")
]
