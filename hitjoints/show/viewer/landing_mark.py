"""The table, and on it where the box comes to rest: an ellipse of two standard deviations."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pinocchio as pin

from hitjoints.show.drawn_arm import BOX, rgb

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from hitjoints.show.viewer.stage import Stage
    from hitjoints.types import Array

TABLE, LANDING = "#b08968", "#7048e8"
AROUND = 0.22  # m, of the table beyond what stands on it
SIGMAS = 2.0
LEAST = 0.01  # m, half an axis of the ellipse, so that it is seen where nothing is spread
CORNERS = 64
ABOVE = 0.002  # m, of the ellipse over the table


class LandingMark:
    """Draws the table, the goal and the ellipse of a stage.

    Args:
        scene: viser's.
        stage: what is drawn.
    """

    def __init__(self, scene: Any, stage: Stage) -> None:
        self._scene, self._stage = scene, stage

    def draw(self) -> None:
        """Put them where the stage says; what is not known is not drawn."""
        scene, stage = self._scene, self._stage
        begin = stage.begin
        height = stage.wish.setting.table_height
        level = begin.bottom if height is None else height
        found = None
        if stage.candidate is not None or stage.clip is not None:
            found = stage.rest[0]
        ends = [begin.centre[:2]]
        if stage.wish.goal is not None:
            ends.append(stage.wish.goal[:2])
        if found is not None:
            ends.append(found.mean[:2])
        low, high = np.min(ends, axis=0) - AROUND, np.max(ends, axis=0) + AROUND
        middle, (length, width) = (low + high) / 2, high - low
        scene.add_box(
            "/table",
            rgb(TABLE),
            (float(length), float(width), 0.01),
            opacity=0.6,
            cast_shadow=False,
            position=(*middle, level - 0.006),
        )
        for name in ("/landing", "/landing_label", "/rest"):
            scene.remove_by_name(name)
        if found is None:
            return
        # The ellipse is about the place of the box's centre, as the box is seen to stop.
        shift = found.mean[:2] - stage.wish.position[:2]
        centre = np.append(begin.centre[:2] + shift, level + ABOVE)
        outline = ellipse(found.covariance)
        points = np.vstack((np.zeros(3), np.column_stack((outline, np.zeros(CORNERS)))))
        ring = np.arange(1, CORNERS + 1)
        faces = np.column_stack((np.zeros(CORNERS, int), ring, np.roll(ring, -1)))
        scene.add_mesh_simple(
            "/landing",
            points,
            faces,
            color=rgb(LANDING),
            side="double",
            cast_shadow=False,
            position=centre,
        )
        place = begin.moved(np.append(shift, 0.0), found.yaw)
        scene.add_box(
            "/rest",
            rgb(BOX),
            tuple(map(float, place.size)),
            wireframe=True,
            cast_shadow=False,
            position=place.centre,
            wxyz=quaternion(place.axes),
        )
        scene.add_label("/landing_label", "stops here", position=centre, anchor="top-center")


def ellipse(covariance: ArrayLike) -> Array:
    """Return the outline (CORNERS, 2) m of so many standard deviations of a covariance (2, 2)."""
    variances, axes = np.linalg.eigh(np.asarray(covariance, dtype=float))
    half = np.maximum(SIGMAS * np.sqrt(variances.clip(0)), LEAST)
    around = np.linspace(0, 2 * np.pi, CORNERS, endpoint=False)
    return np.asarray(np.column_stack((np.cos(around), np.sin(around))) * half @ axes.T)


def quaternion(rotation: Array) -> NDArray[np.float64]:
    """Return a rotation (3, 3) as w, x, y, z."""
    return np.asarray(pin.Quaternion(np.ascontiguousarray(rotation)).coeffs()[[3, 0, 1, 2]])
