"""The fastest straight motion that an arm can have in a configuration between rest and rest."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hitjoints.dynamics.kinematics import jacobian
from hitjoints.hitting.drive_limits import DriveLimits, drive_limits
from hitjoints.hitting.velocity_box import velocity_box
from hitjoints.programs.hitting_speed import solve_hitting_speed

if TYPE_CHECKING:
    from hitjoints.model.robot import Contact, Robot
    from hitjoints.types import Array


def deliverable_speed(
    robot: Robot, q: Array, contact: Contact, h: Array, limits: DriveLimits | None = None
) -> float:
    """Return the greatest straight speed that can be reached from rest, and stopped from.

    Args:
        robot: the arm.
        q: (n,) rad within the limits.
        contact: what hits.
        h: (3,) unit vector.
        limits: of the drives; by default the robot's.

    Returns:
        m/s, by a certified linear program over the tightened velocity limits.

    Raises:
        InputError: no acceleration limit is known.
        SolverError: the answer could not be certified.
    """
    limits = drive_limits(robot) if limits is None else limits
    box = velocity_box(limits, q, robot.lower, robot.upper)
    return max(solve_hitting_speed(jacobian(robot, q, contact), h, *box, straight=True).speed, 0.0)
