"""What the commands print on stdout: tables for people, JSON for programs."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Sequence
from typing import Any

from .complaints import printable

FILE_WIDTH = 120  # columns of a table that goes to a file or a pipe


def print_json(result: dict[str, Any]) -> None:
    """Print one JSON object; what is not a finite number becomes null."""
    print(json.dumps(plain(result), allow_nan=False), flush=True)


def plain(value: Any) -> Any:
    """Return a value as JSON knows it; what is not a finite number becomes null."""
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, dict):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value


def print_table(
    title: str,
    columns: Sequence[str],
    rows: Iterable[Sequence[object]],
    caption: str | None = None,
) -> None:
    """Print a table with one line per row; numbers with four digits."""
    from rich import box
    from rich.console import Console
    from rich.table import Table

    table = Table(
        title=printable(title), caption=caption, box=box.SIMPLE_HEAD, title_justify="left"
    )
    for i, column in enumerate(columns):
        table.add_column(column, justify="left" if i == 0 else "right")
    for row in rows:
        table.add_row(*(printable(_cell(value)) for value in row))
    # Names are what a file says, brackets and all.
    console = Console(markup=False, emoji=False)
    if not console.is_terminal:
        console.width = FILE_WIDTH
    console.print(table)


def _cell(value: object) -> str:
    if isinstance(value, str):
        return value
    if value is None:
        return "-"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        # A gradient of 1e-17 is a zero that was computed.
        return f"{round(value, 12) + 0.0:.4g}" if math.isfinite(value) else "-"
    if hasattr(value, "__iter__"):
        return ", ".join(_cell(item) for item in value)
    return str(value)
