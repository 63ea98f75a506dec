"""`hitjoints export`: formulas for programs in other languages."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, ClassVar

import typer

from .hit_options import HitOptions
from .hit_sources import told
from .option_groups import OptionGroup, grouped, show_help, without
from .output_options import tell_written
from .robot_options import RobotOptions

app = typer.Typer(help="Write formulas as source code.")


@app.callback(invoke_without_command=True)
def root(context: typer.Context) -> None:
    """Write the formulas of an arm as source code."""
    show_help(context)


@dataclass(frozen=True)
class SourceOptions(OptionGroup):
    """The function that is written."""

    panel: ClassVar[str] = "The function"

    outputs: Annotated[
        list[str] | None,
        typer.Option("--output", help="Quantity; repeat for several. (default: inertia, gradient)"),
    ] = None
    name: Annotated[str, typer.Option("--name", help="Of the function.")] = "hit"
    out: Annotated[
        Path | None,
        typer.Option("--out", metavar="FILE.c", help="Write it there, not to stdout."),
    ] = None


def export_c(
    robot: RobotOptions,
    hit: Annotated[
        HitOptions,
        without(
            "file",
            "position",
            "direction",
            "goal",
            "mass",
            "flux",
            "object_speed",
            "restitution",
            "friction",
        ),
    ],
    source: SourceOptions,
) -> None:
    """Write quantities of one contact as a function in C99: no allocation, libm alone."""
    import hitjoints as hj
    from hitjoints.datasets.files import check_writable, write_whole

    if source.out is not None:
        check_writable(source.out, "out", (".c", ".h"))
    arm = robot.load()
    contact = hit.read().contact(arm)
    names = tuple(source.outputs or ("inertia", "gradient"))
    text = hj.c_source(arm, contact, names, source.name)
    if source.out is None:
        print(text, end="")
        return
    write_whole(source.out, "out", lambda made: made.write_text(text, encoding="utf-8"))
    tell_written(source.out)


app.command("c")(grouped(export_c, told))
