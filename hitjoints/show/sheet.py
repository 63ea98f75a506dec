"""A sheet of panels: how many fit beside each other, and how it is saved."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Sequence
from io import BytesIO
from pathlib import Path
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from hitjoints.datasets.describe import versions
from hitjoints.datasets.files import check_writable, write_whole
from hitjoints.errors import InputError
from hitjoints.show.style import FIGURE_ENDINGS, Look

NARROWEST = 2.3
"""in, of a panel where a figure's width is given; with many panels they may be"""
NARROW = 1.7
LOW = (1.2, 0.75, 0.62, 0.5)
"""Height of a panel by its width, at most, where one, two, three or more stand in a column."""
FORMULA = "\x00" * 4  # stands for one while lines are broken: about as wide
COLOUR_BAR = "<colorbar>"
LETTER = 0.55
"""Width of a letter by its height, about."""
STABLE: dict[str, dict[str, Any]] = {
    ".png": {},
    ".pdf": {"metadata": {"CreationDate": None}},
    ".svg": {"metadata": {"Date": None}},
}
"""The same figure is the same file: no time of day in it."""


KEPT = {"png": ("Software", "Description"), "pdf": ("Creator", "Subject"),
        "svg": ("Creator", "Description")}  # fmt: skip
"""Where a file says what it was made with, and keeps the hit that it shows."""


class Sheet(Figure):
    """A figure that is saved, and shown in a notebook, in the look it was drawn in.

    Attributes:
        hit: that it shows, as text; empty for none.
    """

    def __init__(self, look: Look, **options: Any) -> None:
        self.look, self.hit = look, ""
        super().__init__(layout="constrained", **options)

    def savefig(self, fname: Any, **options: Any) -> None:
        """Save as matplotlib does, in this look; the file keeps the hit, for `load_hit`."""
        kind = options.get("format") or Path(str(fname)).suffix.removeprefix(".")
        if kind in KEPT:
            made_with, shown = KEPT[kind]
            told = {made_with: versions()} | ({shown: self.hit} if self.hit else {})
            options["metadata"] = told | (options.get("metadata") or {})
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
        fitting = int(letters(self.get_figwidth(), 0.83) / (max(map(len, words)) + 4))
        columns = max(1, min(len(words), fitting))
        columns = -(-len(words) // -(-len(words) // columns))  # the last row as long as the others
        self.legend(handles, words, loc="outside lower center", ncols=columns)

    def fit(self) -> None:
        """Break titles and labels of panels into lines that fit; to be called when all is drawn."""
        for axis in self.axes:
            place = axis.get_subplotspec()
            if place is None or axis.get_label() == COLOUR_BAR:
                continue
            rows, columns = place.get_gridspec().get_geometry()
            width, height = (0.9 * size for size in self.get_size_inches() / (columns, rows))
            for text, room in (
                (axis.title, width), (axis.xaxis.label, width), (axis.yaxis.label, 0.8 * height)
            ):  # fmt: skip
                text.set_text(
                    wrapped(text.get_text(), room, float(text.get_fontsize()) / fontsize())
                )


def sheet(
    look: Look, count: int, across: int, panel: tuple[float, float], least: float | None = None
) -> tuple[Sheet, list[Axes]]:
    """Return a figure with panels in reading order.

    Args:
        look: how it is to look.
        count: of panels.
        across: how many of them stand side by side where there is room.
        panel: (width, height) in of one where no size is asked for.
        least: in, how narrow it may be; by default as a graph with labels may.
    """
    columns, rows, size = fitted(look, count, across, panel, least)
    figure = Sheet(look, figsize=size)
    return figure, [figure.add_subplot(rows, columns, i + 1) for i in range(count)]


def fitted(
    look: Look, count: int, across: int, panel: tuple[float, float], least: float | None = None
) -> tuple[int, int, tuple[float, float]]:
    """Return columns, rows and size (in) of a sheet; see `sheet`."""
    asked, across = look.inches, min(across, count)
    if asked is None:
        rows = -(-count // across)
        return across, rows, (across * panel[0], rows * panel[1])
    width, height = asked
    if least is None:
        least = NARROW if count > 3 else NARROWEST
    columns = max(1, min(across, int(width / least)))
    rows = -(-count // columns)
    if height is None:
        shape = panel[1] / panel[0]
        if columns == 1:
            shape = min(shape, LOW[min(count, len(LOW)) - 1])
        height = rows * (0.2 + width / columns * shape)
    return columns, rows, (width, height)


def letters(width: float, size: float = 1.0) -> int:
    """Return how many letters stand on a line of a width (in), at a size relative to the font."""
    return max(8, int(72 * width / (LETTER * size * fontsize())))


def fontsize() -> float:
    """Return the height of letters (pt) that sizes are relative to."""
    from matplotlib import rcParams

    return float(rcParams["font.size"])


def below(axis: Axes, lines: float, columns: int, **options: Any) -> None:
    """Write an axis's legend below it, so many lines down."""
    axis.legend(
        loc="upper center", bbox_to_anchor=(0.5, 0.0), borderaxespad=1.2 * lines, ncols=columns,
        **options,
    )  # fmt: skip


def wrapped(text: str, width: float, size: float = 1.0) -> str:
    """Return a text in lines that fit a width (in)."""
    formulas = re.findall(r"\$[^$]*\$", text)
    plain = re.sub(r"\$[^$]*\$", FORMULA, text)
    lines = [textwrap.wrap(line, letters(width, size)) for line in plain.split("\n")]
    broken = "\n".join("\n".join(line) for line in lines)
    return re.sub(FORMULA, lambda _: formulas.pop(0), broken)


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
