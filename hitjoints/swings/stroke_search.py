"""The stroke through one configuration: how far to wind up, on what curve, and how to stop."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from hitjoints.built import kernel_for
from hitjoints.quantities import place_joint
from hitjoints.swings.clear_way import Obstacle, Room
from hitjoints.swings.curves import Joints, Stroke, winding_up
from hitjoints.swings.hit_samples import COAST
from hitjoints.swings.impact_state import straightening
from hitjoints.swings.motion_limits import greatest_ratios, torques
from hitjoints.swings.ramps import Ramp, least_time, ramp_of

if TYPE_CHECKING:
    from hitjoints.hit import Hit
    from hitjoints.hitting.drive_limits import DriveLimits
    from hitjoints.model.robot import Robot
    from hitjoints.types import Array

FACTORS = (1.0, 1.3, 1.7, 2.3, 3.2, 4.5)
"""Times of a wind-up or a stop that are tried, in units of the least."""
RUN_UPS = (0.055, 0.075, 0.11)
"""m, ways of the contact whose wind-ups are tried besides."""
RUN_UP = 0.05
"""m, how far before the object the contact begins at least, and comes nearer all the time."""
STRAIGHT, SIDEWAYS = 0.03, 4e-3
"""m, on the last of the way the contact is no more than so much off the line."""
NEAR, ANGLE = 5e-3, 2.5
"""m and deg, the direction is no more than so much off from there on."""
COARSE, FINE = 32, 160
"""Moments of a stroke that are looked at: for limits and path, and for clearance."""
AT_LIMIT, BENDING = 0.97, 0.8
"""Share of its velocity limit above which a joint does not slow down towards the impact, and of the
acceleration limits that bending may take."""
USED = 0.97
"""Share of the torque limits used: there are moments between those looked at."""


class FoundStroke(NamedTuple):
    """A configuration and its joint velocity at the impact.

    Attributes:
        q: (n,) rad.
        qd: (n,) rad/s.
        J: (3, n) m/rad.
        speed: m/s along the direction.
    """

    q: Array
    qd: Array
    J: Array
    speed: float


class StrokeSearch:
    """Searches strokes of one arm for one hit; `reasons` counts what was in the way.

    Args:
        robot: the arm and the hit.
        hit: the arm and the hit.
        limits: of its drives.
        room: what is around.
    """

    def __init__(self, robot: Robot, hit: Hit, limits: DriveLimits, room: Room) -> None:
        self._robot, self._hit, self._limits, self._room = robot, hit, limits, room
        self._contact = robot.contact(hit.chosen_contact)
        self._across = np.linalg.svd(hit.direction[None, :])[2][1:]
        self._seen = kernel_for(robot, (self._contact,), ("position", "jacobian"))

    def strokes(self, strike: FoundStroke, box: Obstacle | None) -> Iterator[tuple[Stroke, str]]:
        """Yield strokes, straight ones first, each with what is in its way: nothing, or a word."""
        coast = COAST / strike.speed
        for curves in (self._bent, self._lines, self._through_the_line):
            tried = [
                Stroke(strike.q, strike.qd, curvature, wind_up, coast, wind_up)
                for curvature, wind_up in curves(strike)
            ]
            for stroke, reason in zip(tried, self._approaches(tried, strike), strict=True):
                blocked = reason or self._wind_up_clear(stroke, box)
                yield (stroke, blocked) if blocked else self._stopped(stroke, strike)

    def _bent(self, strike: FoundStroke) -> Iterator[tuple[Array, Ramp]]:
        """Yield parabolas whose contact's path curves sideways at the impact as little as can be.

        Joints at their velocity limits cannot come from a higher velocity, and none can bend more
        than its acceleration allows.
        """
        limits, v = self._limits, strike.qd
        top = np.where(v > 0, limits.velocity_upper, -limits.velocity_lower)
        widths, given = limits.acceleration.copy(), (self._contact, self._hit.direction, strike.J)
        for _ in range(3):
            bent = straightening(self._robot, strike.q, v, *given, widths)
            faster = (np.abs(v) > AT_LIMIT * top) & (bent * v < 0)
            if not faster.any():
                break
            widths[faster] = 0.0
        bent[faster] = 0.0
        bent *= min(1.0, BENDING / float(np.max(np.abs(bent) / limits.acceleration, initial=1e-9)))
        yield from ((bent, wind_up) for wind_up in self._wind_ups(strike, individual=False))
        yield from ((bent, wind_up) for wind_up in self._wind_ups(strike, individual=True))

    def _lines(self, strike: FoundStroke) -> Iterator[tuple[Array, Ramp]]:
        """Yield lines, each joint winding up as long as its room allows."""
        line = np.zeros_like(strike.q)
        return ((line, wind_up) for wind_up in self._wind_ups(strike, individual=True))

    def _through_the_line(self, strike: FoundStroke) -> Iterator[tuple[Array, Ramp]]:
        """Yield parabolas that begin where the contact would be if it came all the way straight."""
        ramps = self._wind_ups(strike, individual=False)
        s = np.array([0.5 * ramp.time[0] for ramp in ramps])[:, None]
        behind = self._hit.position - s * strike.speed * self._hit.direction
        begun = place_joint(self._robot, self._contact, behind, start=strike.q).q
        return zip(2.0 * (begun - strike.q + strike.qd * s) / s**2, ramps, strict=True)

    def _wind_ups(self, strike: FoundStroke, *, individual: bool) -> list[Ramp]:
        size = np.maximum(np.abs(strike.qd), 1e-9)
        a, j = self._limits.acceleration_used / size, self._limits.jerk_used / size
        least = least_time(a, j)
        robot, up = self._robot, strike.qd > 0
        most = np.full(robot.n, np.inf)
        if individual:
            most = 2.0 * 0.99 * np.where(up, strike.q - robot.lower, robot.upper - strike.q) / size
        times = {float(least.max()) * factor for factor in FACTORS}
        times |= {2.0 * way / strike.speed for way in RUN_UPS}
        longest = FACTORS[-1] * max(float(least.max()), 2.0 * RUN_UP / strike.speed)
        return [
            ramp_of(np.minimum(T, most), a, j)
            for T in sorted(times)
            if float(least.max()) <= T <= longest
        ]

    def _approaches(self, tried: list[Stroke], strike: FoundStroke) -> Iterator[str]:
        """Yield what is in the way of each wind-up: limits, path, torques."""
        if not tried:
            return
        late = -np.array([2.0, 1.2, 1.0, 0.5]) * NEAR / strike.speed
        longest = np.array([[stroke.impact] for stroke in tried])
        even = longest * np.linspace(-1.0, 0.0, COARSE - len(late))
        moments = np.sort(np.concatenate((even, np.maximum(late, -longest)), axis=1), axis=1)
        ramp = Ramp(
            *(np.array(part)[:, None] for part in zip(*(s.wind_up for s in tried), strict=True))
        )
        curvature = np.array([stroke.curvature for stroke in tried])[:, None]
        all_joints = winding_up(strike.q, strike.qd, curvature, ramp, moments[:, :, None])
        shape = all_joints.q.shape
        seen = self._seen(all_joints.q.reshape(-1, shape[2]), self._hit.direction)
        positions = seen["position"][0].reshape(*shape[:2], 3)
        jacobians = seen["jacobian"][0].reshape(*shape[:2], 3, shape[2])
        for joints, where, J in zip(
            zip(*all_joints, strict=True), positions, jacobians, strict=True
        ):
            its = Joints(*joints)
            reason = self._within(its) or self._straight(its, where, J)
            yield reason or ("" if self._torques_fit(its) else "torque")

    def _within(self, joints: Joints) -> str:
        robot = self._robot
        if ((joints.q < robot.lower) | (joints.q > robot.upper)).any():
            return "position limits"
        ratios = greatest_ratios(self._limits, joints)
        names = ("velocity limits", "acceleration limits", "jerk limits")
        return next((name for name, ratio in zip(names, ratios, strict=True) if ratio > 1.0), "")

    def _straight(self, joints: Joints, where: Array, J: Array) -> str:
        h = self._hit.direction
        ahead = (self._hit.position - where) @ h
        if (ahead[:-1] <= 0).any():
            return "wind-up beyond the object"
        if ahead.max() < RUN_UP:
            return "no run-up"
        nearer = np.diff(ahead) < 0
        if not nearer[ahead[1:] <= RUN_UP].all():
            return "not towards the object"
        aside = np.linalg.norm((where - self._hit.position) @ self._across.T, axis=1)
        if (aside[ahead <= STRAIGHT] > SIDEWAYS).any():
            return "sideways"
        velocity = (J @ joints.qd[:, :, None])[:, :, 0]
        near = ahead <= 1.01 * NEAR
        across = np.linalg.norm(velocity[near] @ self._across.T, axis=1)
        if (np.degrees(np.arctan2(across, velocity[near] @ h)) > ANGLE).any():
            return "direction"
        return ""

    def _torques_fit(self, joints: Joints) -> bool:
        used = np.abs(torques(self._robot, self._limits, joints))
        return bool((used <= USED * self._limits.effort).all())

    def _wind_up_clear(self, stroke: Stroke, box: Obstacle | None) -> str:
        rows = stroke.at(np.linspace(0.0, stroke.impact, FINE)).q
        first = 0
        if box is not None:
            where = self._seen(rows, self._hit.direction)["position"][0]
            far = (self._hit.position - where) @ self._hit.direction > RUN_UP
            first = int(np.argmin(far)) if not far.all() else len(rows)
            if first and self._room.check(rows[:first], self._room.whole(box)).row is not None:
                return "collision"
        if first < len(rows) and self._room.check(rows[first:], box).row is not None:
            return "collision"
        return ""

    def _stopped(self, stroke: Stroke, strike: FoundStroke) -> tuple[Stroke, str]:
        """Return the stroke with the fastest stop that fits."""
        robot, size = self._robot, np.maximum(np.abs(strike.qd), 1e-9)
        a, j = self._limits.acceleration_used / size, self._limits.jerk_used / size
        room = np.where(strike.qd > 0, robot.upper - strike.q, strike.q - robot.lower)
        least, most = least_time(a, j), 2.0 * (0.99 * room / size - stroke.coast)
        reason = ""
        for factor in FACTORS:
            ramp = ramp_of(np.minimum(factor * least.max(), most), a, j)
            whole = Stroke(
                stroke.q_hit, stroke.velocity, stroke.curvature, stroke.wind_up, stroke.coast, ramp
            )
            joints = whole.at(np.linspace(whole.impact, whole.duration, COARSE))
            reason = self._within(joints) or ("" if self._torques_fit(joints) else "torque")
            if not reason:
                rows = whole.at(np.linspace(whole.impact, whole.duration, FINE)).q
                blocked = self._room.check(rows, None).row is not None
                reason = "collision" if blocked else ""
            if not reason:
                return whole, ""
        return stroke, f"stop: {reason}"
