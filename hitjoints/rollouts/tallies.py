"""What many motions amount to, joint by joint and step by step."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from hitjoints.built import chain_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from hitjoints.kernels.inverse_dynamics import InverseDynamics
    from hitjoints.model.robot import Robot
    from hitjoints.types import Array


@dataclass(eq=False)
class Tallies:
    """The greatest of everything, of N motions that begin at rest.

    Attributes:
        robot: the arm.
        dt: s.
        qd: (n, N) rad/s, of the last row of each.
        velocity_ratio_max: (N,), see `Rollout`.
        acceleration_ratio_max: (N,), see `Rollout`.
        torque_ratio_max: (N,), see `Rollout`.
        position_violation_max: (N,) rad.
    """

    robot: Robot
    dt: float
    qd: Array
    velocity_ratio_max: Array = field(init=False)
    acceleration_ratio_max: Array = field(init=False)
    torque_ratio_max: Array = field(init=False)
    position_violation_max: Array = field(init=False)

    def __post_init__(self) -> None:
        robot, count = self.robot, self.qd.shape[1]
        self._told = np.isfinite(robot.effort) & (robot.effort > 0)
        self._torques = inverse_dynamics_for(robot) if self._told.any() else None
        zero, unknown = np.zeros(count), np.full(count, np.nan)
        self.velocity_ratio_max, self.position_violation_max = zero.copy(), zero.copy()
        self.acceleration_ratio_max = unknown.copy() if robot.acceleration is None else zero.copy()
        self.torque_ratio_max = zero.copy() if self._told.any() else unknown.copy()

    def add(self, which: NDArray[np.int64], q: Array, qd: Array) -> None:
        """Add a row to some motions: q (n, M) rad, and qd (n, M) rad/s from there on."""
        robot = self.robot
        rates = (qd - self.qd[:, which]) / self.dt
        limit = np.where(qd > 0, robot.velocity_upper[:, None], -robot.velocity_lower[:, None])
        speed = np.abs(qd) / np.where(qd != 0, limit, 1.0)
        beyond = np.maximum(robot.lower[:, None] - q, q - robot.upper[:, None])
        _raise(self.velocity_ratio_max, which, speed)
        _raise(self.position_violation_max, which, beyond)
        if robot.acceleration is not None:
            most = self.dt * robot.acceleration[:, None]
            _raise(self.acceleration_ratio_max, which, np.abs(qd - self.qd[:, which]) / most)
        if self._torques is not None:
            torque = self._torques(q, qd - self.dt * rates, rates, threads=1)[self._told]
            _raise(self.torque_ratio_max, which, np.abs(torque) / robot.effort[self._told, None])
        self.qd[:, which] = qd


@lru_cache(maxsize=16)
def inverse_dynamics_for(robot: Robot) -> InverseDynamics:
    """Return the torques of a robot's motions."""
    from hitjoints.kernels.inverse_dynamics import build_inverse_dynamics

    return build_inverse_dynamics(robot.model, chain_of(robot))


def _raise(greatest: Array, which: NDArray[np.int64], values: Array) -> None:
    greatest[which] = np.maximum(greatest[which], values.max(axis=0))
