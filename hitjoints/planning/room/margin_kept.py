"""Configurations that keep a margin, and which came nearest to it where none does."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from hitjoints.planning.room.clearance import Clearance
    from hitjoints.planning.room.surroundings import Surroundings
    from hitjoints.planning.task import Task
    from hitjoints.types import Array


class MarginKept:
    """Accepts configurations that keep a margin, and whatever else is demanded of them.

    Args:
        task: the hit.
        around: with a margin.
        more: asked of those that keep it.
    """

    def __init__(
        self, task: Task, around: Surroundings, more: Callable[[Array], bool] | None
    ) -> None:
        self._task, self._around, self._more = task, around, more
        self._nearest: Clearance | None = None

    def __call__(self, q: Array) -> bool:
        """Tell whether a configuration (n,) rad is accepted."""
        task = self._task
        room = self._around.look(task.robot, q, task.contact, task.direction)
        if self._nearest is None or room.least > self._nearest.least:
            self._nearest = room
        return room.least >= (self._around.margin or 0.0) and (self._more is None or self._more(q))

    @property
    def reason(self) -> str:
        """What is nearest to what where the margin is kept best; empty if it is kept."""
        room, margin = self._nearest, self._around.margin
        if room is None or margin is None or room.least >= margin:
            return ""
        nearest = min(room.closest, key=lambda name: float(getattr(room, name)))
        pair = " and ".join(room.closest[nearest])
        return f"margin of {margin:g} m not kept: {pair} come within {room.least:.3g} m at best"
