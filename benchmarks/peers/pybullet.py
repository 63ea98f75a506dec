"""PyBullet: mass matrix and Jacobian through its command interface, inertia by NumPy."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, NamedTuple

import numpy as np

import hitjoints as hj
from benchmarks.peers.differences import central
from benchmarks.peers.urdf import urdf_path


class Seen(NamedTuple):
    """Position (3,) m, Jacobian (3, n) m/rad and directional inertia (kg) of a joint's origin."""

    position: Any
    J: Any
    inertia: float


class PyBulletArm:
    """One joint of an arm, in a physics client of its own without a window."""

    def __init__(self, robot: hj.Robot, joint: int) -> None:
        with _chatter_on_stderr():
            import pybullet

            self.p = pybullet
            self.client = pybullet.connect(pybullet.DIRECT)
            # Without the flag PyBullet makes up inertia tensors from the collision shapes.
            self.body = pybullet.loadURDF(
                urdf_path(robot.name),
                useFixedBase=True,
                flags=pybullet.URDF_USE_INERTIA_FROM_FILE,
                physicsClientId=self.client,
            )
        for i in range(robot.n, pybullet.getNumJoints(self.body, physicsClientId=self.client)):
            # It gives links without inertia, such as the flange, 1 kg and 1 kg m^2.
            pybullet.changeDynamics(
                self.body, i, mass=0, localInertiaDiagonal=[0, 0, 0], physicsClientId=self.client
            )
        self.link, self.n, self.still = joint - 1, robot.n, [0.0] * robot.n

    def see(self, q: Any, h: Any) -> Seen:
        """Return all that a control step needs but the gradient."""
        for i, angle in enumerate(q):
            self.p.resetJointState(self.body, i, angle, physicsClientId=self.client)
        state = self.p.getLinkState(
            self.body, self.link, computeForwardKinematics=True, physicsClientId=self.client
        )
        J, inertia = self._inertia(q, h)
        return Seen(np.array(state[4]), J, inertia)

    def inertia(self, q: Any, h: Any) -> float:
        """Return 1 / (h^T J M^-1 J^T h), kg."""
        return self._inertia(q, h)[1]

    def gradient(self, q: Any, h: Any) -> Any:
        """Return its gradient (n,) kg/rad."""
        return central(lambda x: self.inertia(x, h), q)

    def _inertia(self, q: Any, h: Any) -> tuple[Any, float]:
        angles = list(q)
        J = np.array(
            self.p.calculateJacobian(
                self.body, self.link, [0.0, 0.0, 0.0], angles, self.still, self.still,
                physicsClientId=self.client,
            )[0]
        )  # fmt: skip
        M = np.array(self.p.calculateMassMatrix(self.body, angles, physicsClientId=self.client))
        pull = h @ J
        return J, float(1.0 / (pull @ np.linalg.solve(M, pull)))


@contextmanager
def _chatter_on_stderr() -> Iterator[None]:
    """Send what PyBullet's C++ prints to stderr: stdout may be JSON."""
    sys.stdout.flush()
    kept = os.dup(1)
    try:
        os.dup2(2, 1)
        yield
    finally:
        os.dup2(kept, 1)
        os.close(kept)
