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
from hitjoints.hitting.stopping import TINY, stopping_rate, stopping_speed
from hitjoints.programs.torque_rows import Impulses
from hitjoints.programs.warm import ROWS

if TYPE_CHECKING:
    from hitjoints.hitting.acceleration_limits import AccelerationLimits
    from hitjoints.model.robot import Robot
    from hitjoints.types import Array

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


class TorqueLimits:
    """The effort limits of an arm that is commanded every dt.

    Args:
        robot: the arm.
        dt: s.
        accelerations: limits that a way to stop keeps, too.

    Raises:
        InputError: an effort limit is zero or not finite: the URDF does not tell it.
    """

    def __init__(
        self, robot: Robot, dt: float, accelerations: AccelerationLimits | None = None
    ) -> None:
        for i in np.flatnonzero(~(np.isfinite(robot.effort) & (robot.effort > 0))):
            expected = "torque limits need finite effort limits above 0 N m for every joint"
            raise InputError("robot", f"{robot.name}, joint {i + 1}: {robot.effort[i]}", expected)
        self._robot, self.dt, self.accelerations = robot, dt, accelerations
        self._hardest = np.full(robot.n, np.inf) if accelerations is None else accelerations.rates
        # A certified answer may miss a row by ROWS; the limit holds all the same.
        whole = dt * robot.effort
        self._limit = whole - np.minimum(2 * ROWS, RESERVE * whole)
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
        return Impulses(M, self.dt * pin.nonLinearEffects(model, data, q, qd) - M @ qd, self._limit)

    def bounds(
        self, q: Array, qd: Array, impulses: Impulses, lower: Array, upper: Array
    ) -> tuple[Array, Array]:
        """Tighten the velocity bounds (n,) of a step so that joints can stop at their limits.

        What is reckoned with is what a joint can do alone, or together with the others that are
        near a limit. No bound asks for a greater deceleration than that.
        """
        robot, dt = self._robot, self.dt
        left, M = self._left(qd, impulses), np.abs(impulses.M)
        rates = self._alone(left, M)
        near = self._fastest**2 / rates > np.where(qd > 0, robot.upper - q, q - robot.lower)
        together = float((M @ np.where(near, self._fastest, 0.0) / left).max())
        rates = FORESIGHT * np.minimum(rates, self._fastest / max(together, TINY))
        rooms = np.array((robot.upper - q, q - robot.lower))
        most, least = stopping_speed(rooms, rates, dt)
        return (
            np.maximum(lower, np.minimum(-least, qd + rates * dt)),
            np.minimum(upper, np.maximum(most, qd - rates * dt)),
        )

    def rates_alone(self, qd: Array, impulses: Impulses) -> Array:
        """Return the decelerations (n,) rad/s^2 that each joint could have if it braked alone."""
        return self._alone(self._left(qd, impulses), np.abs(impulses.M))

    def _alone(self, left: Array, M: Array) -> Array:
        """Return the same, for the torques left (n,) N m and |M| (n, n)."""
        alone = (left[:, None] / np.maximum(M, TINY)).min(axis=0)
        return np.asarray(np.minimum(alone, self._hardest))

    def can_stop(self, q: Array, qd: Array) -> bool:
        """Tell whether there is a way from q (n,) rad, qd (n,) rad/s to rest within the limits."""
        return self.way_to_rest(q, qd) is not None

    def way_to_rest(self, q: Array, qd: Array, rates: Array | None = None) -> Array | None:
        """Return the decelerations (n,) rad/s^2 of a way to rest within limits, if any is found.

        Every joint slows down evenly: as its position limit demands, and otherwise at half of the
        rates that all joints have together, whatever their signs. The torque is checked at the
        beginning and whenever a joint comes to rest; `RESERVE` is for what is between.

        Args:
            q: (n,) rad.
            qd: (n,) rad/s.
            rates: (n,) rad/s^2, of a way begun before, to check in place of that one.
        """
        robot = self._robot
        most = (1.0 - RESERVE) * robot.effort if rates is None else robot.effort
        effects, M = self._effects(q, qd), self._mass(q)
        left = most - np.abs(effects)
        room = np.where(qd > 0, robot.upper - q, q - robot.lower)
        if not (left > 0).all() or (room < -ROUNDING).any():
            return None
        size, sign = np.abs(qd), np.sign(qd)
        if rates is None:
            easy = 0.5 * self._fastest / float((np.abs(M) @ self._fastest / left).max())
            rates = np.maximum(np.minimum(easy, self._hardest), stopping_rate(room, size, self.dt))
        elif (rates < stopping_rate(room, size, self.dt) * (1.0 - ROUNDING)).any():
            return None
        if (rates > self._hardest * (1.0 + ROUNDING)).any():
            return None
        if (np.abs(effects - M @ (sign * rates)) > most).any():
            return None
        times = size / rates
        ends = times[size > STILL * self._fastest][:, None]  # all of them at once, in rows
        passed = np.minimum(ends, times)
        positions = q + sign * (size * passed - rates * passed**2 / 2.0)
        velocities = sign * np.maximum(size - rates * ends, 0.0)
        slowing = np.where(times >= ends, -sign * rates, 0.0)
        model, data = robot.model, robot.data
        states = zip(positions, velocities, slowing, strict=True)
        torques = np.array([pin.rnea(model, data, *state) for state in states])
        within = np.abs(torques.reshape(-1, robot.n)) <= robot.effort
        return rates if within.all() else None

    def _left(self, qd: Array, impulses: Impulses) -> Array:
        """Return the torques (n,) N m that are left for braking."""
        effort = self._robot.effort
        effects = np.abs(impulses.b + impulses.M @ qd) / self.dt
        return np.asarray(np.maximum(effort - effects, LEAST * effort))

    def _mass(self, q: Array) -> Array:
        return np.asarray(pin.crba(self._robot.model, self._robot.data, q))

    def _effects(self, q: Array, qd: Array) -> Array:
        return np.asarray(pin.nonLinearEffects(self._robot.model, self._robot.data, q, qd))
