"""A whole motion for a strike: there, through the impact, to rest; and whether it can be sent."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from hitjoints.swings.clear_way import Clear, Obstacle
from hitjoints.swings.curves import Joints, Motion, Piece, Standing, Stroke
from hitjoints.swings.impact_state import StateAtHit, impact_velocity
from hitjoints.swings.motion_limits import greatest_ratios, torques
from hitjoints.swings.stroke_search import StrokeSearch
from hitjoints.swings.way_there import way_there

if TYPE_CHECKING:
    from collections import Counter

    from hitjoints.swings.hit_samples import Samples
    from hitjoints.swings.swing_task import SwingTask
    from hitjoints.types import Array

SLOWEST, TOO_SLOW = 5e-3, "slower than 5 mm/s"
"""m/s, less speed at the impact would take minutes of winding up."""


class Struck(NamedTuple):
    """A motion that strikes.

    Attributes:
        row: of the samples, where it strikes.
        motion: from rest to rest.
        stroke: its part that strikes.
        sample: number of the one at the impact.
        box: the object as it is hit, None where shapes are not known.
    """

    row: int
    motion: Motion
    stroke: Stroke
    sample: int
    box: Obstacle | None


class StrikeMaker:
    """Makes motions of one arm for one hit.

    Args:
        task: what the swing is asked.
        dt: s, spacing of the samples.
        rng: of what is drawn.
        reasons: counts what is in the way.
    """

    def __init__(
        self,
        task: SwingTask,
        dt: float,
        rng: np.random.Generator,
        reasons: Counter[str],
    ) -> None:
        self.robot, self.hit, self.limits, self.room, self.start = task
        self.dt, self.rng, self.reasons = dt, rng, reasons
        self.search = StrokeSearch(self.robot, self.hit, self.limits, self.room, rng)

    def strike(
        self, samples: Samples, row: int, flux: float, box: Obstacle | None
    ) -> Struck | None:
        """Return a motion that strikes in the configuration of a row with a flux (m/s)."""
        most = (1.0 - 1e-9) * float(samples.flux[row])
        share = float(samples.inertia[row] / (samples.inertia[row] + self.hit.mass))
        speed = min(flux, most) / share
        if speed < SLOWEST:
            self.reasons[TOO_SLOW] += 1
            return None
        J, ends = samples.J[row], (samples.lower[row], samples.upper[row])
        qd = impact_velocity(J, self.hit.direction, *ends, speed)
        if qd is None:
            self.reasons["no certified velocity"] += 1
            return None
        strike = StateAtHit(samples.q[row], qd, J, speed)
        for stroke, reason in self.search.strokes(strike, box):
            whole = reason if stroke is None else self._whole(stroke, box)
            if not isinstance(whole, str):
                return Struck(row, *whole, box)
            self.reasons[whole] += 1
            if whole.startswith("way there"):
                break
        return None

    def _whole(self, stroke: Stroke, box: Obstacle | None) -> tuple[Motion, Stroke, int] | str:
        """Return the motion with this stroke, or what is in its way."""
        if not self._kept(stroke.at(stroke.corners)):
            return "limits, where a ramp is short"
        way = way_there(
            self.robot,
            self.limits,
            self.room,
            self.room.whole(box),
            self.start,
            stroke.start,
            self.rng,
        )
        if isinstance(way, str):
            return way
        before = sum(line.duration for line in way) + stroke.impact
        sample = math.ceil(before / self.dt - 1e-6)
        # The arm waits at first, so that the impact falls on a sample.
        waiting = Standing(self.start, max(sample * self.dt - before, 0.0))
        pieces: list[Piece] = [waiting, *way, stroke]
        whole = sum(piece.duration for piece in pieces)
        ended = math.ceil(whole / self.dt - 1e-6) + 1
        motion = Motion([*pieces, Standing(stroke.end, ended * self.dt - whole)])
        return motion, stroke, sample

    def _kept(self, joints: Joints) -> bool:
        """Tell whether positions, their derivatives and torques are within limits."""
        robot, limits = self.robot, self.limits
        inside = ((joints.q >= robot.lower) & (joints.q <= robot.upper)).all()
        if not inside or max(greatest_ratios(limits, joints)) > 1.0:
            return False
        return bool((np.abs(torques(robot, limits, joints)) <= limits.effort).all())

    def look(self, struck: Struck) -> tuple[str, Clear]:
        """Look at a whole motion densely: at every sample and between them.

        Returns:
            What is wrong, if anything, and what is nearest on the way.
        """
        robot, limits, motion = self.robot, self.limits, struck.motion
        step = min(self.dt, 1e-3) / 2
        times: Array = step * np.arange(int(motion.duration / step) + 1.0)
        joints = motion.at(times)
        nowhere = Clear(np.inf, "", None)
        if max(greatest_ratios(limits, joints)) > 1.0:
            return "limits, looked at densely", nowhere
        if ((joints.q < robot.lower) | (joints.q > robot.upper)).any():
            return "position limits, looked at densely", nowhere
        if (np.abs(torques(robot, limits, joints)) > limits.effort).any():
            return "torque, looked at densely", nowhere
        hit = round(struck.sample * self.dt / step)
        begun = hit - math.floor(struck.stroke.impact / step)
        close, astray = self.search.close(Joints(*(rows[begun : hit + 1] for rows in joints)))
        if astray:
            return f"{astray}, looked at densely", nowhere
        parts = (
            (joints.q[: begun + close + 1], self.room.whole(struck.box)),
            (joints.q[begun + close : hit + 1], struck.box),
            (joints.q[hit:], None),
        )
        seen = [self.room.check(rows, box, sharp=True) for rows, box in parts if len(rows)]
        clear = all(one.row is None for one in seen)
        nearest = min(seen, key=lambda one: one.least)
        return "" if clear else "collision, looked at densely", nearest
