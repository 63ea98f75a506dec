"""Whether a motion stays clear: of the object until it is hit, of the table, and of itself.

A distance at one moment says that nothing touches before something has moved so far. How far a
shape can have moved is known from its joints' ways and the lengths of the links, so that a motion
is shown to be clear all along by looking at few moments of it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from hitjoints.errors import ModelError
from hitjoints.planning.room.shapes import Scene, scene_of
from hitjoints.vectors import box_axes

if TYPE_CHECKING:
    from hitjoints.model.robot import Contact, Robot
    from hitjoints.types import Array


class Obstacle(NamedTuple):
    """A solid, where it is, what it is called, and the numbers of the shapes to keep off it."""

    name: str
    solid: Any
    placement: Any
    shapes: list[int]


class Clear(NamedTuple):
    """The least distance (m) that was seen, of what, and the row where there was less than asked.

    `row` is None for a way that is clear.
    """

    least: float
    what: str
    row: int | None


class Room:
    """What is around a hit.

    Args:
        robot: the arm.
        margin: m, least distance asked for.
        table: m, height of a table, or None.
    """

    def __init__(self, robot: Robot, margin: float, table: float | None) -> None:
        self.margin, self.known = margin, True
        self._scene: Scene | None = None
        try:
            self._scene = scene_of(robot)
        except ModelError:
            if table is not None:
                raise
            self.known = False
            return
        scene = self._scene
        self._table = None if table is None else Obstacle("table", *scene.place_table(table))
        self._everything = list(range(len(scene.links)))
        self._reach = _reaches(robot, scene)
        pairs = [(pair.first, pair.second) for pair in scene.shapes.collisionPairs]
        # Two links move against each other by what lies between them only.
        between = np.zeros((len(pairs), robot.n))
        for row, (a, b) in enumerate(pairs):
            low, high = sorted((scene.links[a], scene.links[b]))
            far = a if scene.links[a] == high else b
            between[row, low:high] = self._reach[far, low:high]
        self._between = between

    def box(self, q: Array, contact: Contact, h: Array, size: Array, yaw: float) -> Obstacle | None:
        """Return the object that is touched at q (n,) rad; see `Scene.place_box`."""
        if self._scene is None:
            return None
        placed = self._scene.place_box(q, contact, h, size, box_axes(h, yaw))
        return Obstacle("object", *placed)

    def whole(self, box: Obstacle | None) -> Obstacle | None:
        """Return the object, to be avoided by the links that hit it, too."""
        return None if box is None else box._replace(shapes=self._everything)

    def check(self, rows: Array, box: Obstacle | None) -> Clear:
        """Look along a way.

        Args:
            rows: (N, n) rad, near each other.
            box: the object, if it is to be avoided.
        """
        if self._scene is None:
            return Clear(np.inf, "", None)
        scene = self._scene
        solids = [obstacle for obstacle in (self._table, box) if obstacle is not None]
        per_joint = [self._between, *(self._reach[solid.shapes] for solid in solids)]
        rates = np.concatenate(per_joint)
        names = [f"{a} and {b}" for a, b in scene.pairs]
        names += [f"{scene.names[i]} and the {s.name}" for s in solids for i in s.shapes]
        moved = np.zeros((len(rows), len(rates)))
        np.cumsum(np.abs(np.diff(rows, axis=0)) @ rates.T, axis=0, out=moved[1:])
        least, what, k = np.inf, "", 0
        while True:
            distances = list(scene.own_distances(rows[k]))
            for solid in solids:
                distances += scene.distances(solid.solid, solid.placement, solid.shapes)
            room = np.array(distances)
            i = int(np.argmin(room)) if room.size else -1
            if room.size and room[i] < least:
                least, what = float(room[i]), names[i]
            if least < self.margin:
                return Clear(least, what, k)
            if k == len(rows) - 1:
                return Clear(least, what, None)
            far = ((moved[k + 1 :] - moved[k]) > room - self.margin).any(axis=1)
            k = k + 1 + int(np.argmax(far)) if far.any() else len(rows) - 1


def _reaches(robot: Robot, scene: Scene) -> Array:
    """Return how far shapes move at most per unit of each joint, (shapes, n) m/rad (m/m)."""
    model = robot.model
    lengths = [float(np.linalg.norm(placement.translation)) for placement in model.jointPlacements]
    prismatic = [model.joints[i].shortname().startswith("JointModelP") for i in range(robot.n + 1)]
    with np.errstate(invalid="ignore"):
        strokes = np.maximum(np.abs(robot.lower), np.abs(robot.upper))
    reach = np.zeros((len(scene.links), robot.n))
    for shape, link in enumerate(scene.links):
        geometry = scene.shapes.geometryObjects[shape]
        local = geometry.geometry
        beyond = float(np.linalg.norm(geometry.placement.translation))
        beyond += float(np.linalg.norm(local.aabb_center)) + float(local.aabb_radius)
        for joint in range(link, 0, -1):
            if prismatic[joint]:
                reach[shape, joint - 1] = 1.0
                beyond += float(strokes[joint - 1])
            else:
                reach[shape, joint - 1] = beyond
            beyond += lengths[joint]
    return reach
