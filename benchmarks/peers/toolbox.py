"""Robotics Toolbox for Python: its inertia matrix and Jacobian, its inverse kinematics in C++."""

from __future__ import annotations

from typing import Any

import numpy as np

import hitjoints as hj
from benchmarks.peers.differences import central
from benchmarks.peers.urdf import urdf_path

POSITION_ONLY = np.array([1.0, 1.0, 1.0, 0.0, 0.0, 0.0])
NEAR = 0.5 * (1e-6) ** 2  # its tolerance is half the squared error: 1e-6 m


class ToolboxArm:
    """One joint of an arm."""

    def __init__(self, robot: hj.Robot, joint: int) -> None:
        from roboticstoolbox import Robot
        from roboticstoolbox.models.URDF.URDFRobot import URDF_file

        links = URDF_file(urdf_path(robot.name))[0]
        self.robot = Robot(links)
        self.link = next(link for link in links if link.name == f"link_{joint}")
        self.chain = self.robot.ets(end=self.link)
        self.J = np.zeros((3, robot.n))
        self.middle = (robot.lower + robot.upper) / 2

    def inertia(self, q: Any, h: Any) -> float:
        """Return 1 / (h^T J M^-1 J^T h), kg."""
        here = self.robot.jacob0(q, end=self.link)[:3]  # of the joints up to this link
        self.J[:, : here.shape[1]] = here
        pull = h @ self.J
        return float(1.0 / (pull @ np.linalg.solve(self.robot.inertia(q), pull)))

    def gradient(self, q: Any, h: Any) -> Any:
        """Return its gradient (n,) kg/rad."""
        return central(lambda x: self.inertia(x, h), q)

    def place(self, target: Any, _: np.random.Generator) -> Any:
        """Return q (n,) that puts the joint at a target (3,)."""
        pose = np.eye(4)
        pose[:3, 3] = target
        found = self.chain.ik_LM(pose, mask=POSITION_ONLY, tol=NEAR)
        if not found.success:
            return None
        q = self.middle.copy()
        q[: len(found.q)] = found.q
        return q
