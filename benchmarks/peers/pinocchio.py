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
        self.weightless = robot.weightless_model

    def inertia(self, q: Any, h: Any) -> float:
        """Return 1 / (h^T J M^-1 J^T h), kg."""
        return inertia(self.model, self.data, q, self.joint, h)[0]

    def gradient(self, q: Any, h: Any) -> Any:
        """Return its gradient (n,) kg/rad, exact."""
        return gradient(self.model, self.weightless, self.data, q, self.joint, h)[1]

    def place(self, target: Any, rng: np.random.Generator) -> Any:
        """Return q (n,) that puts the joint at a target (3,)."""
        return place(self.model, self.data, self.joint, target, rng)


def inertia(model: Any, data: Any, q: Any, joint: int, h: Any) -> tuple[float, Any, Any]:
    """Return lambda_h, g = J^T h and u = M^-1 g."""
    pin.computeJointJacobians(model, data, q)
    g = h @ pin.getJointJacobian(model, data, joint, WORLD_ALIGNED)[:3]
    pin.crba(model, data, q)
    pin.cholesky.decompose(model, data)
    u = pin.cholesky.solve(model, data, g)
    return 1.0 / (g @ u), g, u


def gradient(model: Any, weightless: Any, data: Any, q: Any, joint: int, h: Any) -> Any:
    """Return lambda_h and its gradient; `weightless` is the model without gravity."""
    value, _, u = inertia(model, data, q, joint, h)
    still = np.zeros(model.nv)
    pin.computeForwardKinematicsDerivatives(model, data, q, u, still)
    by_q = pin.getPointVelocityDerivatives(model, data, joint, pin.SE3.Identity(), WORLD_ALIGNED)
    momentum = pin.computeRNEADerivatives(weightless, data, q, still, u)[0]
    return value, -(value**2) * (2 * h @ by_q[0] - u @ momentum)


def place(model: Any, data: Any, joint: int, target: Any, rng: np.random.Generator) -> Any:
    """Return q that puts a joint at `target` by damped least squares, restarted until it does."""
    lower, upper = model.lowerPositionLimit, model.upperPositionLimit
    for _ in range(400):
        q = rng.uniform(lower, upper)
        for _ in range(ITERATIONS):
            pin.computeJointJacobians(model, data, q)
            error = target - data.oMi[joint].translation
            if error @ error < 1e-18:
                return q
            jac = pin.getJointJacobian(model, data, joint, WORLD_ALIGNED)[:3]
            damped = jac @ jac.T + (0.1 * (error @ error) + 1e-10) * np.eye(3)
            q = np.clip(q + jac.T @ np.linalg.solve(damped, error), lower, upper)
    return None
