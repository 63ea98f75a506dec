"""`hitjoints reproduce`: the paper's figures, and its numbers beside ours."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from .complaints import complain
from .figure_options import FigureOptions
from .kept import output_folder
from .option_groups import without
from .options import JsonOption
from .render import print_json, print_table

if TYPE_CHECKING:
    from hitjoints.evidence.paper.reproduction import Reproduction


def reproduce(
    figure: Annotated[
        str,
        typer.Argument(
            metavar="[fig2|fig4|fig6|all]", help="What to repeat; fig6 has Fig. 5 and the spread."
        ),
    ] = "all",
    out: Annotated[
        Path,
        typer.Option("--out", metavar="DIR", help="Folder for the figures and the table."),
    ] = Path("reproduction"),
    *,
    look: Annotated[FigureOptions, without("plot")],
    as_json: JsonOption = False,
) -> None:
    """Repeat the paper's experiments: its figures, and every number it prints beside ours.

    On the iiwa 14 with PyBullet's inertia tensors, which are the paper's, with the URDF's, and with
    the phantom inertia of a common description of the arm.
    """
    from hitjoints.evidence.paper.reproduction import CHOICES
    from hitjoints.evidence.paper.reproduction import reproduce as repeat

    if figure not in CHOICES:
        raise typer.BadParameter(f"{figure!r} is not one of {', '.join(CHOICES)}")
    look.check_look(drawn=True)
    with output_folder(out):
        result = repeat(figure)
        written = _write(result, out, look)
    if as_json:
        print_json(result.as_dict() | {"written": [str(path) for path in written]})
    else:
        _print(result)
    complain("written", f"{len(written)} files in {out}: {', '.join(p.name for p in written)}")


def _write(result: Reproduction, out: Path, look: FigureOptions) -> list[Path]:
    from hitjoints.datasets.files import write_whole
    from hitjoints.evidence.paper.table import as_csv, as_markdown
    from hitjoints.show import figures
    from hitjoints.show.sheet import save_figure

    written = []
    for name, figure in figures.reproduction(result, **look.look).items():
        for ending in (".png", ".pdf"):
            written.append(out / f"{name}{ending}")
            save_figure(figure, written[-1], "out")
    for ending, text in ((".md", as_markdown(result.rows)), (".csv", as_csv(result.rows))):
        written.append(out / f"table{ending}")
        write_whole(written[-1], "out", partial(_write_text, text))
    return written


def _write_text(text: str, path: Path) -> None:
    path.write_text(text, encoding="utf-8")


def _print(result: Reproduction) -> None:
    from hitjoints.evidence.paper.table import cells

    print_table(
        "What the paper prints, beside ours",
        ("quantity", "paper", "iiwa14_bullet", "iiwa14", "phantom"),
        [
            (f"{row.figure}: {row.quantity}", *cells(row)[2:6])
            for row in result.rows
            if row.paper is not None
        ],
        caption="iiwa14_bullet: the tensors of the paper's simulation; iiwa14: the URDF's; phantom:"
        " 1 kg m^2 at its flange. table.md has all rows, and a remark on each.",
    )
