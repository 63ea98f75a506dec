"""Slowing an arm down within torques: gently, along a safe way to rest, or as hard as it can.

A safe way ends at rest within all limits. Where none is found, such as at a stop that a joint runs
into, or above a velocity limit, something has to give. The order is: a step never leaves the
position and velocity limits; the torques are kept if any such step keeps them; joints that must
brake to stay within their positions come first; and what motors there are brake.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from hitjoints.hitting.stopping import stopping_rate
from hitjoints.programs.hitting_speed import step_bounds
from hitjoints.programs.joint_velocity import Terms
from hitjoints.programs.torque_rows import Impulses, with_impulses
from hitjoints.programs.warm import WarmProgram

if TYPE_CHECKING:
    from hitjoints.hitting.torque_limits import TorqueLimits
    from hitjoints.model.robot import Robot
    from hitjoints.types import Array

LEAST_URGENT, MOST_URGENT = 0.1, 10.0
"""Of the weights with which joints brake that cannot all brake as they must."""
OVERLOAD = 1e3
"""Cost of a torque beyond its limit, (rad/s)^2 per square of the limit, where none is kept."""
BEYOND = 1e5
"""Times the limit, a bound of such torques that is never met."""


class Braked(NamedTuple):
    """A joint velocity (n,) rad/s, and whether a way to rest within all limits is known with it."""

    qd: Array
    safe: bool


class Brake:
    """Slows an arm down that is commanded every dt, step by step.

    Args:
        robot: the arm.
        limits: of its torques.
    """

    def __init__(self, robot: Robot, limits: TorqueLimits) -> None:
        n = robot.n
        self._robot, self._limits, self._dt = robot, limits, limits.dt
        self._none = np.zeros((0, n)), np.zeros(0)
        self._program = WarmProgram(2 * n, n)  # qd, p
        self._overloaded = WarmProgram(3 * n, n)  # qd, p, e
        self._rates: Array | None = None  # of the way that the step before went on

    def slower(self, q: Array, qd: Array, share: float) -> Braked:
        """Return the velocity after a step of slowing down, always within the step's bounds.

        Args:
            q: (n,) rad.
            qd: (n,) rad/s.
            share: of qd that is left, if the torques allow it and the arm can stop from there;
                else the step is the next on the way to rest from here, or, where the torques do
                not allow that one, the nearest to it. Where there is no such way the arm brakes as
                hard as its motors can, and that is not `safe`.
        """
        robot, limits, dt = self._robot, self._limits, self._dt
        within = robot.lower, robot.upper, robot.velocity_lower, robot.velocity_upper
        lower, upper = step_bounds(q, *within, dt)
        if limits.accelerations is not None:
            lower, upper, _ = limits.accelerations.near(qd, lower, upper)
        impulses, gentle = limits.impulses(q, qd), share * qd

        def possible(wanted: Array) -> bool:
            inside = ((wanted >= lower) & (wanted <= upper)).all()
            return bool(inside) and impulses.allow(wanted)

        if possible(gentle) and limits.can_stop(q + dt * gentle, gentle):
            self._rates = None
            return Braked(gentle, True)
        rates = limits.way_to_rest(q, qd)
        if rates is None and self._rates is not None:
            rates = limits.way_to_rest(q, qd, self._rates)
        self._rates = rates
        if rates is not None:
            hard = np.sign(qd) * np.maximum(np.abs(qd) - dt * rates, 0.0)
            # The way is looked at in a few moments; between them, rarely, it asks for too much.
            step = hard if possible(hard) else self._nearest(hard, impulses, lower, upper)
            if step is not None:
                return Braked(step, True)
        return Braked(self._hardest(q, qd, impulses, lower, upper), False)

    def _hardest(
        self, q: Array, qd: Array, impulses: Impulses, lower: Array, upper: Array
    ) -> Array:
        """Return the velocity (n,) after braking as hard as possible; see the top of the file."""
        robot, dt = self._robot, self._dt
        size, still = np.abs(qd), np.zeros_like(qd)
        # No joint speeds up to take some of the torque: that would end worse.
        lower, upper = (
            np.maximum(lower, np.minimum(qd, 0.0)),
            np.minimum(upper, np.maximum(qd, 0.0)),
        )
        needed = stopping_rate(np.where(qd > 0, robot.upper - q, q - robot.lower), size, dt)
        ramp = np.maximum(size - dt * needed, 0.0)
        step = self._nearest(still, impulses, np.maximum(lower, -ramp), np.minimum(upper, ramp))
        if step is not None:
            return step
        urgency = needed / self._limits.rates_alone(qd, impulses)
        weights = np.clip(urgency, LEAST_URGENT, MOST_URGENT) ** 2
        step = self._nearest(still, impulses, lower, upper, weights)
        return self._overload(impulses, lower, upper) if step is None else step

    def _nearest(
        self,
        wanted: Array,
        impulses: Impulses,
        lower: Array,
        upper: Array,
        weights: Array | None = None,
    ) -> Array | None:
        """Return the velocity (n,) nearest to the one wanted within torques and bounds, if any."""
        low, high = impulses.M * lower, impulses.M * upper
        least = impulses.b + np.minimum(low, high).sum(axis=1)
        most = impulses.b + np.maximum(low, high).sum(axis=1)
        if (least > impulses.limit).any() or (most < -impulses.limit).any():
            return None  # no need to ask a solver
        w = np.ones_like(wanted) if weights is None else weights
        terms = with_impulses(Terms(np.diag(w), -w * wanted, *self._none), impulses)
        ends = ((lower, -impulses.limit), (upper, impulses.limit))
        x = self._program.solve(*terms, *(np.concatenate(end) for end in ends))
        return None if x is None else x[: wanted.size]

    def _overload(self, impulses: Impulses, lower: Array, upper: Array) -> Array:
        """Return the velocity (n,) within bounds whose torques exceed their limits the least."""
        n = lower.size
        one, far = np.ones(n), np.full(n, BEYOND)
        H = np.diag(np.concatenate((one, np.zeros(n), OVERLOAD * one)))
        # In units of the limits, so that joints of any strength are alike.
        A = np.hstack((impulses.M / impulses.limit[:, None], -np.eye(n), -np.eye(n)))
        low, high = np.concatenate((lower, -one, -far)), np.concatenate((upper, one, far))
        x = self._overloaded.solve(H, np.zeros(3 * n), A, -impulses.b / impulses.limit, low, high)
        return np.minimum(np.maximum(0.0, lower), upper) if x is None else x[:n]
