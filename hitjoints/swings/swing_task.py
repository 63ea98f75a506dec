"""What a swing is asked: which arm makes which hit, from where, within what."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from hitjoints.hit import Hit
    from hitjoints.hitting.drive_limits import DriveLimits
    from hitjoints.model.robot import Robot
    from hitjoints.swings.clear_way import Room
    from hitjoints.types import Array


class SwingTask(NamedTuple):
    """What a swing is asked.

    Attributes:
        robot: the arm.
        hit: what it is to make.
        limits: of its drives.
        room: what is around.
        start: (n,) rad, where the arm is.
    """

    robot: Robot
    hit: Hit
    limits: DriveLimits
    room: Room
    start: Array
