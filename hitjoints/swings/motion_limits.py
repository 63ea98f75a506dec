"""How much of its limits a motion takes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin

if TYPE_CHECKING:
    from hitjoints.hitting.drive_limits import DriveLimits
    from hitjoints.model.robot import Robot
    from hitjoints.swings.curves import Joints
    from hitjoints.types import Array


def torques(robot: Robot, limits: DriveLimits, joints: Joints) -> Array:
    """Return the torques (N, n) N m of a motion, those that turn the rotors included if known."""
    model, data = robot.model, robot.data
    rows = zip(joints.q, joints.qd, joints.qdd, strict=True)
    links = np.array([pin.rnea(model, data, *row) for row in rows])
    return np.asarray(links + limits.rotor_inertia * joints.qdd)


def greatest_ratios(limits: DriveLimits, joints: Joints) -> tuple[float, float, float]:
    """Return the greatest velocity, acceleration and jerk in units of their limits."""
    return (
        _ratio(joints.qd, -limits.velocity_lower, limits.velocity_upper),
        _ratio(joints.qdd, limits.acceleration, limits.acceleration),
        _ratio(joints.qddd, limits.jerk, limits.jerk),
    )


def _ratio(values: Array, down: Array, up: Array) -> float:
    limit = np.broadcast_to(np.where(values > 0, up, down), values.shape)
    moving = values != 0
    with np.errstate(divide="ignore"):  # a locked joint has no business moving
        return float(np.max(np.abs(values[moving]) / limit[moving], initial=0.0))
