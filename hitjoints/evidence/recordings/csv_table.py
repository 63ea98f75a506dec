"""Read a recording's CSV file: named columns, a field holding one number or several."""

from __future__ import annotations

import csv
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from hitjoints.errors import HitjointsError

if TYPE_CHECKING:
    from hitjoints.types import Array

TIME = "RosTime"

LARGEST = 1e12
"""No time, position or inertia of a recording in SI units is larger."""


class RecordingError(HitjointsError):
    """A recording, or a part of it, cannot be used; the text says why."""


@dataclass(frozen=True, eq=False)
class CsvTable:
    """The columns of a file that were asked for.

    Attributes:
        columns: name -> (N, k) numbers; only those that are there and whole.
        faults: name -> what is wrong with a column that was asked for.
        words: name -> the first row's text, for columns that hold no numbers.
        facts: name -> value of the pairs in the line above the header, if there is one.
        notes: what was left out.
    """

    columns: dict[str, Array]
    faults: dict[str, str]
    words: dict[str, str]
    facts: dict[str, str] = field(default_factory=dict)
    notes: tuple[str, ...] = ()

    def column(self, name: str) -> Array:
        """Return a column that has to be there.

        Raises:
            RecordingError: it is missing or faulty; the text names it.
        """
        if name in self.faults:
            raise RecordingError(self.faults[name])
        return self.columns[name]


def read_table(
    path: Path, widths: Mapping[str, int | None], words: tuple[str, ...] = ()
) -> CsvTable:
    """Read the columns of a recording.

    Args:
        path: of the file.
        widths: how many numbers a field of each wanted column holds; None: as many as in the first.
        words: columns of text.

    Raises:
        RecordingError: it cannot be read, is empty, not text, has no header or a row is cut short.
    """
    lines = _lines(path)
    try:
        rows = list(csv.reader(lines))
    except csv.Error as error:
        raise RecordingError(f"it is not a CSV file ({error})") from None
    header_at = next((i for i, row in enumerate(rows[:2]) if TIME in map(str.strip, row)), None)
    if header_at is None:
        raise RecordingError(f"it is no recording: no column {TIME} in its first two lines")
    header = [name.strip() for name in rows[header_at]]
    facts = rows[0] if header_at else []
    body = [(i + 1, row) for i, row in enumerate(rows) if i > header_at and row]
    notes = []
    if body and len(body[-1][1]) < len(header):
        notes.append(f"line {body[-1][0]}, the last, is cut short: left out")
        body.pop()
    if not body:
        raise RecordingError("it has no rows")
    for line, row in body:
        if len(row) < len(header):
            raise RecordingError(f"line {line} has {len(row)} fields, the header {len(header)}")
    columns, faults = {}, {}
    for name, width in widths.items():
        if name not in header:
            faults[name] = f"there is no column {name}"
            continue
        at = header.index(name)
        try:
            columns[name] = _numbers(name, [(line, row[at]) for line, row in body], width)
        except RecordingError as error:
            faults[name] = str(error)
    texts = {name: body[0][1][header.index(name)].strip() for name in words if name in header}
    pairs = {name.strip(): value for name, value in zip(facts[::2], facts[1::2], strict=False)}
    return CsvTable(columns, faults, texts, pairs, tuple(notes))


def _lines(path: Path) -> list[str]:
    try:
        text = path.read_bytes().decode("utf-8-sig")
    except OSError as error:
        raise RecordingError(f"it cannot be read ({error.strerror})") from None
    except UnicodeDecodeError as error:
        raise RecordingError(f"it is not text (byte {error.start} is not UTF-8)") from None
    if not text.strip():
        raise RecordingError("it is empty")
    return text.splitlines()


def _numbers(name: str, fields: list[tuple[int, str]], width: int | None) -> Array:
    """Return a column's numbers, (N, width)."""
    rows = []
    for line, text in fields:
        try:
            row = [float(word) for word in text.split()]
        except ValueError:
            raise RecordingError(
                f"line {line}, column {name}: {text[:40]!r} is no number"
            ) from None
        width = len(row) if width is None else width
        if len(row) != width or not row:
            if not any(text.strip() for _, text in fields):
                raise RecordingError(f"the column {name} is empty")
            expected = f"{width} expected" if width else "at least one expected"
            raise RecordingError(f"line {line}, column {name}: {len(row)} numbers, {expected}")
        rows.append(row)
    numbers = np.array(rows)
    wrong = ~(np.abs(numbers) <= LARGEST).all(axis=1)
    if wrong.any():
        line, text = fields[int(np.argmax(wrong))]
        raise RecordingError(f"line {line}, column {name}: {text.strip()[:60]} is not usable")
    return numbers
