"""What is dragged in the scene: the object, and where it is to go."""

from __future__ import annotations

from functools import partial
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

    A browser moves them while what it moved them by before is still being drawn: what was dragged
    since it was last read is never put back.

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
        self._read = {one.name: _place(one) for one in (self._object, self._aim)}
        self._dragged = ""
        for handle, change in ((self._object, stage.move_object), (self._aim, self._aimed)):
            handle.on_update(partial(self._moved, handle, change, drag))
        self.draw()

    def draw(self) -> None:
        """Put them where the stage says; a goal is dragged on its table only."""
        stage = self._stage
        at_goal, tip = stage.wish.goal is not None, aim_point(stage)
        for handle, to in ((self._object, stage.wish.position), (self._aim, tip)):
            self._put(handle, to)
        self._dragged = ""
        self._name.position = tip + np.array((0.0, 0.0, 0.6 * SCALE))
        words = "goal" if at_goal else "direction"
        if self._name.text != words:
            self._name.text = words
            self._aim.active_axes = (True, True, not at_goal)

    def _put(self, handle: Any, to: Array) -> None:
        is_read = np.array_equal(_place(handle), self._read[handle.name])
        if is_read and handle.name != self._dragged and not np.allclose(to, _place(handle)):
            handle.position = to
            self._read[handle.name] = _place(handle)

    def show(self, visible: bool) -> None:
        """Show or hide them."""
        for one in (self._object, self._aim, self._name):
            one.visible = visible

    def _moved(
        self,
        handle: Any,
        change: Callable[[Array], None],
        drag: Callable[[Callable[[], None]], None],
        _: object,
    ) -> None:
        def work() -> None:
            self._read[handle.name], self._dragged = _place(handle), handle.name
            change(np.round(_place(handle), 3))  # to the millimetre

        if not np.array_equal(_place(handle), self._read[handle.name]):
            drag(work)

    def _aimed(self, to: Array) -> None:
        stage = self._stage
        way = to - stage.wish.position
        if stage.wish.goal is not None:
            if np.hypot(*way[:2]) > NEAR:
                stage.aim_at(to)
        elif np.linalg.norm(way) > NEAR:
            stage.aim_along(way)


def _place(handle: Any) -> Array:
    return np.array(handle.position, dtype=float)
