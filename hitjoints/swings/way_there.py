"""From the start to the wind-up: from rest to rest, straight in joint space or by detours."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING

import numpy as np

from hitjoints.swings.clear_way import Obstacle, Room
from hitjoints.swings.curves import Line, line_between
from hitjoints.swings.detours import clear_between, detour
from hitjoints.swings.motion_limits import torques

if TYPE_CHECKING:
    from hitjoints.hitting.drive_limits import DriveLimits
    from hitjoints.model.robot import Robot
    from hitjoints.types import Array

VIAS = 6
"""Random configurations that a way may lead through, if it cannot be straight."""
MOMENTS, USED = 40, 0.97
"""Of a line that its torques are looked at, and share of their limits that is used."""
SLOWER, SLOWEST = 1.25, 12.0
"""Factor by which a line is slowed down whose torques do not fit, and the most of that."""
COLLISION = "collision"
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
    reason = COLLISION
    for i in range(VIAS + 1):
        corners = [start, end]
        if i:
            # Detours near the way first: the middle of it, and ever more at random.
            share = i / VIAS
            middle = 0.5 * (start + end)
            corners.insert(1, middle + share * (rng.uniform(low, high) - middle))
        if all(clear_between(room, box, a, b) for a, b in itertools.pairwise(corners)):
            lines = _lines(robot, limits, corners)
            if lines is not None:
                return lines
            reason = "torque"
    found = detour(room, box, (start, end), (low, high), rng) if reason == COLLISION else None
    lines = None if found is None else _lines(robot, limits, found)
    return f"way there: {reason}" if lines is None else lines


def _lines(robot: Robot, limits: DriveLimits, corners: list[Array]) -> list[Line] | None:
    """Return the lines from corner to corner; None if torques never fit one."""
    lines = []
    for a, b in itertools.pairwise(corners):
        line = _slowed(robot, limits, line_between(a, b, limits))
        if line is None:
            return None
        lines.append(line)
    return lines


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
