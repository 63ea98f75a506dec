"""Speeds from lines fitted to rows: a latched signal must not be differenced from row to row."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from hitjoints.evidence.recordings.csv_table import RecordingError

if TYPE_CHECKING:
    from hitjoints.evidence.recordings.layout import Clock
    from hitjoints.types import Array

LENGTH = 0.040
"""s of rows that a line is fitted to."""

PUSH = 0.025
"""s after the first touch, within which the robot pushes on: no speed is read in it."""

SHARE = 0.75
"""of `LENGTH` that the rows must cover for the slope of a position."""

TOLERANCE = 1e-3  # s: the recorder's stamps waver by a fraction of a step


class FittedLine(NamedTuple):
    """A straight line through rows: value (k,) at `time` (s), the middle of the rows, and slope."""

    time: float
    value: Array
    slope: Array

    def at(self, time: float) -> Array:
        """Return the line's value (k,) at a time."""
        return np.asarray(self.value + self.slope * (time - self.time))


def fit_line(
    clock: Clock, values: Array, start: float, stop: float, *, least: int = 3, cover: float = 0.0
) -> FittedLine:
    """Fit a line to the rows from start to stop, by least squares.

    Args:
        clock: times of the rows.
        values: (N,) or (N, k).
        start: s.
        stop: s.
        least: rows needed.
        cover: s, from the first of the rows to the last.

    Raises:
        RecordingError: too few rows, or a gap among them.
    """
    gap = clock.gap_within(start, stop)
    if gap is not None:
        raise RecordingError(f"a gap of {gap[1] - gap[0]:.3g} s lies in the {stop - start:.3g} s")
    inside = (clock.time >= start - TOLERANCE) & (clock.time <= stop + TOLERANCE)
    time, rows = clock.time[inside], values.reshape(len(values), -1)[inside]
    covered = float(np.ptp(time)) if len(time) else 0.0
    if len(time) < least or covered < cover - TOLERANCE or covered == 0.0:
        raise RecordingError(
            f"{len(time)} rows in {covered:.3g} s are too few: at least {least} in "
            f"{max(cover, (least - 1) * clock.step):.2g} s are needed"
        )
    # Stamps count seconds since 1970: their mean has no digits to spare, that of the steps has.
    offset = time - time[0]
    middle = float(offset.mean())
    offset -= middle
    value = rows.mean(axis=0)
    slope = offset @ (rows - value) / (offset @ offset)
    return FittedLine(float(time[0]) + middle, value, slope)


def before(clock: Clock, values: Array, contact: float) -> FittedLine:
    """Fit a line to the last `LENGTH` before the contact, but for a row if there are enough.

    The contact is known to about a row, and in that row the robot may already lose speed.
    """
    try:
        guard = contact - clock.step
        return fit_line(clock, values, guard - LENGTH, guard)
    except RecordingError:
        return fit_line(clock, values, contact - LENGTH, contact)


def after(clock: Clock, values: Array, contact: float, cover: float = 0.0) -> FittedLine:
    """Fit a line to `LENGTH` once the robot no longer pushes."""
    start = contact + PUSH
    return fit_line(clock, values, start, start + LENGTH, cover=cover)
