"""A sheet of panels: how many fit beside each other, and how it is saved."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from io import BytesIO
from pathlib import Path
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from hitjoints.datasets.files import check_writable, write_whole
from hitjoints.errors import InputError
from hitjoints.show.style import FIGURE_ENDINGS, Look

NARROWEST = 2.3
"""in, of a panel where a figure's width is given; with many panels they may be"""
NARROW = 1.7
LETTER = 0.55
"""Width of a letter by its height, about."""
STABLE: dict[str, dict[str, Any]] = {
    ".png": {},
    ".pdf": {"metadata": {"CreationDate": None}},
    ".svg": {"metadata": {"Date": None}},
}
"""The same figure is the same file: no time of day in it."""


class Sheet(Figure):
    """A figure that is saved, and shown in a notebook, in the look it was drawn in."""

    def __init__(self, look: Look, **options: Any) -> None:
        self.look = look
        super().__init__(layout="constrained", **options)

    def savefig(self, fname: Any, **options: Any) -> None:
        """Save as matplotlib does, in this look."""
        with self.look.applied():
            super().savefig(fname, **options)

    def _repr_png_(self) -> bytes:
        drawn = BytesIO()
        self.savefig(drawn, format="png", dpi=100)
        return drawn.getvalue()

    def headline(self, text: str) -> None:
        """Write a headline, unless a size was asked for: a caption says it then."""
        if self.look.size is None:
            self.suptitle(wrapped(text, self.get_figwidth()), fontsize="medium")

    def key(self, handles: Sequence[Any], labels: Sequence[str] | None = None) -> None:
        """Write a legend of all panels below them, in as many columns as fit."""
        words = [str(h.get_label()) for h in handles] if labels is None else list(labels)
        fitting = int(letters(self.get_figwidth(), 0.83) / (max(map(len, words)) + 6))
        columns = max(1, min(len(words), fitting))
        columns = -(-len(words) // -(-len(words) // columns))  # the last row as long as the others
        self.legend(handles, words, loc="outside lower center", ncols=columns)


def sheet(
    look: Look, count: int, across: int, panel: tuple[float, float]
) -> tuple[Sheet, list[Axes]]:
    """Return a figure with panels in reading order.

    Args:
        look: how it is to look.
        count: of panels.
        across: how many of them stand side by side where there is room.
        panel: (width, height) in of one where no size is asked for.
    """
    columns, rows, size = fitted(look, count, across, panel)
    figure = Sheet(look, figsize=size)
    return figure, [figure.add_subplot(rows, columns, i + 1) for i in range(count)]


def fitted(
    look: Look, count: int, across: int, panel: tuple[float, float]
) -> tuple[int, int, tuple[float, float]]:
    """Return columns, rows and size (in) of a sheet; see `sheet`."""
    asked, across = look.inches, min(across, count)
    if asked is None:
        rows = -(-count // across)
        return across, rows, (across * panel[0], rows * panel[1])
    width, height = asked
    least = NARROW if count > 3 else NARROWEST
    columns = max(1, min(across, int(width / least)))
    while count % columns and columns > 1 and count % across == 0:
        columns -= 1  # no half-empty row
    rows = -(-count // columns)
    if height is None:
        height = rows * (0.2 + width / columns * panel[1] / panel[0])
    return columns, rows, (width, height)


def letters(width: float, size: float = 1.0) -> int:
    """Return how many letters stand on a line of a width (in), at a size relative to the font."""
    from matplotlib import rcParams

    return int(72 * width / (LETTER * size * rcParams["font.size"]))


def wrapped(text: str, width: float, size: float = 1.0) -> str:
    """Return a text in lines that fit a width (in)."""
    lines = text.split("\n")
    return "\n".join("\n".join(textwrap.wrap(line, letters(width, size))) for line in lines)


def save_figure(figure: Figure, path: Path, argument: str = "plot") -> None:
    """Save a figure as PNG, PDF or SVG, by the path's ending.

    Raises:
        InputError: an unknown ending, a path that cannot be written, or a style that asks for a
            LaTeX which is not there.
    """
    check_writable(path, argument, FIGURE_ENDINGS)
    drawn = BytesIO()  # drawn first: no half a file can confuse matplotlib
    try:
        figure.savefig(drawn, format=path.suffix.removeprefix("."), **STABLE[path.suffix])
    except RuntimeError as error:
        if not isinstance(figure, Sheet) or figure.look.style is None:
            raise
        why = str(error).splitlines()[0]
        raise InputError("style", figure.look.style, f"it cannot be drawn with ({why})") from None
    write_whole(path, argument, lambda made: made.write_bytes(drawn.getvalue()))
