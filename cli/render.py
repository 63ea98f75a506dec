"""What the commands print on stdout: tables and text for people, JSON for programs."""

from __future__ import annotations

import json
import math
import sys
import textwrap
from collections.abc import Iterable, Sequence
from typing import Any

from .complaints import columns, pause, printable

GAP = 3
"""Columns between two of a table."""
WORDS = 14
"""Columns that a cell of words is left at least, where a table is too wide."""
LIST = 24
"""Columns of a list that stays on one line."""


def print_json(result: dict[str, Any]) -> None:
    """Print one JSON object; what is not a finite number becomes null."""
    pause()
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


def say(text: str) -> None:
    """Print a text in lines of the terminal's width, those that continue one indented."""
    pause()
    for line in text.splitlines() or [""]:
        print("\n".join(wrapped(printable(line), columns(), "  ")))


def print_table(
    title: str,
    names: Sequence[str],
    rows: Iterable[Sequence[object]],
    caption: str | None = None,
) -> None:
    """Print a table with one line per row; numbers with four digits.

    What is too wide for the terminal has its words broken into lines first, and then goes on
    below, with the first column again: no number is ever cut.
    """
    pause()
    width = columns()
    cells = [[printable(_cell(value)) for value in row] for row in rows]
    print("\n".join(wrapped(printable(title), width)))
    for part in _parts([list(names), *cells], width):
        print()
        for line in _drawn(part, width):
            print(line.rstrip())
    print("\n".join(["", *wrapped(caption, width), ""] if caption else [""]), flush=True)


def wrapped(text: str, width: int, indent: str = "") -> list[str]:
    """Return a text in lines of a width; what has no spaces, as a list to copy, stays whole."""
    return textwrap.wrap(
        text, width, subsequent_indent=indent, break_long_words=False, break_on_hyphens=False
    ) or [""]


def _parts(table: list[list[str]], width: int) -> list[list[list[str]]]:
    """Return tables of a width that a table is made of, columns beside each other."""
    least = [_least_of(column) for column in zip(*table, strict=True)]
    parts: list[list[list[str]]] = []
    start = 1
    while start < len(least) or not parts:
        stop, used = start, least[0]
        while stop < len(least) and (stop == start or used + GAP + least[stop] <= width):
            used += GAP + least[stop]
            stop += 1
        parts.append([[row[0], *row[start:stop]] for row in table])
        start = stop
    return parts


def _least_of(column: Sequence[str]) -> int:
    """Return the width that a column needs: its heading is broken wherever it can be."""
    return max([*map(len, column[0].split()), *map(_least, column[1:])])


def _least(cell: str) -> int:
    """Return the width that a cell needs: of words the longest one, of numbers all."""
    if not _is_words(cell) and len(cell) <= LIST:
        return len(cell)
    return max([min(len(cell), WORDS), *map(len, cell.split())])


def _is_words(cell: str) -> bool:
    return " " in cell and any(word.isalpha() and len(word) > 2 for word in cell.split())


def _drawn(table: list[list[str]], width: int) -> Iterable[str]:
    """Return the lines of a table: its head, a rule, and a row or more for each."""
    columns_of = list(zip(*table, strict=True))
    widths = [max(map(len, column)) for column in columns_of]
    least = [_least_of(column) for column in columns_of]
    while sum(widths) + GAP * (len(widths) - 1) > width and widths != least:
        widest = max(range(len(widths)), key=lambda i: widths[i] - least[i])
        widths[widest] -= 1
    right = [i > 0 and not any(map(_is_words, column[1:])) for i, column in enumerate(columns_of)]
    for number, row in enumerate(table):
        broken = [wrapped(cell, size) for cell, size in zip(row, widths, strict=True)]
        for k in range(max(map(len, broken))):
            line = [
                (lines[k] if k < len(lines) else "").rjust(size)
                if at_right
                else (lines[k] if k < len(lines) else "").ljust(size)
                for lines, size, at_right in zip(broken, widths, right, strict=True)
            ]
            yield (" " * GAP).join(line)
        if number == 0:
            yield _rule() * (sum(widths) + GAP * (len(widths) - 1))


def _rule() -> str:
    """Return what a line is drawn with, as far as stdout has letters for it."""
    try:
        "\u2500".encode(getattr(sys.stdout, "encoding", None) or "utf-8")
    except UnicodeEncodeError:
        return "-"
    return "\u2500"


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
