"""The comparison as a table in Markdown or CSV."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterable
from dataclasses import fields
from typing import TYPE_CHECKING

from hitjoints.evidence.paper.claim_rows import ClaimRow

if TYPE_CHECKING:
    from hitjoints.evidence.paper.claim_rows import Value

COLUMNS = tuple(item.name for item in fields(ClaimRow))


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


def cells(row: ClaimRow) -> list[str]:
    """Return the row as text: the paper's number with its own digits, ours with three."""
    paper = f"{row.paper:g}" if isinstance(row.paper, float) else shown(row.paper)
    ours = (row.iiwa14_bullet, row.iiwa14, row.iiwa14_phantom)
    return [row.figure, row.quantity, paper, *map(shown, ours), row.remark]


def as_markdown(rows: Iterable[ClaimRow]) -> str:
    """Return the table as Markdown."""
    lines = ["| " + " | ".join(COLUMNS) + " |", "| " + " | ".join("---" for _ in COLUMNS) + " |"]
    for row in rows:
        escaped = (cell.replace("|", "\\|") for cell in cells(row))
        lines.append("| " + " | ".join(escaped) + " |")
    return "\n".join(lines) + "\n"


def as_csv(rows: Iterable[ClaimRow]) -> str:
    """Return the table as CSV, every digit kept."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(COLUMNS)
    writer.writerows(row.as_dict().values() for row in rows)
    return text.getvalue()
