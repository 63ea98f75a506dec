"""From the start to the wind-up: from rest to rest, straight in joint space or by a few detours."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING

import numpy as np

from hitjoints.swings.clear_way import Obstacle, Room
from hitjoints.swings.curves import Line, line_between
from hitjoints.swings.motion_limits import torques

if TYPE_CHECKING:
    from hitjoints.hitting.drive_limits import DriveLimits
    from hitjoints.model.robot import Robot
    from hitjoints.types import Array

VIAS = 20
"""Random configurations that a way may lead through, if it cannot be straight."""
MOMENTS, USED = 40, 0.97
"""Of a line that its torques are looked at, and share of their limits that is used."""
SLOWER, SLOWEST = 1.25, 12.0
"""Factor by which a line is slowed down whose torques do not fit, and the most of that."""
FINE = 0.01
"""rad, that a joint moves between rows whose clearance may be looked at."""
THERE = 1e-12
"""rad, a way shorter than that is none."""


def way_there(
    robot: Robot,
    limits: DriveLimits,
    room: Room,
    box: Obstacle | None,
    start: Array,
    end: Array,
    rng: np.random.Generator,
) -> list[Line] | str:
    """Return the lines of a way, or what is in the way.

    Args:
        robot: the arm and what is around.
        limits: the arm and what is around.
        room: the arm and what is around.
        box: the object, which nothing may touch on the way.
        start: (n,) rad.
        end: (n,) rad.
        rng: of the detours.
    """
    if np.abs(end - start).max() <= THERE:
        return []
    low, high = robot.finite_limits
    reason = ""
    for i in range(VIAS + 1):
        corners = [start, end]
        if i:
            # Detours near the way first: the middle of it, and ever more at random.
            share = i / VIAS
            middle = 0.5 * (start + end)
            corners.insert(1, middle + share * (rng.uniform(low, high) - middle))
        lines = [line_between(a, b, limits) for a, b in itertools.pairwise(corners)]
        if not all(_clear(room, box, line) for line in lines):
            reason = reason or "collision"
            continue
        slowed = [_slowed(robot, limits, line) for line in lines]
        if all(line is not None for line in slowed):
            return [line for line in slowed if line is not None]
        reason = "torque"
    return f"way there: {reason}"


def _clear(room: Room, box: Obstacle | None, line: Line) -> bool:
    steps = int(np.ceil(np.abs(line.end - line.start).max() / FINE)) + 1
    rows = line.start + np.linspace(0.0, 1.0, steps + 1)[:, None] * (line.end - line.start)
    return room.check(rows, box).row is None


def _slowed(robot: Robot, limits: DriveLimits, line: Line) -> Line | None:
    """Return the line, slowed down until its torques fit; None if they never do."""
    slowness = 1.0
    while slowness <= SLOWEST:
        slower = Line(line.start, line.end, line.ramp, line.cruise, slowness)
        joints = slower.at(np.linspace(0.0, slower.duration, MOMENTS))
        if (np.abs(torques(robot, limits, joints)) <= USED * limits.effort).all():
            return slower
        slowness *= SLOWER
    return None
