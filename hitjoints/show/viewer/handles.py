"""What is dragged in the scene: the object, and where it is to go."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from hitjoints.show.viewer.drawing import aim_point

if TYPE_CHECKING:
    from collections.abc import Callable

    from hitjoints.show.viewer.stage import Stage
    from hitjoints.types import Array

SCALE = 0.16  # m, of a handle's arrows
NEAR = 0.02  # m, from the object: a tip so near it tells no direction


class Handles:
    """Two sets of arrows to drag.

    Args:
        scene: viser's.
        stage: that they stand for.
        drag: called with a change of the stage to make.
    """

    def __init__(
        self, scene: Any, stage: Stage, drag: Callable[[Callable[[], None]], None]
    ) -> None:
        self._stage = stage
        like = {"scale": SCALE, "disable_rotations": True, "depth_test": False}
        self._object = scene.add_transform_controls("/drag_object", **like)
        self._aim = scene.add_transform_controls("/drag_aim", **like)
        self._name = scene.add_label("/drag_aim_label", "", anchor="bottom-center")
        self._object.on_update(lambda event: drag(lambda: self._moved(event.target)))
        self._aim.on_update(lambda event: drag(lambda: self._aimed(event.target)))
        self.draw()

    def draw(self) -> None:
        """Put them where the stage says; a goal is dragged on its table only."""
        stage = self._stage
        at_goal, tip = stage.wish.goal is not None, aim_point(stage)
        if not np.allclose(self._object.position, stage.wish.position, atol=1e-6):
            self._object.position = stage.wish.position
        if not np.allclose(self._aim.position, tip, atol=1e-6):
            self._aim.position = tip
        self._name.position = tip + np.array((0.0, 0.0, 0.6 * SCALE))
        words = "goal" if at_goal else "direction"
        if self._name.text != words:
            self._name.text = words
            self._aim.active_axes = (True, True, not at_goal)

    def show(self, visible: bool) -> None:
        """Show or hide them."""
        for one in (self._object, self._aim, self._name):
            one.visible = visible

    def _moved(self, handle: Any) -> None:
        self._stage.move_object(_place(handle))

    def _aimed(self, handle: Any) -> None:
        stage, to = self._stage, _place(handle)
        way = to - stage.wish.position
        if stage.wish.goal is not None:
            if np.hypot(*way[:2]) > NEAR:
                stage.aim_at(to)
        elif np.linalg.norm(way) > NEAR:
            stage.aim_along(way)


def _place(handle: Any) -> Array:
    """Return where a handle was dragged to, to the millimetre."""
    return np.round(np.asarray(handle.position, dtype=float), 3)
