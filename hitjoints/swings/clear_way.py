"""Whether a motion stays clear: of the object until it is hit, of the table, and of itself.

A distance at one moment says that nothing touches before something has moved so far. How far a
shape can have moved is known from its joints' ways and the lengths of the links, so that a motion
is shown to be clear all along by looking at few moments of it.
"""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import pinocchio as pin

from hitjoints.errors import ModelError
from hitjoints.planning.room.shapes import Scene, scene_of

if TYPE_CHECKING:
    from hitjoints.model.robot import Contact, Robot
    from hitjoints.types import Array

SHARP = 5e-4
"""m, to which the least distance of a way is found where it is asked for."""


class Obstacle(NamedTuple):
    """Where the object is (an SE3), and the numbers of the shapes that must keep off it."""

    placement: Any
    shapes: frozenset[int]


class Clear(NamedTuple):
    """The least distance (m) that was seen, of what, and a row where there was less than asked.

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
        size: (3,) m, edges of the object.
    """

    def __init__(self, robot: Robot, margin: float, table: float | None, size: Array) -> None:
        self.margin, self.known = margin, True
        self._robot, self._size = robot, size
        self._scene: Scene | None = None
        try:
            scene = self._scene = scene_of(robot)
        except ModelError:
            if table is not None:
                raise
            self.known = False
            return
        self._shapes = pin.GeometryModel(scene.shapes)
        reach, own = _reaches(robot, scene), list(scene.shapes.collisionPairs)
        self._rates = [_between(scene, reach, pair.first, pair.second) for pair in own]
        self._links, self._names = scene.names, [f"{a} and {b}" for a, b in scene.pairs]
        self._everything = frozenset(range(len(scene.links)))
        if table is not None:
            solid, _, movable = scene.place_table(table)
            self._keep_off("table", solid, movable, reach)
        # Of the object, the number of its pair with each shape.
        self._first = len(self._names)
        where = self._keep_off("object", _box(size), sorted(self._everything), reach)
        self._object = self._shapes.geometryObjects[where]
        self._geometry = pin.GeometryData(self._shapes)
        for request in self._geometry.collisionRequests:
            request.security_margin = margin
        self._bounds = np.array(self._rates)
        self._avoided = self._everything
        self._avoid(None)

    def box(self, q: Array, contact: Contact, h: Array, axes: Array) -> Obstacle | None:
        """Return the object that is touched at q (n,) rad; see `Scene.place_box`."""
        if self._scene is None:
            return None
        _, at, shapes = self._scene.place_box(q, contact, h, self._size, axes)
        placement = pin.SE3(np.array(at.getRotation()), np.array(at.getTranslation()))
        return Obstacle(placement, frozenset(shapes))

    def whole(self, box: Obstacle | None) -> Obstacle | None:
        """Return the object, to be avoided by the links that hit it, too."""
        return None if box is None else box._replace(shapes=self._everything)

    def touches(self, q: Array, box: Obstacle | None) -> bool:
        """Tell whether something is nearer than the margin at q (n,) rad."""
        if self._scene is None:
            return False
        self._avoid(box)
        model, data = self._robot.model, self._robot.data
        return bool(pin.computeCollisions(model, data, self._shapes, self._geometry, q, True))

    def check(self, rows: Array, box: Obstacle | None, *, sharp: bool = False) -> Clear:
        """Look along a way.

        Args:
            rows: (N, n) rad, near each other.
            box: the object, if it is to be avoided.
            sharp: find the least distance of the rows to half a millimetre, too.
        """
        if self._scene is None:
            return Clear(np.inf, "", None)
        self._avoid(box)
        seen = [i for i, active in enumerate(self._geometry.activeCollisionPairs) if active]
        if not seen:
            return Clear(np.inf, "", None)
        moved = np.zeros((len(rows), len(seen)))
        np.cumsum(np.abs(np.diff(rows, axis=0)) @ self._bounds[seen].T, axis=0, out=moved[1:])
        least, what = np.inf, ""
        # The middle of what is not yet shown to be clear, the longest first: it splits in two.
        waiting = deque([(0, len(rows) - 1)])
        while waiting:
            low, high = waiting.popleft()
            k = (low + high) // 2
            room = self._distances(rows[k])[seen]
            i = int(np.argmin(room))
            if room[i] < least:
                least, what = float(room[i]), self._names[seen[i]]
            if least < self.margin:
                return Clear(least, what, k)
            asked = max(self.margin, least - SHARP) if sharp else self.margin
            near = (np.abs(moved[low : high + 1] - moved[k]) <= room - asked).all(axis=1)
            before, after = np.flatnonzero(~near[: k - low]), np.flatnonzero(~near[k - low :])
            if before.size:
                waiting.append((low, low + int(before[-1])))
            if after.size:
                waiting.append((k + int(after[0]), high))
        return Clear(least, what, None)

    def _distances(self, q: Array) -> Array:
        model, data, geometry = self._robot.model, self._robot.data, self._geometry
        pin.computeDistances(model, data, self._shapes, geometry, q)
        results = geometry.distanceResults
        return np.fromiter((result.min_distance for result in results), float, len(self._names))

    def _avoid(self, box: Obstacle | None) -> None:
        """Look at no shape's distance to the object but those that must keep off it."""
        wanted: frozenset[int] = frozenset()
        if box is not None:
            self._object.placement, wanted = box.placement, box.shapes
        for shape in wanted - self._avoided:
            self._geometry.activateCollisionPair(self._first + shape)
        for shape in self._avoided - wanted:
            self._geometry.deactivateCollisionPair(self._first + shape)
        self._avoided = wanted

    def _keep_off(self, name: str, solid: Any, shapes: list[int], reach: Array) -> int:
        """Add a solid that shapes must not touch, and return its number."""
        thing = pin.GeometryObject(name, 0, 0, pin.SE3.Identity(), solid)
        number = int(self._shapes.addGeometryObject(thing))
        for shape in shapes:
            self._shapes.addCollisionPair(pin.CollisionPair(shape, number))
            self._rates.append(reach[shape])
            self._names.append(f"{self._links[shape]} and the {name}")
        return number


def _box(size: Array) -> Any:
    import coal

    return coal.Box(*size)


def _between(scene: Scene, reach: Array, first: int, second: int) -> Array:
    """Return how fast two shapes approach at most, (n,) m/rad: by what lies between them only."""
    low, high = sorted((scene.links[first], scene.links[second]))
    far = first if scene.links[first] == high else second
    rates = np.zeros(reach.shape[1])
    rates[low:high] = reach[far, low:high]
    return rates


def axes_along(h: Array, yaw: float) -> Array:
    """Return the axes (3, 3) of a box along h, across it and upwards, turned by yaw (rad)."""
    across = np.cross([0.0, 0.0, 1.0], h)
    size = float(np.linalg.norm(across))
    across = across / size if size > 1e-9 else np.array([0.0, 1.0, 0.0])
    c, s = np.cos(yaw), np.sin(yaw)
    up = np.cross(h, across)
    return np.column_stack((c * h + s * across, c * across - s * h, up))


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
