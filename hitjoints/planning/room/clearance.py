"""How far the rest of the arm stays from the object, the table and itself.

Distances are those of the robot's collision shapes, by Coal; meshes count as their convex hulls.
What may touch is left out, and only that:

- Object: the hitting link k. When the contact is the origin of joint k, link k - 1 carries that
  point too (its velocity is the same on both), and is left out with it.
- Table: the base, and links that a vertical joint 1 (2, ...) turns without changing their height.
- Itself: neighbours in the chain, and links two or more apart that stay within 15 cm of each other
  in all configurations: they are built that close, and would hide every other distance.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from hitjoints.errors import InputError
from hitjoints.planning.room.shapes import scene_of
from hitjoints.planning.start import approach_path
from hitjoints.told import Told
from hitjoints.vectors import points, unit

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from hitjoints.model.robot import Contact, Robot
    from hitjoints.types import Array


@dataclass(frozen=True, repr=False)
class Clearance(Told):
    """The least distances over a configuration or a path; negative is penetration.

    Attributes:
        object: m, of the rest of the arm from the object; inf when there is none.
        table: m, of the arm from the table; inf when there is none.
        itself: m, of the arm's links from each other; inf when no two can touch.
        closest: for each of the names above what is closest, such as ("link_4", "table").
        approach: m, length of the straight approach that was looked at.
    """

    object: float
    table: float
    itself: float
    closest: dict[str, tuple[str, str]]
    approach: float = 0.0

    def as_dict(self) -> dict[str, Any]:
        """Return the distances by name (None where nothing is near) and what is closest."""
        names = ("object", "table", "itself", "least", "approach")
        values = {name: float(getattr(self, name)) for name in names}
        shown = {name: value if np.isfinite(value) else None for name, value in values.items()}
        return shown | {"closest": {name: list(pair) for name, pair in self.closest.items()}}

    @property
    def least(self) -> float:
        """The least of the three distances, m."""
        return min(self.object, self.table, self.itself)


def clearance(
    robot: Robot,
    q: ArrayLike,
    contact: Contact | int,
    direction: ArrayLike,
    object_size: ArrayLike | None = None,
    table_height: float | None = None,
    *,
    approach: float = 0.0,
) -> Clearance:
    """Return how far the rest of the arm stays from the object, the table and itself.

    The object is a box aligned with the axes of the base frame, hit centrally: its centre lies
    ahead of the contact point along the direction, so far that its near face is at the contact
    point, or, when that lies inside the links that carry it, at their surface ahead of it. The
    box stays there while the arm approaches.

    Args:
        robot: the arm.
        q: (n,) rad, the hitting configuration, or (S, n), a path that ends with it.
        contact: joint number or Contact.
        direction: (3,), the hitting direction.
        object_size: (3,) m, edges of the box.
        table_height: m, of the table's plane z = height, without edges.
        approach: m, of straight approach to look at before q (before its first row, for a path).
            Where the arm cannot follow it all, `Clearance.approach` is shorter.

    Raises:
        InputError: an argument cannot be used; q outside the limits when there is an approach.
        ModelError: the collision shapes cannot be read, or there are none.
    """
    contact, h = robot.contact(contact), unit(direction)
    path = np.atleast_2d(robot.configuration(q))
    if h.shape != (3,):
        raise InputError("direction", f"shape {h.shape}", "one direction of three numbers")
    size = None if object_size is None else _box(object_size)
    if table_height is not None and not np.isfinite(table_height):
        raise InputError("table_height", table_height, "a finite height in metres")
    if not (np.isfinite(approach) and approach >= 0):
        raise InputError("approach", approach, "a length in m, not below zero")
    covered = 0.0
    scene, hit = scene_of(robot), path[-1]
    if approach > 0:
        before, _ = approach_path(robot, path[0], contact, h, approach)
        ends = scene.point(path[0], contact), scene.point(before[0], contact)
        covered = float(h @ (ends[0] - ends[1]))
        path = np.concatenate([before[:-1], path])
    fixed: dict[str, tuple[Any, Any, list[int]]] = {}
    if size is not None:
        fixed["object"] = scene.place_box(hit, contact, h, size)
    if table_height is not None:
        fixed["table"] = scene.place_table(table_height)
    none: tuple[float, tuple[str, str]] = (np.inf, ("", ""))
    best = dict.fromkeys(("object", "table", "itself"), none)
    for row in path:
        best["itself"] = min(best["itself"], scene.own_distance(row))
        for name, obstacle in fixed.items():
            distance, link = scene.distance(*obstacle)
            best[name] = min(best[name], (distance, (link, name)))
    closest = {name: pair for name, (distance, pair) in best.items() if distance < np.inf}
    return Clearance(
        best["object"][0], best["table"][0], best["itself"][0], closest, approach=covered
    )


def _box(size: ArrayLike) -> Array:
    edges = points(size, "object_size")
    if edges.shape != (3,) or not (edges > 0).all():
        raise InputError("object_size", edges.tolist(), "three lengths above zero")
    return edges
