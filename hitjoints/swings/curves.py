"""Pieces of a motion: standing still, going from rest to rest, and the stroke through the impact.

Each knows its joints at any time, with their first three derivatives: nothing is differenced.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple, Protocol

import numpy as np

from hitjoints.swings.ramps import Progress, Ramp, least_time, ramp_of

if TYPE_CHECKING:
    from hitjoints.hitting.drive_limits import DriveLimits
    from hitjoints.types import Array


BESIDE = 1e-9
"""s, as near as that a moment is looked at from both sides."""


class Joints(NamedTuple):
    """q, qd, qdd, qddd: (N, n) in rad, rad/s, rad/s^2, rad/s^3."""

    q: Array
    qd: Array
    qdd: Array
    qddd: Array


class Piece(Protocol):
    """A motion of some duration."""

    @property
    def duration(self) -> float:
        """How long it takes, s."""
        ...

    def at(self, times: Array) -> Joints:
        """Return the joints at times (N,) s from its start."""
        ...


@dataclass(frozen=True, eq=False)
class Standing:
    """Standing still.

    Attributes:
        q: (n,) rad.
        duration: s.
    """

    q: Array
    duration: float

    def at(self, times: Array) -> Joints:
        """Return the joints at times (N,) s."""
        still = np.zeros((len(times), self.q.size))
        return Joints(self.q + still, still, still, still)


@dataclass(frozen=True, eq=False)
class Line:
    """From rest to rest on a straight line in joint space.

    Attributes:
        start: (n,) rad.
        end: (n,) rad.
        ramp: of the unit speed, for speeding up and slowing down.
        cruise: s, at unit speed between them.
        slowness: how many times as long it takes all in all.
    """

    start: Array
    end: Array
    ramp: Ramp
    cruise: float
    slowness: float = 1.0

    @property
    def duration(self) -> float:
        """How long it takes, s."""
        return self.slowness * (2.0 * float(self.ramp.time[0]) + self.cruise)

    def at(self, times: Array) -> Joints:
        """Return the joints at times (N,) s."""
        k, T = self.slowness, float(self.ramp.time[0])
        x = np.asarray(times)[:, None] / k
        whole = T + self.cruise
        up, down = self.ramp.up(x), self.ramp.down(x - whole)
        steady = Progress(T / 2 + (x - T), np.ones_like(x), np.zeros_like(x), np.zeros_like(x))
        down = down._replace(way=down.way + T / 2 + self.cruise)
        way, speed, acceleration, jerk = (
            np.where(x < T, a, np.where(x < whole, b, c))
            for a, b, c in zip(up, steady, down, strict=True)
        )
        step = (self.end - self.start) / whole
        # From the nearer end: so both are met to the last bit.
        q = np.where(
            x < whole / 2 + T / 2, self.start + way * step, self.end - (whole - way) * step
        )
        return Joints(q, speed * step / k, acceleration * step / k**2, jerk * step / k**3)


def line_between(start: Array, end: Array, limits: DriveLimits) -> Line:
    """Return the fastest line (n,) to (n,) rad with S-curves within velocity, acceleration, jerk.

    In units of the whole way the joints share one profile, so the slowest of them sets it.
    """
    step = end - start
    size = np.maximum(np.abs(step), 1e-300)
    speed = float(np.min(np.where(step >= 0, limits.velocity_upper, -limits.velocity_lower) / size))
    a = float(np.min(limits.acceleration / size))
    j = float(np.min(limits.jerk / size))
    speed, a, j = (0.999999 * limit for limit in (speed, a, j))

    def time_at(speed: float) -> float:
        return float(least_time(np.array(a / speed), np.array(j / speed)))

    # Without a cruise the way is v T(v): it grows with v, so bisect where that is too much.
    if speed * time_at(speed) > 1.0:
        low, high = 0.0, speed
        for _ in range(60):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if middle * time_at(middle) <= 1.0 else (low, middle)
        speed = low
    T = time_at(speed)
    one = np.array([1.0])
    return Line(start, end, ramp_of(T * one, a / speed * one, j / speed * one), 1.0 / speed - T)


@dataclass(frozen=True, eq=False)
class Stroke:
    """Wind-up from rest, impact, a short coast, and the stop; the impact is at time `impact`.

    Joint i runs through q_hit + v s + c s^2 / 2, s its own way in units of time: its wind-up may
    be shorter than that of the others where it has less room, and then it waits at first.

    Attributes:
        q_hit: (n,) rad.
        velocity: (n,) rad/s, there.
        curvature: (n,) rad/s^2.
        wind_up: ramps of every joint.
        stop: ramps of every joint.
        coast: s, from the impact to the stop.
    """

    q_hit: Array
    velocity: Array
    curvature: Array
    wind_up: Ramp
    coast: float
    stop: Ramp

    @property
    def impact(self) -> float:
        """When the impact is, s from the start."""
        return float(self.wind_up.time.max())

    @property
    def duration(self) -> float:
        """How long it takes, s."""
        return self.impact + self.coast + float(self.stop.time.max())

    @property
    def corners(self) -> Array:
        """Moments (M,) s just before and after a joint's jerk changes, however short a ramp."""
        (T, b), (stop, c) = self.wind_up, self.stop
        done = self.impact + self.coast
        up, down = (-T, b - T, -b, 0.0 * T), (0.0 * stop, c, stop - c, stop)
        at = np.concatenate([self.impact + x for x in up] + [done + x for x in down])
        beside = np.concatenate((at - BESIDE, at + BESIDE, at))
        return np.asarray(np.clip(beside, 0.0, self.duration))

    @property
    def start(self) -> Array:
        """Where the wind-up begins, (n,) rad."""
        return np.asarray(self.at(np.zeros(1)).q[0])

    @property
    def end(self) -> Array:
        """Where the arm comes to rest, (n,) rad."""
        return np.asarray(self.at(np.array([self.duration])).q[0])

    def at(self, times: Array) -> Joints:
        """Return the joints at times (N,) s."""
        t = np.asarray(times)[:, None] - self.impact
        before = t[:, 0] < 0
        curve = self.q_hit, self.velocity, self.curvature
        up = winding_up(*curve, self.wind_up, t[before])
        down = slowing_down(*curve, self.coast, self.stop, t[~before])
        rows = np.argsort(np.concatenate((np.flatnonzero(before), np.flatnonzero(~before))))
        return Joints(*(np.concatenate(both)[rows] for both in zip(up, down, strict=True)))


def winding_up(q_hit: Array, velocity: Array, curvature: Array, ramp: Ramp, t: Array) -> Joints:
    """Return the joints of wind-ups at times t <= 0 before the impact, in s.

    The arguments are those of `Stroke`, and may be of many strokes at once: whatever fits t.
    """
    up = ramp.up(t + ramp.time)
    s, s1, s2, s3 = up._replace(way=up.way - ramp.time / 2)
    waiting = t + ramp.time < 0
    s2, s3 = (np.where(waiting, 0.0, value) for value in (s2, s3))
    return _along(q_hit, velocity, curvature, Progress(s, s1, s2, s3))


def slowing_down(
    q_hit: Array, velocity: Array, curvature: Array, coast: float, ramp: Ramp, t: Array
) -> Joints:
    """Return the joints of stops at times t >= 0 after the impact, in s; see `winding_up`.

    The velocity is kept for `coast` s at first.
    """
    down = ramp.down(t - coast)
    none, coasting = np.zeros_like(t), t <= coast
    steady = Progress(t, none + 1.0, none, none)
    down = down._replace(way=down.way + coast)
    s, s1, s2, s3 = (np.where(coasting, a, b) for a, b in zip(steady, down, strict=True))
    rests = t > coast + ramp.time
    s1, s2, s3 = (np.where(rests, 0.0, value) for value in (s1, s2, s3))
    return _along(q_hit, velocity, curvature, Progress(s, s1, s2, s3))


def _along(q: Array, v: Array, c: Array, progress: Progress) -> Joints:
    """Return the joints on q + v s + c s^2 / 2."""
    s, s1, s2, s3 = progress
    slope = v + c * s
    return Joints(
        q + v * s + 0.5 * c * s**2,
        slope * s1,
        slope * s2 + c * s1**2,
        slope * s3 + 3.0 * c * s1 * s2,
    )


@dataclass(frozen=True, eq=False)
class Motion:
    """Pieces one after the other, each beginning where and as the one before ends: at rest."""

    pieces: Sequence[Piece]

    @property
    def duration(self) -> float:
        """How long it takes, s."""
        return sum(piece.duration for piece in self.pieces)

    def at(self, times: Array) -> Joints:
        """Return the joints at times (N,) s."""
        times = np.asarray(times, dtype=float)
        ends = np.cumsum([piece.duration for piece in self.pieces])
        which = np.minimum(np.searchsorted(ends, times, side="right"), len(self.pieces) - 1)
        parts: list[Joints] = []
        order = np.argsort(which, kind="stable")
        for i, piece in enumerate(self.pieces):
            local = times[which == i] - (ends[i] - piece.duration)
            if local.size:
                parts.append(piece.at(np.clip(local, 0.0, piece.duration)))
        back = np.argsort(order, kind="stable")
        return Joints(*(np.concatenate(rows)[back] for rows in zip(*parts, strict=True)))
