"""Where a result goes: the options of commands that write data sets and figures."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from .complaints import complain
from .figure_options import FigureOptions
from .options import check_outputs


@dataclass(frozen=True)
class OutputOptions(FigureOptions):
    """A data set, a figure, JSON instead of a table."""

    out: Annotated[
        Path | None,
        typer.Option("--out", metavar="FILE", help="Write the data set: .zarr, .nc or .csv."),
    ] = None
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object instead.")] = False

    def check(self, *inputs: str | Path | None) -> None:
        """Refuse paths before any work is done for them; `inputs` are read, not written.

        Raises:
            InputError: one cannot be written.
        """
        from hitjoints.datasets.files import DATASET_ENDINGS

        check_outputs(self.plot, (self.out, "out", DATASET_ENDINGS), inputs=inputs)
        self.check_look()

    def tell(self, *more: Path | None) -> None:
        """Say on stderr what was written."""
        tell_written(self.out, *more, self.plot)


def tell_written(*paths: Path | None) -> None:
    """Say on stderr what was written; None is what was not asked for."""
    for path in paths:
        if path is not None:
            complain("written", str(path))
