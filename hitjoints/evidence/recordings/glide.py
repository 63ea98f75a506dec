"""The object after the hit: how fast it leaves, how far it slides, and with how much friction."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from hitjoints.constants import GRAVITY
from hitjoints.evidence.recordings import fits
from hitjoints.evidence.recordings.contact import REST_ROWS
from hitjoints.evidence.recordings.csv_table import RecordingError

if TYPE_CHECKING:
    from hitjoints.evidence.recordings.layout import Clock
    from hitjoints.types import Array


REST_SPEED, REST_TIME = 0.02, 0.1
"""m/s and s: an object slower than that over so long at the end has come to rest."""

LONG_ENOUGH = 0.2
"""s of sliding from which a deceleration can be told."""


@dataclass(frozen=True)
class Glide:
    """The object's motion after the hit.

    Attributes:
        speed: m/s along the hitting direction, mean of `fits.LENGTH`.
        time: s from the contact to the middle of those.
        direction_error: deg, between its velocity and the hitting direction.
        travel: m, from where it stood to where it is last seen.
        came_to_rest: within the recording.
        friction: coefficient of sliding friction; None if it cannot be told, with `no_friction`.
    """

    speed: float
    time: float
    direction_error: float
    travel: float
    came_to_rest: bool
    friction: float | None
    no_friction: str


def measure_glide(clock: Clock, position: Array, h: Array, contact: float) -> Glide:
    """Measure the object's motion.

    Args:
        clock: times of the rows.
        position: (N, 3) m.
        h: (3,) hitting direction.
        contact: s, on the same clock.

    Raises:
        RecordingError: too few rows after the contact.
    """
    line = fits.after(clock, position, contact, cover=fits.SHARE * fits.LENGTH)
    velocity, speed = line.slope, float(line.slope @ h)
    angle = math.atan2(float(np.linalg.norm(velocity - speed * h)), speed)
    end, still = position[-1], False
    try:
        last = fits.fit_line(clock, position, clock.time[-1] - REST_TIME, clock.time[-1])
        still = bool(np.linalg.norm(last.slope) < REST_SPEED)
        end = last.value if still else end
    except RecordingError:
        pass  # a gap at the end: where it is last seen is all there is
    friction, why = None, ""
    try:
        if still:
            friction = _by_travel(line, end)
        else:
            friction = _by_deceleration(clock, position, line, contact)
    except RecordingError as error:
        why = f"friction: {error}"
    start = np.median(position[:REST_ROWS], axis=0)
    travel = float(np.linalg.norm((end - start)[:2]))
    return Glide(speed, line.time - contact, math.degrees(angle), travel, still, friction, why)


def _by_travel(line: fits.FittedLine, end: Array) -> float:
    """Return v^2 / (2 g d): what it had left, spent over the rest of its way."""
    way = float(np.linalg.norm((end - line.value)[:2]))
    if way <= 0.0:
        raise RecordingError("it does not slide")
    return float(np.sum(line.slope[:2] ** 2)) / (2 * GRAVITY * way)


def _by_deceleration(clock: Clock, position: Array, line: fits.FittedLine, contact: float) -> float:
    """Return a / g of a parabola fitted to all rows once the robot no longer pushes."""
    start = contact + fits.PUSH
    sliding = clock.time >= start
    time = clock.time[sliding] - start
    if time[-1] < LONG_ENOUGH:
        raise RecordingError(
            f"the object is seen neither to come to rest nor to slide for {LONG_ENOUGH:g} s"
        )
    if clock.gap_within(start, float(clock.time[-1])) is not None:
        raise RecordingError("a gap lies in its slide")
    along = position[sliding] @ (line.slope / np.linalg.norm(line.slope))
    terms = np.vander(time, 3)
    found, residual, *_ = np.linalg.lstsq(terms, along, rcond=None)
    spread = float(residual[0]) / max(1, len(time) - 3) if residual.size else 0.0
    deviation = 2 * math.sqrt(spread * np.linalg.inv(terms.T @ terms)[0, 0])
    deceleration = -2 * float(found[0])
    if deceleration <= 3 * deviation:
        raise RecordingError(
            f"the deceleration, {deceleration:.2g} m/s^2, does not stand out from its deviation, "
            f"{deviation:.2g}"
        )
    return deceleration / GRAVITY
