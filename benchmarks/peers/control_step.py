"""The authors' stack: a control step by PyBullet, finite differences and OSQP.

The equations are those of `hitjoints.hitting.controller`, written again in NumPy: the field of
Eq. 5-6 at constant speed, Eq. 12 with W = I, Eq. 13, and the bounded program for Eq. 7.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

import hitjoints as hj
from benchmarks.peers.differences import forward
from benchmarks.peers.pybullet import PyBulletArm

SIGMA, RATE = 0.01, 20.0  # m, 1/s, of the field
RHO, PROGRESS = 1e-4, 1e3  # weights of Eq. 12 and of following the field
WITHIN_REACH = 1 - 1e-6  # share of the greatest speed that a program is asked for
BETA1, BETA2, STABLE = 0.5, 0.5, 0.5  # gains, and the share of an error that a step removes at most

Solve = Callable[[Any, Any, Any, Any, Any, Any], Any]
"""Minimise 1/2 x^T P x + c^T x subject to A x = b and bounds."""


class PyBulletStep:
    """Makes the joint velocity (n,) rad/s of a step from q (n,) rad.

    `solver` makes a solver of programs: one for Eq. 12, one for the law.
    """

    def __init__(
        self,
        robot: hj.Robot,
        hit: hj.Hit,
        joint: int,
        posture: Any,
        dt: float,
        solver: Callable[[], Solve],
    ) -> None:
        self.solve_eq12, self.solve_law = solver(), solver()
        self.arm, self.hit, self.posture, self.dt = PyBulletArm(robot, joint), hit, posture, dt
        self.low, self.high = robot.lower, robot.upper
        self.slow, self.fast = robot.velocity_lower, robot.velocity_upper
        self.n = robot.n

    def __call__(self, q: Any) -> Any:
        """Return the joint velocity for the next step."""
        h, mass = self.hit.direction, self.hit.mass
        seen = self.arm.see(q, h)
        gradient = forward(lambda x: self.arm.inertia(x, h), q, seen.inertia)
        lower = np.maximum(self.slow, (self.low - q) / self.dt)
        upper = np.minimum(self.fast, (self.high - q) / self.dt)
        pull = h @ seen.J
        reach = np.maximum(pull * lower, pull * upper).sum()
        speed = min((1 + mass / seen.inertia) * self.hit.desired_flux, WITHIN_REACH * reach)
        f = self.field(seen.position, speed)
        following = q + self.dt * self.eq12(seen.J, f, pull, speed, lower, upper)
        error = seen.inertia - self.arm.inertia(following, h)
        gain = min(BETA2, STABLE / (self.dt * (gradient @ gradient)))
        wish = BETA1 * (self.posture - q) - gain * error * gradient
        return self.law(seen.J, f, wish, lower, upper)

    def field(self, position: Any, speed: float) -> Any:
        """Return the velocity (3,) m/s at a position (3,) m."""
        h = self.hit.direction
        offset = position - self.hit.position
        error = offset - h * (h @ offset)
        alpha = np.exp(-np.linalg.norm(error) / SIGMA)
        f = alpha * speed * h - (1 - alpha) * RATE * error
        return f * speed / np.linalg.norm(f)

    def eq12(self, J: Any, f: Any, pull: Any, speed: float, lower: Any, upper: Any) -> Any:
        """Return the joint velocity (n,) nearest to the field that has the flux."""
        P = J.T @ J + RHO * np.eye(self.n)
        c = -(f @ J + RHO * np.linalg.pinv(J) @ f)
        return self.solve_eq12(P, c, pull[None], np.array([speed]), lower, upper)

    def law(self, J: Any, f: Any, wish: Any, lower: Any, upper: Any) -> Any:
        """Return the joint velocity (n,) along the field, slowed down if it must be."""
        A = np.column_stack((J, -f))
        c = np.append(-wish, -PROGRESS)
        lower, upper = np.append(lower, 0.0), np.append(upper, 1.0)
        return self.solve_law(np.eye(self.n + 1), c, A, np.zeros(3), lower, upper)[:-1]
