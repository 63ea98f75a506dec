"""A motion that can be played: joints along time, when it strikes, and how the box moves then."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from hitjoints.errors import HitjointsError
from hitjoints.goals.landing import slide_after

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hitjoints.goals.slide_path import SlidePath
    from hitjoints.hit import Hit
    from hitjoints.model.robot import Robot
    from hitjoints.rollouts.record import Rollout
    from hitjoints.swings.swing_record import Swing
    from hitjoints.types import Array

RECORDED = "recorded hit"
LONGEST = 20.0
"""s after the hit, for which the box is watched."""


@dataclass(frozen=True, eq=False)
class Clip:
    """A motion of the arm, and of the box when it is hit.

    Attributes:
        kind: what it is, such as "swing".
        hit: that it makes, with what hits.
        times: (N,) s, ascending from 0.
        q: (N, n) rad.
        impact_time: s; None for a motion that hits nothing.
        speed: m/s, of the contact along the direction at the impact.
        slide: how the box moves from the impact on; None where that is not known.
        why: what keeps a controller from following it; empty when nothing does.
        shares: (N, n) by name, how much of a limit each joint takes; above 1 is beyond it.
        note: what is not as asked for, and why the box does not move.
    """

    kind: str
    hit: Hit
    times: Array
    q: Array
    impact_time: float | None = None
    speed: float | None = None
    slide: SlidePath | None = None
    why: str = ""
    shares: Mapping[str, Array] = field(default_factory=dict)
    note: str = ""

    @property
    def duration(self) -> float:
        """Until arm and box rest, s."""
        arm = float(self.times[-1])
        if self.slide is None or self.impact_time is None:
            return arm
        return max(arm, self.impact_time + min(self.slide.duration, LONGEST))

    def configuration(self, time: float) -> Array:
        """Return where the arm is at a time (s), (n,) rad; at its ends before and after."""
        return np.array([np.interp(time, self.times, column) for column in self.q.T])

    def moved(self, time: float) -> tuple[Array, float]:
        """Return how far the box has moved (3,) m, and turned (rad), at a time (s)."""
        if self.slide is None or self.impact_time is None:
            return np.zeros(3), 0.0
        place, turned = self.slide.at(time - self.impact_time)
        return np.append(place, 0.0), turned

    def share(self, time: float) -> dict[str, Array]:
        """Return how much of each limit each joint takes at a time (s), (n,) by name."""
        row = min(int(np.searchsorted(self.times, time)), len(self.times) - 1)
        return {name: rows[row] for name, rows in self.shares.items()}


def clip_of_swing(swing: Swing) -> Clip:
    """Return a swing to play; the box does not move until `with_slide`."""
    joints = swing.joints
    return Clip(
        "swing",
        swing.hit,
        swing.times,
        joints.q,
        swing.impact_time,
        swing.speed,
        why=swing.why,
        note="; ".join(swing.notes),
        shares=shares_of(swing.robot, joints.qd, swing.torque),
    )


def clip_of_rollout(result: Rollout) -> Clip:
    """Return a rollout to play; the box does not move until `with_slide`."""
    rows, impact = result.rows, result.impact
    return Clip(
        "rollout",
        result.hit,
        np.asarray(result.dt * np.arange(len(rows["q"]))),
        rows["q"],
        None if impact is None else impact.time,
        None if impact is None else impact.speed,
        why="; ".join(filter(None, (result.reason, result.why))),
        shares=shares_of(result.robot, rows["qd"], rows["torque"]),
    )


def shares_of(robot: Robot, qd: Array, torque: Array | None = None) -> dict[str, Array]:
    """Return velocities, and torques (N, n) where both are known, in units of their limits."""
    limit = np.where(qd > 0, robot.velocity_upper, -robot.velocity_lower)
    shares = {"velocity": np.abs(qd) / np.where(limit > 0, limit, math.inf)}
    if torque is not None:
        effort = robot.effort
        told = np.isfinite(effort) & (effort > 0)
        shares["torque"] = np.abs(torque) / np.where(told, effort, math.inf)
    return shares


def with_slide(robot: Robot, clip: Clip, hit: Hit) -> Clip:
    """Return the same motion, with the box moving when it is hit.

    Args:
        robot: the arm.
        clip: the motion.
        hit: with the restitution and the friction to slide with.
    """
    if clip.impact_time is None or clip.speed is None:
        return replace(clip, note="nothing is hit")
    try:
        q = clip.configuration(clip.impact_time)
        return replace(clip, slide=slide_after(robot, q, hit, clip.speed))
    except HitjointsError as error:
        return replace(clip, note="; ".join(filter(None, (clip.note, str(error)))))
