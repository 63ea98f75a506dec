"""The figure of a result: the options of commands that draw one."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

import typer

from .option_groups import OptionGroup
from .options import PlotOption

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from hitjoints.show.style import LookOptions


@dataclass(frozen=True)
class FigureOptions(OptionGroup):
    """A figure, and how it looks."""

    panel: ClassVar[str] = "Output"

    plot: PlotOption = None
    plot_size: Annotated[
        str | None,
        typer.Option(
            "--plot-size",
            metavar="single|double|WxH",
            help="Of one or two columns of a paper, or in mm, without a headline.",
        ),
    ] = None
    plot_font: Annotated[
        str | None,
        typer.Option("--plot-font", metavar="NAME", help="Of the figure: serif, Arial ..."),
    ] = None
    plot_style: Annotated[
        str | None,
        typer.Option("--plot-style", metavar="FILE", help="Style of matplotlib's: .mplstyle."),
    ] = None

    @property
    def look(self) -> LookOptions:
        """How the figure is to look."""
        return {"size": self.plot_size, "font": self.plot_font, "style": self.plot_style}

    def check_look(self, drawn: bool | None = None) -> None:
        """Refuse a look that no figure can have, or that there is no figure for.

        Args:
            drawn: a figure is drawn; by default when `--plot` is given.

        Raises:
            InputError: one of the options cannot be used.
        """
        from hitjoints.errors import InputError

        given = {f"plot_{name}": value for name, value in self.look.items() if value is not None}
        if not given:
            return
        if not (self.plot is not None if drawn is None else drawn):
            name, value = next(iter(given.items()))
            raise InputError(name, value, "no figure is asked for")
        from hitjoints.show.style import Look

        try:
            Look(**self.look)
        except InputError as error:
            raise InputError(f"plot_{error.argument}", error.value, error.expected) from None

    def save(self, draw: Callable[..., Figure], *what: Any) -> None:
        """Draw and save the figure if one is asked for."""
        if self.plot is not None:
            from hitjoints.show.sheet import save_figure

            save_figure(draw(*what, **self.look), self.plot)
