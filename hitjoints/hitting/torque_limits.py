"""Torque limits on the way: what a step may change, and that the arm can always stop in time.

A motion within all limits now may leave no way to stay within them later: an arm that runs at a
position limit faster than its motors can stop it. So a step is taken only to a state from which
the arm can slow down to rest within torques and positions: from there another step is left, if
only the first of that way.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin

from hitjoints.errors import InfeasibleError, InputError
from hitjoints.programs.hitting_speed import step_bounds
from hitjoints.programs.joint_velocity import Terms
from hitjoints.programs.torque_rows import Impulses, with_impulses
from hitjoints.programs.warm import ROWS, WarmProgram

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from hitjoints.model.robot import Robot

    Array = NDArray[np.float64]

RESERVE = 0.05
"""Share of the effort limits that a way to stop leaves unused: it is checked at three points."""
LEAST = 0.05
"""Share of an effort limit that counts as left for braking, however much a motion takes."""
FORESIGHT = 0.8
"""Share of the present decelerations reckoned with for what comes: they change on the way."""
STILL = 1e-3
"""Share of a joint's greatest speed below which its stop is no moment of its own."""
ROUNDING = 1e-12
"""rad by which a position may seem to be beyond its limit."""
TINY = 1e-12
"""In place of zero where a ratio has no bound."""


class TorqueLimits:
    """The effort limits of an arm that is commanded every dt.

    Args:
        robot: the arm.
        dt: s.

    Raises:
        InputError: an effort limit is zero or not finite: the URDF does not tell it.
    """

    def __init__(self, robot: Robot, dt: float) -> None:
        for i in np.flatnonzero(~(np.isfinite(robot.effort) & (robot.effort > 0))):
            expected = "torque limits need finite effort limits above 0 N m for every joint"
            raise InputError("robot", f"{robot.name}, joint {i + 1}: {robot.effort[i]}", expected)
        self._robot, self._dt = robot, dt
        # A certified answer may miss a row by ROWS; the limit holds all the same.
        whole = dt * robot.effort
        self._limit = whole - np.minimum(2 * ROWS, RESERVE * whole)
        self._stop = np.zeros(robot.n)
        self._program = WarmProgram(2 * robot.n, robot.n)  # qd, p
        # A locked joint, of limit zero, stops at once, however it is divided.
        self._fastest = np.maximum(np.maximum(robot.velocity_upper, -robot.velocity_lower), TINY)

    def check_start(self, q: Array) -> None:
        """Refuse a configuration (n,) rad that the motors cannot hold.

        Raises:
            InfeasibleError: gravity asks for more than a joint's effort limit.
        """
        robot = self._robot
        gravity = pin.computeGeneralizedGravity(robot.model, robot.data, q)
        for i in np.flatnonzero(np.abs(gravity) > (1 - RESERVE) * robot.effort):
            raise InfeasibleError(
                f"gravity asks {abs(gravity[i]):.3g} N m of joint {i + 1} at the start, of "
                f"{robot.effort[i]:g} N m",
                {"joint": int(i) + 1, "torque": float(gravity[i])},
            )

    def impulses(self, q: Array, qd: Array) -> Impulses:
        """Return what the next step may change, at q (n,) rad and qd (n,) rad/s."""
        model, data = self._robot.model, self._robot.data
        M = np.array(pin.crba(model, data, q))
        return Impulses(
            M, self._dt * pin.nonLinearEffects(model, data, q, qd) - M @ qd, self._limit
        )

    def bounds(
        self, q: Array, qd: Array, impulses: Impulses, lower: Array, upper: Array
    ) -> tuple[Array, Array]:
        """Tighten the velocity bounds (n,) of a step so that joints can stop at their limits.

        What is reckoned with is what a joint can do alone, or together with the others that are
        near a limit. No bound asks for a greater deceleration than that.
        """
        robot, dt = self._robot, self._dt
        effects = np.abs(impulses.b + impulses.M @ qd) / dt
        left = np.maximum(robot.effort - effects, LEAST * robot.effort)
        M = np.abs(impulses.M)
        rates = np.min(left[:, None] / np.maximum(M, TINY), axis=0)
        near = self._fastest**2 / rates > np.where(qd > 0, robot.upper - q, q - robot.lower)
        together = float(np.max(M @ np.where(near, self._fastest, 0.0) / left))
        rates = FORESIGHT * np.minimum(rates, self._fastest / max(together, TINY))
        most = stopping_speed(robot.upper - q, rates, dt)
        least = -stopping_speed(q - robot.lower, rates, dt)
        return (
            np.maximum(lower, np.minimum(least, qd + rates * dt)),
            np.minimum(upper, np.maximum(most, qd - rates * dt)),
        )

    def can_stop(self, q: Array, qd: Array) -> bool:
        """Tell whether there is a way from here to rest within the limits, and remember it.

        Every joint slows down evenly: as its position limit demands, and otherwise at half of the
        rates that all joints have together, whatever their signs. The torque is checked at the
        beginning and whenever a joint comes to rest; `RESERVE` is for what is between.
        """
        robot = self._robot
        most = (1.0 - RESERVE) * robot.effort
        effects, M = self._effects(q, qd), self._mass(q)
        left = most - np.abs(effects)
        room = np.where(qd > 0, robot.upper - q, q - robot.lower)
        if not (left > 0).all() or (room < -ROUNDING).any():
            return False
        size, sign = np.abs(qd), np.sign(qd)
        easy = 0.5 * self._fastest / float(np.max(np.abs(M) @ self._fastest / left))
        rates = np.maximum(easy, stopping_rate(room, size, self._dt))
        if (np.abs(effects - M @ (sign * rates)) > most).any():
            return False
        times = size / rates
        for time in np.unique(times[size > STILL * self._fastest]):
            passed = np.minimum(time, times)
            state = (
                q + sign * (size * passed - rates * passed**2 / 2.0),
                sign * np.maximum(size - rates * time, 0.0),
                np.where(times >= time, -sign * rates, 0.0),
            )
            if (np.abs(pin.rnea(robot.model, robot.data, *state)) > robot.effort).any():
                return False
        self._stop = rates
        return True

    def slower(self, q: Array, qd: Array, share: float) -> Array:
        """Return the velocity (n,) after a step of slowing down.

        Args:
            q: (n,) rad. qd: (n,) rad/s.
            share: of qd that is left, if the torques allow it and the arm can stop from there;
                else the step is the next on the way to rest that `can_stop` finds, or, where the
                torques do not allow that one, the nearest to it.

        Raises:
            InfeasibleError: the torque limits do not allow that either.
        """
        impulses, gentle = self.impulses(q, qd), share * qd
        if impulses.allow(gentle) and self.can_stop(q + self._dt * gentle, gentle):
            return gentle
        self.can_stop(q, qd)  # as the step before was asked; else its way goes on
        hard = np.sign(qd) * np.maximum(np.abs(qd) - self._dt * self._stop, 0.0)
        return np.asarray(hard) if impulses.allow(hard) else self._nearest(q, hard, impulses)

    def _nearest(self, q: Array, wanted: Array, impulses: Impulses) -> Array:
        """Return the velocity (n,) nearest to the one wanted that a step can reach.

        `can_stop` looks at a few moments of a way; between them, rarely, it asks for too much.

        Raises:
            InfeasibleError: none is certified within torques, velocities and positions.
        """
        robot, n = self._robot, wanted.size
        limits = robot.lower, robot.upper, robot.velocity_lower, robot.velocity_upper
        lower, upper = step_bounds(q, *limits, self._dt)
        terms = with_impulses(Terms(np.eye(n), -wanted, np.zeros((0, n)), np.zeros(0)), impulses)
        ends = ((lower, -impulses.limit), (upper, impulses.limit))
        x = self._program.solve(*terms, *(np.concatenate(end) for end in ends))
        if x is None:
            raise InfeasibleError("the torque limits leave no way to slow down")
        return x[:n]

    def _mass(self, q: Array) -> Array:
        return np.asarray(pin.crba(self._robot.model, self._robot.data, q))

    def _effects(self, q: Array, qd: Array) -> Array:
        return np.asarray(pin.nonLinearEffects(self._robot.model, self._robot.data, q, qd))


def stopping_speed(distance: Array, rate: Array, dt: float) -> Array:
    """Return the greatest speeds (n,) from which joints stop within distances (n,), step by step.

    With v the speed of the coming step and a deceleration `rate` (n,) from then on, the way is
    dt (v + (v - rate dt) + (v - 2 rate dt) + ...); this solves it for v.
    """
    with np.errstate(invalid="ignore"):  # a joint without limits is infinitely far from them
        more = np.floor((np.sqrt(1.0 + 8.0 * distance / (rate * dt**2)) - 1.0) / 2.0)
        speed = distance / ((more + 1.0) * dt) + rate * dt * more / 2.0
    return np.where(np.isfinite(distance), np.maximum(speed, 0.0), np.inf)


def stopping_rate(distance: Array, speed: Array, dt: float) -> Array:
    """Return the decelerations (n,) with which joints stop within distances (n,) after a step.

    The step at `speed` (n,) ends here; the way still to come is dt ((v - a dt) + (v - 2 a dt) +
    ...), and this solves it for a.
    """
    share = np.maximum(distance, 0.0) / np.maximum(speed * dt, TINY)
    with np.errstate(invalid="ignore"):  # a joint without limits has all the way it wants
        steps = np.floor(2.0 * share) + 1.0
        rate = 2.0 * speed * (steps - share) / (steps * (steps + 1.0) * dt)
    return np.where(np.isfinite(distance), rate, 0.0)
