"""Where a result goes: the options of commands that write data sets and figures."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, ClassVar

import typer

from .complaints import complain
from .option_groups import OptionGroup
from .options import check_outputs


@dataclass(frozen=True)
class OutputOptions(OptionGroup):
    """A data set, a figure, JSON instead of a table."""

    panel: ClassVar[str] = "Output"

    out: Annotated[
        Path | None,
        typer.Option("--out", metavar="FILE", help="Write the data set: .zarr, .nc or .csv."),
    ] = None
    plot: Annotated[
        Path | None,
        typer.Option("--plot", metavar="FILE", help="Draw the figure: .png, .pdf or .svg."),
    ] = None
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object instead.")] = False

    def check(self, *inputs: str | Path | None) -> None:
        """Refuse paths before any work is done for them; `inputs` are read, not written.

        Raises:
            InputError: one cannot be written.
        """
        from hitjoints.datasets.files import DATASET_ENDINGS

        check_outputs(self.plot, (self.out, "out", DATASET_ENDINGS), inputs=inputs)

    def tell(self, *more: Path | None) -> None:
        """Say on stderr what was written."""
        tell_written(self.out, *more, self.plot)


def tell_written(*paths: Path | None) -> None:
    """Say on stderr what was written; None is what was not asked for."""
    for path in paths:
        if path is not None:
            complain("written", str(path))
