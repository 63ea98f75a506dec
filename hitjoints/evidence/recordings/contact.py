"""When the robot touches the object: the recorder's HitTime is 20 to 80 ms later than that."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from hitjoints.evidence.recordings import fits
from hitjoints.evidence.recordings.csv_table import RecordingError

if TYPE_CHECKING:
    from hitjoints.evidence.recordings.layout import Clock
    from hitjoints.types import Array

REST_ROWS = 3
"""Rows at the start whose median is where the object stands at first."""

REST_BEFORE = 20
"""Rows just before the hit, at most, whose median is where the object stands then."""

NEAR, STILL = 1e-3, 3e-4
"""m from where it stands at first, and then: motion capture wavers by a tenth of a millimetre."""

MOVED = 5e-3
"""m: an object that went this far has been hit."""

SLOW = 0.05
"""m/s: no hit object is slower."""

LATEST, EARLIEST = 0.0, 0.1
"""s before HitTime, between which the contact lies."""


class NotHitError(RecordingError):
    """The object stays where it is."""


class Touch(NamedTuple):
    """The first touch: time (s, the recorder's clock), and the signal that tells it."""

    time: float
    source: str


def from_object(clock: Clock, position: Array, h: Array) -> Touch:
    """Return when the object starts to move, to about one row.

    That is the last row in which it still stands, earlier by the time its speed after the hit would
    take for what little it has moved by then.

    Args:
        clock: times of the rows.
        position: (N, 3) m.
        h: (3,) hitting direction.

    Raises:
        NotHitError: it stays where it is.
        RecordingError: it moves against the direction, or already moves at the start.
    """
    ahead = (position - np.median(position[:REST_ROWS], axis=0)) @ h
    far = np.abs(ahead) > MOVED
    if not far.any():
        most = 1e3 * float(np.abs(ahead).max())
        raise NotHitError(f"no contact: the object moves by {most:.2g} mm at most")
    hit = int(np.argmax(far))
    near = np.flatnonzero(np.abs(ahead[:hit]) <= NEAR)
    if len(near) < REST_ROWS:
        raise RecordingError("the object already moves when the recording starts")
    if ahead[hit] < 0:
        raise RecordingError("the object moves against the hitting direction")
    end = int(near[-1]) + 1
    ahead -= np.median(ahead[max(0, end - REST_BEFORE) : max(REST_ROWS, end - 1)])
    still = np.flatnonzero(np.abs(ahead[:end]) <= STILL)
    last = int(still[-1]) if len(still) else end - 1
    time = float(clock.time[last])
    gap = clock.gap_within(time, float(clock.time[hit]))
    if gap is not None:
        raise RecordingError(f"the contact lies in a gap of {gap[1] - gap[0]:.3g} s")
    try:
        speed = float(fits.after(clock, ahead, time).slope[0])
    except RecordingError:
        return Touch(time, "object")
    return Touch(time - max(0.0, float(ahead[last])) / max(speed, SLOW), "object")


def from_robot(clock: Clock, speed: Array, hit_time: float | None) -> Touch:
    """Return when the robot starts to lose speed, to about 10 ms.

    Where its mean speed over three rows falls most within `fits.PUSH`, among the rows that are
    nearly as fast as the fastest and lie before HitTime, where that is known.

    Args:
        clock: times of the rows.
        speed: (N,) m/s along the hitting direction.
        hit_time: s.

    Raises:
        RecordingError: too few rows, or no loss of speed.
    """
    push = max(1, round(fits.PUSH / clock.step))
    if len(speed) < push + 6:
        raise RecordingError(f"{len(speed)} rows are too few to find the contact by the robot")
    mean = np.convolve(speed, np.ones(3) / 3, mode="valid")
    loss = mean[:-push] - mean[push:]
    time = clock.time[2 : 2 + len(loss)]
    candidates = mean[:-push] > 0.8 * mean.max()
    if hit_time is not None and time[0] < hit_time <= clock.time[-1] + EARLIEST:
        candidates &= (time >= hit_time - EARLIEST) & (time <= hit_time - LATEST)
    if not candidates.any() or loss[candidates].max() <= 0:
        raise RecordingError("no contact: the robot loses no speed")
    # A sudden loss is as great in any window around it: the last of these begins with it.
    greatest = np.flatnonzero(candidates & (loss >= 0.95 * loss[candidates].max()))[-1]
    return Touch(float(time[greatest]), "robot")
