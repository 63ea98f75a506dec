"""The comparison as a table in Markdown or CSV."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterable
from dataclasses import fields
from typing import TYPE_CHECKING

from hitjoints.evidence.paper.rows import Row

if TYPE_CHECKING:
    from hitjoints.evidence.paper.rows import Value

COLUMNS = tuple(item.name for item in fields(Row))


def shown(value: Value) -> str:
    """Return a value with three digits; a dash for what there is none of."""
    if value is None:
        return "-"
    if isinstance(value, float):
        if value and abs(value) < 1e-6:  # what rounding leaves of a zero
            return "0"
        digits = max(0, 2 - math.floor(math.log10(abs(value)))) if value else 0
        return f"{value:.{digits}f}"
    return str(value)


def as_markdown(rows: Iterable[Row]) -> str:
    """Return the table as Markdown."""
    lines = ["| " + " | ".join(COLUMNS) + " |", "| " + " | ".join("---" for _ in COLUMNS) + " |"]
    for row in rows:
        cells = (shown(value).replace("|", "\\|") for value in row.as_dict().values())
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def as_csv(rows: Iterable[Row]) -> str:
    """Return the table as CSV, every digit kept."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(COLUMNS)
    writer.writerows(row.as_dict().values() for row in rows)
    return text.getvalue()
