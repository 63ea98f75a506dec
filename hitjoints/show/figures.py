"""What the figures have in common: colours, sizes, and how they are saved."""

from __future__ import annotations

from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING

from hitjoints.datasets.files import check_writable, write_whole

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FIGURE_ENDINGS = (".png", ".pdf", ".svg")
# Okabe and Ito's colours, told apart by people with any colour vision.
COLOURS = ("#D55E00", "#0072B2", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")


def colour_of(joint: int) -> str:
    """Return the colour a joint has in every figure; the last joints of an arm differ most."""
    return COLOURS[(7 - joint) % len(COLOURS)]


def save_figure(figure: Figure, path: Path, argument: str = "plot") -> None:
    """Save a figure as PNG, PDF or SVG, by the path's ending.

    Raises:
        InputError: an unknown ending, or a path that cannot be written.
    """
    check_writable(path, argument, FIGURE_ENDINGS)
    drawn = BytesIO()  # drawn first: no half a file can confuse matplotlib
    figure.savefig(drawn, format=path.suffix.removeprefix("."), dpi=160)
    write_whole(path, argument, lambda made: made.write_bytes(drawn.getvalue()))
