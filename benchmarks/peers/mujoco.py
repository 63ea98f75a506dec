"""MuJoCo: its mass matrix in its own sparse factors, its Jacobian of a body."""

from __future__ import annotations

from typing import Any

import numpy as np

import hitjoints as hj
from benchmarks.peers.differences import central
from benchmarks.peers.urdf import urdf_path

ITERATIONS = 14  # before a restart, as with Pinocchio


class MuJoCoArm:
    """One joint of an arm."""

    def __init__(self, robot: hj.Robot, joint: int) -> None:
        import mujoco

        self.mj = mujoco
        self.model = mujoco.MjModel.from_xml_path(urdf_path(robot.name))
        self.data = mujoco.MjData(self.model)
        self.body = self.model.body(f"link_{joint}").id
        self.J = np.zeros((3, robot.n))
        self.response = np.zeros((1, robot.n))
        self.lower, self.upper = robot.lower, robot.upper

    def inertia(self, q: Any, h: Any) -> float:
        """Return 1 / (h^T J M^-1 J^T h), kg."""
        return self.inertia_and_pull(q, h)[0]

    def inertia_and_pull(self, q: Any, h: Any) -> tuple[float, Any]:
        """Return it and J^T h (n,) m/rad."""
        model, data = self.model, self.data
        self._move(q)
        self.mj.mj_makeM(model, data)
        self.mj.mj_factorM(model, data)
        pull = h @ self.J
        self.mj.mj_solveM(model, data, self.response, pull[None])
        return float(1.0 / (pull @ self.response[0])), pull

    def gradient(self, q: Any, h: Any) -> Any:
        """Return its gradient (n,) kg/rad."""
        return central(lambda x: self.inertia(x, h), q)

    def place(self, target: Any, rng: np.random.Generator) -> Any:
        """Return q (n,) that puts the joint at a target (3,), by damped least squares."""
        for _ in range(400):
            q = rng.uniform(self.lower, self.upper)
            for _ in range(ITERATIONS):
                self._move(q)
                error = target - self.data.xpos[self.body]
                if error @ error < 1e-18:
                    return q
                damped = self.J @ self.J.T + (0.1 * (error @ error) + 1e-10) * np.eye(3)
                step = self.J.T @ np.linalg.solve(damped, error)
                q = np.clip(q + step, self.lower, self.upper)
        return None

    def _move(self, q: Any) -> None:
        model, data = self.model, self.data
        data.qpos[:] = q
        self.mj.mj_kinematics(model, data)
        self.mj.mj_comPos(model, data)
        self.mj.mj_jacBody(model, data, self.J, None, self.body)
