"""Landings: how hard boxes were hit, how far they went, and how they stood."""

from __future__ import annotations

import csv
import math
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from hitjoints.errors import InputError

if TYPE_CHECKING:
    from hitjoints.evidence.recordings.replayed_hit import ReplayedHit

NEEDED = ("flux", "distance")
LEAST_DISTANCE = 0.01
"""m: a box that goes no further was not hit."""


class PastLanding(NamedTuple):
    """One hit and where the box stopped; nan is not known.

    Attributes:
        arm: its name, or what a table calls it.
        flux: m/s.
        distance: m, from start to end.
        offset: m, of the hit from the box's centre along the arm's x axis.
        yaw: rad, of the box before the hit.
        heading: rad, of the box's way, off the direction towards the arm's x axis.
        restitution: as measured in a recording.
        friction: likewise, between object and table.
    """

    arm: str
    flux: float
    distance: float
    offset: float = math.nan
    yaw: float = math.nan
    heading: float = math.nan
    restitution: float = math.nan
    friction: float = math.nan


class Landings(NamedTuple):
    """Landings, and what was left out of the files."""

    rows: tuple[PastLanding, ...]
    notes: tuple[str, ...]


def is_table(path: Path) -> bool:
    """Tell whether a file is a landing table: its first line names a flux and a distance."""
    try:
        with path.open(encoding="utf-8-sig", errors="replace") as file:
            header = [name.strip() for name in file.readline(10_000).split(",")]
    except OSError:
        return False
    return all(name in header for name in NEEDED)


def read_table(path: Path) -> Landings:
    """Read a landing table: a CSV file with a line per hit.

    Columns `flux` and `distance`; also `arm`, `hit_x` and `start_x`, `yaw_qz`, and `start_y`,
    `end_x`, `end_y`, where they are known.

    Raises:
        InputError: a row holds no numbers.
    """
    rows, missed = [], 0
    with path.open(encoding="utf-8-sig", newline="") as file:
        for line, row in enumerate(csv.DictReader(file), start=2):
            one = _landing(path, line, row)
            if one.flux > 0 and one.distance > LEAST_DISTANCE:
                rows.append(one)
            else:
                missed += 1
    notes = (
        [f"{path.name}: {missed} rows in which the box hardly moves: left out"] if missed else []
    )
    return Landings(tuple(rows), tuple(notes))


def _landing(path: Path, line: int, row: dict[str, str | None]) -> PastLanding:
    def number(name: str) -> float:
        text = row.get(name)
        if text is None or not text.strip():
            if name in NEEDED:
                raise InputError("file", f"{path} line {line}", f"a number in the column {name}")
            return math.nan
        try:
            value = float(text)
        except ValueError:
            value = math.nan
        if not math.isfinite(value):
            raise InputError("file", f"{path} line {line}", f"{name} = {text} is no finite number")
        return value

    half = number("yaw_qz")
    yaw = 2.0 * math.asin(half) if abs(half) <= 1 else math.nan
    across = number("end_x") - number("start_x")
    along = abs(number("end_y") - number("start_y"))
    return PastLanding(
        (row.get("arm") or "").strip() or "arm",
        number("flux"),
        number("distance"),
        number("hit_x") - number("start_x"),
        yaw,
        math.nan if math.isnan(across + along) else math.atan2(across, along),
    )


def from_recordings(hits: Iterable[ReplayedHit]) -> Landings:
    """Return the landings of recorded hits in which the box came to rest."""
    rows, left = [], 0
    for hit in hits:
        known = hit.flux is not None and hit.travel is not None and hit.came_to_rest
        if hit.ok and (known or hit.restitution is not None):
            rows.append(
                PastLanding(
                    hit.robot or "arm",
                    _or_nan(hit.flux),
                    _or_nan(hit.travel) if known else math.nan,
                    restitution=_or_nan(
                        hit.restitution
                        if hit.restitution_at_contact is None
                        else hit.restitution_at_contact
                    ),
                    friction=_or_nan(hit.friction),
                )
            )
        else:
            left += 1
    notes = [f"{left} recordings that cannot be used: left out"] if left else []
    return Landings(tuple(rows), tuple(notes))


def _or_nan(value: float | None) -> float:
    return math.nan if value is None else float(value)


def read(paths: Iterable[str | Path]) -> Landings:
    """Read landing tables, recordings, and folders of recordings.

    Raises:
        InputError: a file is not there or is neither, or nothing can be used.
    """
    from hitjoints.evidence.recordings.replayer import replay

    rows: list[PastLanding] = []
    notes: list[str] = []
    recordings = []
    for path in map(Path, paths):
        if not path.exists():
            raise InputError("file", path, "it is not there")
        if path.is_file() and is_table(path):
            found = read_table(path)
            rows, notes = [*rows, *found.rows], [*notes, *found.notes]
        else:
            recordings.append(path)
    if recordings:
        hits = replay(recordings).hits
        found = from_recordings(hits)
        if not found.rows:
            reason = next((hit.reason for hit in hits if hit.reason), "no recording in it")
            raise InputError("file", recordings[0], reason)
        rows, notes = [*rows, *found.rows], [*notes, *found.notes]
    if not rows:
        raise InputError("files", "none of their rows", "at least one hit that moved its box")
    return Landings(tuple(rows), tuple(notes))
