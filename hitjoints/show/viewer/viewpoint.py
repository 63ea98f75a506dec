"""Where the scene is looked at from, so that all of it is seen beside the panel."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from hitjoints.dynamics.kinematics import position
from hitjoints.show.viewer.drawing import aim_point

if TYPE_CHECKING:
    from hitjoints.show.viewer.stage import Stage
    from hitjoints.types import Array

FIELD = math.radians(45.0)  # of view, upwards
ASIDE = math.radians(-65.0)  # from the hitting direction: it crosses the picture
ABOVE = math.radians(27.0)
ROOM = 0.1  # m, of the arm around its joints
PORTRAIT = 0.8
"""Width over height below which the panel is a sheet over the lower half, not a column."""


WIDE = 1.6
"""Width over height of a usual window."""


class Viewpoint(NamedTuple):
    """Where the eye is, and where it looks, (3,) m each."""

    position: Array
    look_at: Array


def viewpoint(stage: Stage, aspect: float | None) -> Viewpoint:
    """Return where a stage is looked at from.

    Args:
        stage: what is seen.
        aspect: width of the picture over its height, with the panel over a part of it; None for a
            page without a panel, which may be wide or upright.
    """
    low, high = _extent(stage)
    middle, radius = (low + high) / 2, float(np.linalg.norm(high - low)) / 2
    h = stage.wish.direction
    heading = math.atan2(h[1], h[0]) + ASIDE if np.hypot(*h[:2]) > 0 else ASIDE
    back = np.array((math.cos(heading), math.sin(heading), 0.0)) * math.cos(ABOVE)
    back[2] = math.sin(ABOVE)
    right = np.cross((0.0, 0.0, 1.0), back)
    right = right / np.linalg.norm(right)
    if aspect is None:
        free, shift = 0.65, np.zeros(3)
    elif aspect < PORTRAIT:  # the panel leaves half of the height
        free, shift = min(0.5, aspect), np.array((0.0, 0.0, -0.5))
    else:  # it leaves three quarters of the width
        free, shift = min(1.0, 0.75 * aspect), 0.2 * aspect * right
    distance = radius / (free * math.tan(FIELD / 2))
    look_at = middle + shift * distance * math.tan(FIELD / 2)
    return Viewpoint(look_at + distance * back, look_at)


def look(camera: Any, stage: Stage, aspect: float | None) -> None:
    """Let a camera look at all of a stage; see `viewpoint`."""
    eye = viewpoint(stage, aspect)
    camera.position, camera.look_at, camera.fov = eye.position, eye.look_at, FIELD


def fit_phone(camera: Any, stage: Stage) -> None:
    """Let a phone that is held upright see the scene above its sheet of controls.

    The browser takes the usual view when it comes to it, which may be later than this.

    Args:
        camera: of a browser that has just come.
        stage: what is seen.
    """
    usual = viewpoint(stage, WIDE).position

    def fit(_: object) -> None:
        if camera.aspect < PORTRAIT and np.allclose(camera.position, usual, atol=1e-3):
            look(camera, stage, camera.aspect)

    camera.on_update(fit)
    if camera.aspect < PORTRAIT:
        look(camera, stage, camera.aspect)


def _extent(stage: Stage) -> tuple[Array, Array]:
    """Return the least and the greatest corner of what is seen, (3,) m each."""
    robot, wish = stage.robot, stage.wish
    points = [np.zeros(3), wish.position, aim_point(stage)]
    for q in (robot.home, stage.q):
        points += [position(robot, q, k) for k in range(1, robot.n + 1)]
        points.append(position(robot, q, robot.flange))
    return np.min(points, axis=0) - ROOM, np.max(points, axis=0) + ROOM
