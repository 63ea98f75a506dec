"""Speeding up from rest: the S-curve with a jerk that is constant by parts."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from hitjoints.types import Array


class Progress(NamedTuple):
    """A way and its derivatives along time: of a unit speed, so the way is in s."""

    way: Array
    speed: Array
    acceleration: Array
    jerk: Array


class Ramp(NamedTuple):
    """From rest to unit speed in `time`, the acceleration built up and taken back in `build` each.

    Attributes:
        time: (n,) s, one ramp per joint; 0 < build <= time / 2.
        build: (n,) s, one ramp per joint; 0 < build <= time / 2.
    """

    time: Array
    build: Array

    def up(self, x: Array) -> Progress:
        """Return the progress (N, n) at times x (N, n) s since the start, within the ramp."""
        T, b = self.time, self.build
        A = 1.0 / (T - b)
        J = A / b
        x = np.clip(x, 0.0, T)
        y = T - x
        first, last = x < b, y < b
        m = x - b
        way = np.where(
            first,
            J * x**3 / 6,
            np.where(last, T / 2 - y + J * y**3 / 6, A * b**2 / 6 + A * b / 2 * m + A * m**2 / 2),
        )
        speed = np.where(first, J * x**2 / 2, np.where(last, 1 - J * y**2 / 2, A * b / 2 + A * m))
        acceleration = np.where(first, J * x, np.where(last, J * y, A))
        jerk = np.where(first, J, np.where(last, -J, 0.0))
        return Progress(way, speed, acceleration, jerk)

    def down(self, x: Array) -> Progress:
        """Return the progress (N, n) of the ramp run backwards, x (N, n) s after its start."""
        back = self.up(self.time - x)
        return Progress(self.time / 2 - back.way, back.speed, -back.acceleration, back.jerk)


def least_time(acceleration: Array, jerk: Array) -> Array:
    """Return the shortest times (n,) s of ramps to unit speed within limits (n,) per unit speed."""
    reached = jerk < acceleration**2  # unit speed before the greatest acceleration is built up
    with np.errstate(divide="ignore"):
        return np.where(reached, 2.0 / np.sqrt(jerk), 1.0 / acceleration + acceleration / jerk)


def ramp_of(time: Array, acceleration: Array, jerk: Array) -> Ramp:
    """Return the ramps of given times (n,) s that keep limits (n,) per unit speed.

    Of those that do, the one whose acceleration is built up over a quarter of the time, or the
    nearest to it. A time below the least is taken for that.
    """
    T = np.maximum(time, least_time(acceleration, jerk))
    # J = 1 / ((T - b) b) <= jerk, and A = 1 / (T - b) <= acceleration.
    least = 0.5 * (T - np.sqrt(np.maximum(T**2 - 4.0 / jerk, 0.0)))
    most = np.minimum(0.5 * T, T - 1.0 / acceleration)
    return Ramp(T, np.clip(0.25 * T, np.minimum(least, most), most))
