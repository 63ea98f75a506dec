"""The stroke through one configuration: how far to wind up, on what curve, and how to stop."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from hitjoints.built import kernel_for
from hitjoints.swings.clear_way import Obstacle, Room
from hitjoints.swings.curves import Joints, Stroke, slowing_down, winding_up
from hitjoints.swings.hit_samples import COAST
from hitjoints.swings.impact_state import StateAtHit
from hitjoints.swings.motion_limits import torques
from hitjoints.swings.ramps import Ramp, least_time, ramp_of
from hitjoints.swings.wind_ups import FACTORS, RUN_UP, WindUpFamilies, WindUps

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from hitjoints.hit import Hit
    from hitjoints.hitting.drive_limits import DriveLimits
    from hitjoints.model.robot import Robot
    from hitjoints.types import Array

STRAIGHT, SIDEWAYS = 0.03, 4e-3
"""m, on the last of the way the contact is no more than so much off the line."""
NEAR, ANGLE = 5e-3, 2.5
"""m and deg, the direction is no more than so much off from there on."""
LATE = (3.0, 2.2, 1.7, 1.35, 1.15, 1.0, 0.5)
"""Times at which the direction is looked at besides, in units of what the last of that takes."""
MOMENTS = 38
"""Of a wind-up or a stop that are looked at."""
COLLISION = "collision"
ASTRAY = {"no run-up", "not towards the object", "sideways", "direction"}
"""What is in the way of a wind-up whose contact does not come straight."""
USED = 0.97
"""Share of the torque limits used: there are moments between those looked at."""


class StrokeSearch:
    """Searches strokes of one arm for one hit.

    Args:
        robot: the arm and the hit.
        hit: the arm and the hit.
        limits: of its drives.
        room: what is around.
        rng: of curves that are drawn.
    """

    def __init__(
        self, robot: Robot, hit: Hit, limits: DriveLimits, room: Room, rng: np.random.Generator
    ) -> None:
        self._robot, self._hit, self._limits, self._room = robot, hit, limits, room
        self._rng, self._contact = rng, robot.contact(hit.chosen_contact)
        self._across = np.linalg.svd(hit.direction[None, :])[2][1:]
        self._seen = kernel_for(robot, (self._contact,), ("position", "jacobian"))

    def strokes(
        self, strike: StateAtHit, box: Obstacle | None
    ) -> Iterator[tuple[Stroke | None, str]]:
        """Yield strokes, straight ones first, or None and what is in the way: a word."""
        families = WindUpFamilies(self._robot, self._hit, self._limits, strike)
        stops: dict[bytes, tuple[Ramp | None, str]] = {}
        seen: set[str] = set()
        yield from self._tried(families.straight(), strike, box, stops, seen)
        if seen & ASTRAY:
            yield from self._tried(families.through_the_line(), strike, box, stops, seen)
        if COLLISION in seen:
            yield from self._tried(families.swerving(self._rng), strike, box, stops, seen)

    def _tried(
        self,
        family: WindUps,
        strike: StateAtHit,
        box: Obstacle | None,
        stops: dict[bytes, tuple[Ramp | None, str]],
        seen: set[str],
    ) -> Iterator[tuple[Stroke | None, str]]:
        joints, ahead, reasons = self._approaches(family, strike)
        for k, reason in enumerate(reasons):
            its = Joints(*(values[k] for values in joints))
            blocked = reason or self._unfit(its) or self._unclear(its.q, ahead[k], box)
            if blocked:
                seen.add(blocked)
                yield None, blocked
                continue
            curvature = family.curvature[k]
            # However it winds up, it goes on the same curve.
            curve = curvature.tobytes()
            if curve not in stops:
                stops[curve] = self._stop(strike, curvature)
            stop, blocked = stops[curve]
            ramp = Ramp(family.ramp.time[k], family.ramp.build[k])
            stroke = stop and Stroke(*strike[:2], curvature, ramp, COAST / strike.speed, stop)
            yield stroke, blocked

    def _approaches(self, family: WindUps, strike: StateAtHit) -> tuple[Joints, Array, list[str]]:
        """Return wind-ups along time (K, M, n), the way to the object (K, M) m, and what is wrong.

        Moments are even, with some more where the direction counts.
        """
        late = -np.array(LATE) * NEAR / strike.speed
        longest = family.ramp.time.max(axis=1, keepdims=True)
        even = longest * np.linspace(-1.0, 0.0, MOMENTS - len(late))
        moments = np.sort(np.concatenate((even, np.maximum(late, -longest)), axis=1), axis=1)
        ramp = Ramp(family.ramp.time[:, None], family.ramp.build[:, None])
        joints = winding_up(
            strike.q, strike.qd, family.curvature[:, None], ramp, moments[:, :, None]
        )
        ahead, checks = self._astray(joints)
        checks = {**self._beyond(joints), **checks}
        names, wrong = (*checks, ""), np.array([*checks.values(), np.ones(len(ahead), dtype=bool)])
        return joints, ahead, [names[int(i)] for i in np.argmax(wrong, axis=0)]

    def close(self, joints: Joints) -> tuple[int, str]:
        """Return the first moment of a motion (M, n) from where on what hits may touch the object.

        Args:
            joints: up to the impact.

        Returns:
            Its number, and how the motion does not come straight at the object, if so.
        """
        ahead, checks = self._astray(Joints(*(values[None] for values in joints)))
        return _close(ahead[0]), next((name for name, wrong in checks.items() if wrong[0]), "")

    def _beyond(self, joints: Joints) -> dict[str, NDArray[np.bool_]]:
        """Return which motions (K, M, n) leave which limits."""
        robot, limits = self._robot, self._limits
        q, qd, qdd, qddd = joints
        fast = (qd < limits.velocity_lower) | (qd > limits.velocity_upper)
        wrong = {
            "position limits": (q < robot.lower) | (q > robot.upper),
            "velocity limits": fast,
            "acceleration limits": np.abs(qdd) > limits.acceleration,
            "jerk limits": np.abs(qddd) > limits.jerk,
        }
        return {name: np.asarray(where.any(axis=(-2, -1))) for name, where in wrong.items()}

    def _astray(self, joints: Joints) -> tuple[Array, dict[str, NDArray[np.bool_]]]:
        """Return the way to the object (K, M) m, and which motions do not come straight at it."""
        h, shape = self._hit.direction, joints.q.shape
        seen = self._seen(joints.q.reshape(-1, shape[2]), h)
        offset = seen["position"][0].reshape(*shape[:2], 3) - self._hit.position
        J = seen["jacobian"][0].reshape(*shape[:2], 3, shape[2])
        velocity = (J @ joints.qd[:, :, :, None])[:, :, :, 0]
        ahead = -offset @ h
        aside = np.linalg.norm(offset @ self._across.T, axis=2)
        across = np.linalg.norm(velocity @ self._across.T, axis=2)
        askew = np.degrees(np.arctan2(across, velocity @ h))
        farther = np.diff(ahead, axis=1) >= 0
        wrong = {
            "wind-up beyond the object": (ahead[:, :-1] <= 0).any(axis=1),
            "no run-up": ahead.max(axis=1) < RUN_UP,
            "not towards the object": (farther & (ahead[:, 1:] <= RUN_UP)).any(axis=1),
            "sideways": ((aside > SIDEWAYS) & _from(ahead, STRAIGHT)).any(axis=1),
            "direction": ((askew > ANGLE) & _from(ahead, NEAR)).any(axis=1),
        }
        return ahead, wrong

    def _unfit(self, joints: Joints) -> str:
        used = np.abs(torques(self._robot, self._limits, joints))
        return "" if (used <= USED * self._limits.effort).all() else "torque"

    def _unclear(self, rows: Array, ahead: Array, box: Obstacle | None) -> str:
        """Tell whether a wind-up touches anything; on its last part what hits may touch the box."""
        first, room = _close(ahead), self._room
        for part, what in ((rows[:first], room.whole(box)), (rows[first:], box)):
            # Most of what touches does so at its beginning.
            if len(part) and (
                room.touches(part[0], what) or room.check(part, what).row is not None
            ):
                return COLLISION
        return ""

    def _stop(self, strike: StateAtHit, curvature: Array) -> tuple[Ramp | None, str]:
        """Return the fastest stop that fits, or None and what is in the way of the slowest."""
        robot, size = self._robot, np.maximum(np.abs(strike.qd), 1e-9)
        a, j = self._limits.acceleration_used / size, self._limits.jerk_used / size
        room = np.where(strike.qd > 0, robot.upper - strike.q, strike.q - robot.lower)
        coast, least = COAST / strike.speed, least_time(a, j)
        longest = 2.0 * (0.99 * room / size - coast)
        ramps = ramp_of(np.minimum(np.array(FACTORS)[:, None] * least.max(), longest), a, j)
        whole = coast + ramps.time.max(axis=1, keepdims=True)
        each = Ramp(ramps.time[:, None], ramps.build[:, None])
        moments = (whole * np.linspace(0.0, 1.0, MOMENTS))[:, :, None]
        joints = slowing_down(strike.q, strike.qd, curvature, coast, each, moments)
        beyond = self._beyond(joints)
        reason = ""
        for k in range(len(FACTORS)):
            its = Joints(*(values[k] for values in joints))
            reason = next((name for name, wrong in beyond.items() if wrong[k]), "")
            reason = reason or self._unfit(its)
            if not reason and self._room.check(its.q, None).row is not None:
                reason = COLLISION
            if not reason:
                return Ramp(ramps.time[k], ramps.build[k]), ""
        return None, f"stop: {reason}"


def _close(ahead: Array) -> int:
    near = ahead <= RUN_UP
    return int(np.argmax(near)) if near.any() else len(ahead)


def _from(ahead: Array, way: float) -> NDArray[np.bool_]:
    """Return the moments (K, M) from so far ahead (m) on, the last before that included."""
    near = ahead <= way
    near[:, :-1] |= near[:, 1:]
    return near
