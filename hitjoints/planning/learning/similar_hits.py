"""What tells hits apart, and how a configuration of one serves another."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin

if TYPE_CHECKING:
    from hitjoints.model.robot import Robot
    from hitjoints.types import Array


@lru_cache(maxsize=16)
def _turning(robot: Robot) -> float:
    """Return the sense (1, -1) in which joint 1 turns about the base's vertical; 0 if not so."""
    data = robot.model.createData()
    column = pin.computeJointJacobians(robot.model, data, np.zeros(robot.n)).reshape(6, -1)[:, 0]
    upright = np.abs(np.abs(column) - [0, 0, 0, 0, 0, 1]).max() < 1e-9
    return float(np.sign(column[5])) if upright else 0.0


def features(robot: Robot, at: Array, h: Array) -> tuple[Array, Array]:
    """Return what tells hits (N, 3), (N, 3) apart, (N, F), and the azimuths (N,) taken off."""
    if not _turning(robot):
        return np.hstack([at, h]), np.zeros(len(at))
    azimuth = np.arctan2(at[:, 1], at[:, 0])
    c, s = np.cos(azimuth), np.sin(azimuth)
    radial, around = c * h[:, 0] + s * h[:, 1], c * h[:, 1] - s * h[:, 0]
    radius = np.hypot(at[:, 0], at[:, 1])
    return np.column_stack([radius, at[:, 2], radial, around, h[:, 2]]), azimuth


def turned(robot: Robot, q: Array, azimuth: Array, limited: bool = True) -> Array:
    """Return q (N, n) turned about the base by azimuths (N,), joint 1 brought to its limits."""
    moved, sense = q.copy(), _turning(robot)
    if sense:
        moved[:, 0] = (q[:, 0] + sense * azimuth + np.pi) % (2 * np.pi) - np.pi
    return np.clip(moved, robot.lower, robot.upper) if limited else moved
