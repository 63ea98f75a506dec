"""How every figure looks: one colour and one mark for each joint, sizes, fonts, what files hold.

A look is made of four layers, each over the one before: ours; the user's matplotlibrc; a style
(`.mplstyle`); size and font that are asked for.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypedDict

from hitjoints.errors import InputError, UnknownNameError

FIGURE_ENDINGS = (".png", ".pdf", ".svg")
# Okabe and Ito's colours, told apart by people with any colour vision. Some are equally light:
# in grey it is the marks that differ.
COLOURS = ("#D55E00", "#0072B2", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")
MARKS = ("o", "s", "^", "D", "v", "P", "X")
HATCHES = ("", "////", "....", "\\\\\\\\", "xxxx", "----", "++++")
GENERIC = ("serif", "sans-serif", "monospace")
INCH = 25.4  # mm
SIZES = {"single": (88.9, None), "double": (181.9, None)}
"""mm, width of one column and of both in IEEE's journals; the height follows from the panels."""
SMALLEST, LARGEST = 20.0, 2000.0
"""mm, edges of a figure."""

OURS: dict[str, Any] = {
    "savefig.dpi": 160,
    "pdf.fonttype": 42,  # TrueType: publishers refuse the Type 3 that is matplotlib's default
    "ps.fonttype": 42,
    "svg.fonttype": "none",  # text stays text
    "svg.hashsalt": "hitjoints",  # the same figure is the same file
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.titlesize": "medium",
    "figure.titlesize": "medium",
    "legend.frameon": False,
    "legend.fontsize": "small",
    "grid.alpha": 0.3,
    "hatch.linewidth": 1.2,
    "lines.markersize": 5,
}
IN_A_COLUMN: dict[str, Any] = {
    "savefig.dpi": 300,
    "font.size": 8,
    "legend.fontsize": 6.5,
    "legend.handlelength": 1.6,
    "legend.labelspacing": 0.3,
    "hatch.linewidth": 0.8,
    "lines.linewidth": 1.2,
    "lines.markersize": 3.5,
    "axes.linewidth": 0.6,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "xtick.major.size": 2.5,
    "ytick.major.size": 2.5,
    "axes.titlepad": 3,
    "axes.labelpad": 2,
}
"""What a figure of a given size has, too: letters that journals accept, and lines to match."""


def colour_of(joint: int) -> str:
    """Return the colour a joint has in every figure; the last joints of an arm differ most."""
    return COLOURS[(7 - joint) % len(COLOURS)]


def mark_of(joint: int) -> str:
    """Return the marker a joint has in every figure, which tells it in grey."""
    return MARKS[(7 - joint) % len(MARKS)]


def hatch_of(joint: int) -> str:
    """Return the hatching of a joint's areas."""
    return HATCHES[(7 - joint) % len(HATCHES)]


class LookOptions(TypedDict, total=False):
    """Size, font and style of a figure; see `Look`."""

    size: str | tuple[float, float] | None
    font: str | None
    style: str | Path | None


@dataclass(frozen=True)
class Look:
    """How a figure is to look.

    Attributes:
        size: "single" or "double" column, "WIDTHxHEIGHT" or (width, height) in mm. Without one a
            figure has the matplotlibrc's `figure.figsize`, or else room for each of its panels,
            and a headline.
        font: name of a font that is installed, or serif, sans-serif, monospace.
        style: file `.mplstyle`, or name of a style of matplotlib's.

    Raises:
        InputError: one of them cannot be used.
    """

    size: str | tuple[float, float] | None = None
    font: str | None = None
    style: str | Path | None = None

    def __post_init__(self) -> None:
        _millimetres(self.size)
        if self.font is not None:
            _check_font(self.font)
        with self.applied():
            pass

    @contextmanager
    def applied(self) -> Iterator[None]:
        """Draw or save in this look inside.

        Raises:
            InputError: the style cannot be read.
        """
        mpl = _matplotlib()
        ours = OURS | (IN_A_COLUMN if self.size is not None else {})
        usual = mpl.rcParamsDefault
        own = {key: value for key, value in ours.items() if mpl.rcParams[key] == usual[key]}
        asked = {} if self.font is None else _font(self.font)
        with mpl.rc_context(own | _read_style(self.style) | asked):
            yield

    @property
    def inches(self) -> tuple[float, float | None] | None:
        """Width, and height if it is given; None where each panel takes what it needs."""
        if self.size is not None:
            width, height = _millimetres(self.size)
            return width / INCH, None if height is None else height / INCH
        mpl = _matplotlib()
        with self.applied():
            width, height = mpl.rcParams["figure.figsize"]
        usual = [width, height] == list(mpl.rcParamsDefault["figure.figsize"])
        return None if usual else (width, height)


def _matplotlib() -> Any:
    """Return matplotlib, whose parameters have types of their own by name."""
    import matplotlib

    return matplotlib


def _millimetres(size: str | tuple[float, float] | None) -> tuple[float, float | None]:
    """Return width and height.

    Raises:
        InputError: neither a name nor two lengths that a figure can have.
    """
    if size is None or (isinstance(size, str) and size in SIZES):
        return SIZES["double" if size is None else str(size)]
    expected = f"{', '.join(SIZES)}, or WIDTHxHEIGHT in mm such as 90x60"
    pair = re.fullmatch(r"([\d.]+)x([\d.]+)", size) if isinstance(size, str) else None
    try:
        width, height = (float(edge) for edge in (size if pair is None else pair.groups()))
    except (TypeError, ValueError):
        raise InputError("size", size, expected) from None
    if not all(SMALLEST <= edge <= LARGEST for edge in (width, height)):
        raise InputError("size", size, f"edges from {SMALLEST:g} to {LARGEST:g} mm")
    return width, height


def _check_font(name: str) -> None:
    from matplotlib.font_manager import fontManager

    known = sorted({font.name for font in fontManager.ttflist})
    if name not in (*known, *GENERIC):
        raise UnknownNameError("font", name, (*GENERIC, *known))


def _font(name: str) -> dict[str, Any]:
    """Return the parameters of a font, which formulas have too, as far as it has their letters."""
    if name in GENERIC:
        serif = {"mathtext.fontset": "stix"} if name == "serif" else {}
        return {"font.family": name, **serif}
    maths = {"rm": name, "it": f"{name}:italic", "bf": f"{name}:bold"}
    named = {f"mathtext.{kind}": font for kind, font in maths.items()}
    return {
        "font.family": [name],
        "mathtext.fontset": "custom",
        "mathtext.fallback": "stix",
        **named,
    }


def _read_style(style: str | Path | None) -> dict[str, Any]:
    """Return the parameters of a style.

    Raises:
        InputError: there is none of that name, and no such file.
    """
    if style is None:
        return {}
    import matplotlib.style

    mpl = _matplotlib()
    if str(style) in matplotlib.style.library:
        return dict(mpl.style.library[str(style)])
    path = Path(style)
    if not path.is_file():
        raise InputError("style", str(style), "a file .mplstyle, or a style that matplotlib knows")
    try:
        read = mpl.rc_params_from_file(path, use_default_template=False)
    except (OSError, ValueError) as error:
        raise InputError("style", str(style), f"it cannot be read ({error})") from None
    blocked = {"backend", "backend_fallback", "interactive", "toolbar", "timezone"}
    return {key: value for key, value in read.items() if key not in blocked}
