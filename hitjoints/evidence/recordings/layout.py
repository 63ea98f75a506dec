"""What the files of a recorded hit hold: the layout of epfl-lasa/air_hockey.

A robot's file has a line of facts (`DesiredFlux,<v>,HitTime,<t>,DesiredPos,<x y z>`), a header and
rows at 200 Hz; an object's file a header and rows. The numbers of a vector are separated by spaces.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from hitjoints.evidence.recordings.csv_table import TIME, CsvTable, RecordingError, read_table

if TYPE_CHECKING:
    from hitjoints.types import Array

RECORDED = {
    "EEF_Position": 3,
    "EEF_Velocity": 3,
    "Inertia": 9,
    "DirGrad": None,
    "HittingFlux": 1,
}
"""Columns of the recorder's own quantities: compared with the model's, but not needed."""

OBJECT_COLUMNS = ("PositionForIiwa7", "PositionForIiwa14")
"""Both are in the base frame of the iiwa 7; the first that is there is taken."""

GAP = 3.0
"""A step longer than this many usual ones is a gap."""


@dataclass(frozen=True, eq=False)
class Clock:
    """The times of a recording's rows.

    Attributes:
        time: (N,) s, on the recorder's clock, ascending.
        step: s, the usual one.
        gaps: (start, end), s, of every longer one.
    """

    time: Array
    step: float
    gaps: tuple[tuple[float, float], ...]

    def gap_within(self, start: float, stop: float) -> tuple[float, float] | None:
        """Return the first gap that overlaps a span of time."""
        return next(((a, b) for a, b in self.gaps if a < stop and b > start), None)


@dataclass(frozen=True, eq=False)
class RobotRecording:
    """A robot's file.

    Attributes:
        name: what the recorder calls the robot, such as IIWA_14; empty if it does not say.
        clock: times of the rows.
        q: (N, n) rad.
        qd: (N, n) rad/s.
        recorded: column name -> (N, k), those of `RECORDED` that are there and whole.
        desired_flux: m/s.
        hit_time: s, the recorder's; later than the contact. None if not given.
        notes: what is missing, one sentence each.
    """

    name: str
    clock: Clock
    q: Array
    qd: Array
    recorded: dict[str, Array]
    desired_flux: float | None
    hit_time: float | None
    notes: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class ObjectRecording:
    """An object's file: clock, positions (N, 3) m, and what is wrong with it."""

    clock: Clock
    position: Array
    notes: tuple[str, ...]


def read_robot(path: Path) -> RobotRecording:
    """Read a robot's file.

    Raises:
        RecordingError: it cannot be read, or time or joints are missing or faulty.
    """
    needed = {TIME: 1, "JointPosition": None, "JointVelocity": None}
    table = read_table(path, needed | RECORDED, words=("RobotName",))
    clock = _clock(table)
    q, qd = table.column("JointPosition"), table.column("JointVelocity")
    if q.shape != qd.shape:
        raise RecordingError(f"{q.shape[1]} joint positions, but {qd.shape[1]} velocities")
    recorded = {name: table.columns[name] for name in RECORDED if name in table.columns}
    missing = [table.faults[name] for name in RECORDED if name in table.faults]
    return RobotRecording(
        table.words.get("RobotName", ""),
        clock,
        q,
        qd,
        recorded,
        _fact(table, "DesiredFlux"),
        _fact(table, "HitTime"),
        (*table.notes, *missing, *_gap_notes(clock)),
    )


def read_object(path: Path) -> ObjectRecording:
    """Read an object's file.

    Raises:
        RecordingError: it cannot be read, or time or position are missing or faulty.
    """
    table = read_table(path, {TIME: 1} | dict.fromkeys(OBJECT_COLUMNS, 3))
    clock = _clock(table)
    name = next((name for name in OBJECT_COLUMNS if name in table.columns), OBJECT_COLUMNS[0])
    return ObjectRecording(clock, table.column(name), (*table.notes, *_gap_notes(clock)))


def _clock(table: CsvTable) -> Clock:
    time = table.column(TIME)[:, 0]
    steps = np.diff(time)
    if (steps < 0).any():
        row = int(np.argmax(steps < 0)) + 2
        raise RecordingError(f"{TIME} goes back at row {row}")
    step = float(np.median(steps)) if steps.size else 0.0
    if step <= 0:
        raise RecordingError(f"{TIME} does not advance" if steps.size else "it has one row only")
    wide = np.flatnonzero(steps > GAP * step)
    return Clock(time, step, tuple((float(time[i]), float(time[i + 1])) for i in wide))


def _gap_notes(clock: Clock) -> list[str]:
    at = [f"{b - a:.3g} s after {a - clock.time[0]:.3g} s" for a, b in clock.gaps]
    more = "" if len(at) <= 3 else f" and {len(at) - 3} more"
    return [f"gaps in {TIME}: {', '.join(at[:3])}{more}"] if at else []


def _fact(table: CsvTable, name: str) -> float | None:
    try:
        value = float(table.facts[name])
    except (KeyError, ValueError):
        return None
    return value if np.isfinite(value) else None
