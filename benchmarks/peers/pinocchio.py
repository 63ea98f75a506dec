"""Pinocchio by hand: the bare calls, one configuration at a time."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin

import hitjoints as hj

ITERATIONS = 14  # before a restart: what makes `place` fastest, of 8, 12, 16, 24, 40 and 100
WORLD_ALIGNED = pin.LOCAL_WORLD_ALIGNED


class PinocchioArm:
    """One joint of an arm."""

    def __init__(self, robot: hj.Robot, joint: int) -> None:
        self.model, self.data, self.joint = robot.model, robot.model.createData(), joint
        self.weightless = robot.weightless_model  # without gravity
        self.lower, self.upper = robot.lower, robot.upper

    def inertia(self, q: Any, h: Any) -> float:
        """Return 1 / (h^T J M^-1 J^T h), kg."""
        return self.inertia_and_pull(q, h)[0]

    def inertia_and_pull(self, q: Any, h: Any) -> tuple[float, Any]:
        """Return it and g = J^T h (n,) m/rad."""
        g, u = self._respond(q, h)
        return 1.0 / (g @ u), g

    def gradient(self, q: Any, h: Any) -> Any:
        """Return its gradient (n,) kg/rad, exact."""
        return self.inertia_and_gradient(q, h)[1]

    def inertia_and_gradient(self, q: Any, h: Any) -> tuple[float, Any]:
        """Return both."""
        model, data = self.model, self.data
        g, u = self._respond(q, h)
        inertia, still = 1.0 / (g @ u), np.zeros(model.nv)
        pin.computeForwardKinematicsDerivatives(model, data, q, u, still)
        by_q = pin.getPointVelocityDerivatives(
            model, data, self.joint, pin.SE3.Identity(), WORLD_ALIGNED
        )[0]
        momentum = pin.computeRNEADerivatives(self.weightless, data, q, still, u)[0]
        return inertia, -(inertia**2) * (2 * h @ by_q - u @ momentum)

    def place(self, target: Any, rng: np.random.Generator) -> Any:
        """Return q (n,) that puts the joint at a target (3,), by damped least squares."""
        model, data, joint = self.model, self.data, self.joint
        for _ in range(400):
            q = rng.uniform(self.lower, self.upper)
            for _ in range(ITERATIONS):
                pin.computeJointJacobians(model, data, q)
                error = target - data.oMi[joint].translation
                if error @ error < 1e-18:
                    return q
                jac = pin.getJointJacobian(model, data, joint, WORLD_ALIGNED)[:3]
                damped = jac @ jac.T + (0.1 * (error @ error) + 1e-10) * np.eye(3)
                q = np.clip(q + jac.T @ np.linalg.solve(damped, error), self.lower, self.upper)
        return None

    def _respond(self, q: Any, h: Any) -> tuple[Any, Any]:
        """Return g = J^T h and u = M^-1 g."""
        model, data = self.model, self.data
        pin.computeJointJacobians(model, data, q)
        g = h @ pin.getJointJacobian(model, data, self.joint, WORLD_ALIGNED)[:3]
        pin.crba(model, data, q)
        pin.cholesky.decompose(model, data)
        return g, pin.cholesky.solve(model, data, g)
