"""`hitjoints calibrate`: an object's numbers from past hits."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from .complaints import complain
from .figure_options import FigureOptions
from .options import JsonOption, check_outputs
from .output_options import tell_written
from .render import print_json, print_table, say

if TYPE_CHECKING:
    from hitjoints.evidence.calibration.past_hits import Calibration


def calibrate(
    files: Annotated[
        list[Path],
        typer.Argument(metavar="FILE...", help="Landing tables (CSV), recordings, or folders."),
    ],
    restitution: Annotated[
        float | None,
        typer.Option("--restitution", help="Of the object. (default: as recorded, else 0.5)"),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option("--out", metavar="FILE", help="Write the object part of a hit.toml."),
    ] = None,
    *,
    figure: FigureOptions,
    as_json: JsonOption = False,
) -> None:
    """Find an object's restitution and friction, and how well its landings can be foreseen.

    A landing table has a line per hit: flux and distance, and where known arm, hit_x, start_x,
    yaw_qz. Every landing is foreseen from all the others, which is what the figures are worth.
    """
    from hitjoints.datasets.files import write_whole
    from hitjoints.evidence.calibration.past_hits import calibrate as find
    from hitjoints.show import figures

    check_outputs(figure.plot, (out, "out", (".toml",)), inputs=files)
    figure.check_look()
    result = find(files, restitution=restitution)
    if out is not None:
        text = result.toml() + "\n"
        write_whole(out, "out", lambda path: path.write_text(text, encoding="utf-8"))
    figure.save(figures.calibration, result)
    if as_json:
        print_json(result.as_dict())
    else:
        _print(result)
    for note in result.notes:
        complain("note", note)
    tell_written(out, figure.plot)


def _print(result: Calibration) -> None:
    spread = result.object["spread"]
    print_table(
        f"The object, by {result.rows} hits",
        ("", "value", "standard deviation"),
        [
            (name, value, spread.get(name))
            for name, value in result.object.items()
            if name != "spread"
        ],
    )
    held = result.held_out
    if held is None:
        say("Too few boxes were followed to their rest: no landing can be foreseen.")
        return
    print_table(
        f"{held.rows} landings, each foreseen from all the others",
        ("", "value", "unit"),
        [
            ("within their interval of 90 %", f"{held.held} of {held.rows}", ""),
            ("mean width of the interval", held.width, "m"),
            ("mean error", held.error, "m"),
            ("mean error of distance = c flux^2", held.baseline_error, "m"),
        ],
        caption="empirical: nothing is claimed for other objects, tables or boxes turned further",
    )
