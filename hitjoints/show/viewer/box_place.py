"""Where the box is: its edges, and its pose before the hit and along its slide."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from hitjoints.hit import Hit
    from hitjoints.types import Array

EDGE = 0.1
"""m, of a box whose size is not given."""


class BoxPlace(NamedTuple):
    """A box: its edges (3,) m, centre (3,) m, and axes as columns (3, 3)."""

    size: Array
    centre: Array
    axes: Array

    @property
    def bottom(self) -> float:
        """Height of its lowest point, m."""
        return float(self.centre[2] - np.abs(self.axes[2]) @ self.size / 2)

    def moved(self, by: Array, turned: float) -> BoxPlace:
        """Return the same box moved (3,) m and turned (rad) about the vertical."""
        return BoxPlace(self.size, self.centre + by, _turn(turned) @ self.axes)


def box_place(hit: Hit) -> BoxPlace:
    """Return the box at rest, hit in the middle of what it turns to the arm.

    A size is along the direction, across it and upwards, turned by the yaw; edges that are given
    along the axes of the base frame keep to those.
    """
    h, setting = hit.direction, hit.setting
    if hit.size is None and setting.object_size is not None:
        size = np.array(setting.object_size)
        ahead = np.min(size / 2 / np.maximum(np.abs(h), np.finfo(float).tiny))
        return BoxPlace(size, hit.position + ahead * h, np.eye(3))
    size = np.full(3, EDGE) if hit.size is None else np.asarray(hit.size)
    yaw = 0.0 if hit.size is None else hit.yaw
    across = np.cross((0.0, 0.0, 1.0), h)
    length = np.linalg.norm(across)
    across = across / length if length > 0 else np.array((0.0, 1.0, 0.0))
    axes = np.column_stack((h, across, np.cross(h, across)))
    # The line of the hit passes through the centre.
    centre = hit.position + size[0] / 2 / np.cos(yaw) * h
    return BoxPlace(size, centre, axes @ _turn(yaw))


def _turn(angle: float) -> Array:
    cos, sin = np.cos(angle), np.sin(angle)
    return np.array(((cos, -sin, 0.0), (sin, cos, 0.0), (0.0, 0.0, 1.0)))
