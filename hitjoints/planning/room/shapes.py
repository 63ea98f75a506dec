"""The arm's collision shapes and what stands around it, for Coal."""

from __future__ import annotations

import threading
from functools import lru_cache
from itertools import combinations
from typing import TYPE_CHECKING, Any
from weakref import WeakKeyDictionary

import numpy as np
import pinocchio as pin

from hitjoints.errors import ModelError
from hitjoints.model.meshes import MeshError, convex_hull

if TYPE_CHECKING:
    from hitjoints.model.robot import Contact, Robot
    from hitjoints.types import Array

ALWAYS_NEAR = 0.15
"""m: links that never get further apart than this are close by construction."""
CONFIGURATIONS = 300  # random ones, to find those links
SURFACE = 1e-5  # m, accuracy of the surface found ahead of a contact point
LOOKS = 100  # steps towards that surface


class Scene:
    """One thread's work space for the distances of an arm.

    Args:
        robot: the arm.

    Raises:
        ModelError: see `clearance`.
    """

    def __init__(self, robot: Robot) -> None:
        self.model, self.data = robot.model, robot.model.createData()
        self.shapes, self.level = _shapes(robot)
        self.geometry = pin.GeometryData(self.shapes)
        self.links = [int(shape.parentJoint) for shape in self.shapes.geometryObjects]
        self.solids = [shape.geometry for shape in self.shapes.geometryObjects]
        frames = [int(shape.parentFrame) for shape in self.shapes.geometryObjects]
        self.names = [str(self.model.frames[frame].name) for frame in frames]
        pairs = self.shapes.collisionPairs
        self.pairs = [(self.names[pair.first], self.names[pair.second]) for pair in pairs]

    def point(self, q: Array, contact: Contact) -> Array:
        """Return the contact point (3,) m, and leave the arm at q."""
        pin.updateGeometryPlacements(self.model, self.data, self.shapes, self.geometry, q)
        return np.array(self.data.oMi[contact.joint].act(np.array(contact.offset)))

    def own_distance(self, q: Array) -> tuple[float, tuple[str, str]]:
        """Return the least distance of two links at q and their names; leave the arm there."""
        distances = self.own_distances(q)
        if not distances:
            return np.inf, ("", "")
        least = int(np.argmin(distances))
        return distances[least], self.pairs[least]

    def own_distances(self, q: Array) -> list[float]:
        """Return the distances of all `pairs` of links at q; leave the arm there."""
        # A pair's solver begins where it ended last: up to 1e-6 m would depend on what was asked
        # before.
        self.geometry = pin.GeometryData(self.shapes)
        pin.computeDistances(self.model, self.data, self.shapes, self.geometry, q)
        return [result.min_distance for result in self.geometry.distanceResults]

    def distance(self, solid: Any, placement: Any, shapes: list[int]) -> tuple[float, str]:
        """Return the least distance of some shapes, where they are, from a solid; and which."""
        distances = self.distances(solid, placement, shapes)
        least = int(np.argmin(distances)) if distances else -1
        return (distances[least], self.names[shapes[least]]) if distances else (np.inf, "")

    def distances(self, solid: Any, placement: Any, shapes: list[int]) -> list[float]:
        """Return the distances of some shapes, where they are, from a solid."""
        return [self._distance(i, solid, placement) for i in shapes]

    def place_box(
        self, q: Array, contact: Contact, h: Array, size: Array, turned: Array | None = None
    ) -> tuple[Any, Any, list[int]]:
        """Return the object, its placement, and the shapes that must not touch it.

        Args:
            q: (n,) rad, where the contact touches it.
            contact: what hits.
            h: (3,) unit vector, the direction.
            size: (3,) m, edges.
            turned: (3, 3), the axes of these edges as columns; by default those of the base.
        """
        import coal

        carriers = {contact.joint} if any(contact.offset) else {contact.joint, contact.joint - 1}
        axes = np.eye(3) if turned is None else turned
        here = self.point(q, contact)
        # A ray from the centre along h leaves the box after this length.
        half = np.min(size / 2 / np.maximum(np.abs(h @ axes), np.finfo(float).tiny))
        ahead = self._surface(here, h, [i for i, k in enumerate(self.links) if k in carriers])
        centre = coal.Transform3s(axes, here + (ahead + half) * h)
        others = [i for i, k in enumerate(self.links) if k not in carriers]
        return coal.Box(*size), centre, others

    def place_table(self, height: float) -> tuple[Any, Any, list[int]]:
        """Return the table, its placement, and the shapes that must not touch it."""
        import coal

        below = coal.Halfspace(np.array([0.0, 0.0, 1.0]), float(height))
        movable = [i for i, k in enumerate(self.links) if k > self.level]
        return below, coal.Transform3s.Identity(), movable

    def _surface(self, here: Array, h: Array, shapes: list[int]) -> float:
        """Return how far ahead of a point the outermost surface of some shapes is, or 0.

        From outside, a convex shape lies beyond the plane through its nearest point: until the ray
        meets that plane it does not meet the shape.
        """
        import coal

        point = coal.Sphere(SURFACE)
        beside = [self._off(i, point, coal.Transform3s(np.eye(3), here))[0] for i in shapes]
        boxes = (2 * self.solids[i].aabb_radius for i in shapes)
        ahead = max((d + b for d, b in zip(beside, boxes, strict=True)), default=0.0) + SURFACE
        for _ in range(LOOKS):
            at, step = coal.Transform3s(np.eye(3), here + ahead * h), np.inf
            for i in shapes:
                distance, away = self._off(i, point, at)
                towards = float(away @ h)
                if distance <= 0:
                    step = 0.0
                elif towards > 0:
                    step = min(step, distance / towards)
            if step <= 0:
                break
            ahead -= step + SURFACE
            if ahead <= 0:
                return 0.0
        return ahead

    def _distance(self, shape: int, solid: Any, placement: Any) -> float:
        return self._off(shape, solid, placement)[0]

    def _off(self, shape: int, solid: Any, placement: Any) -> tuple[float, Array]:
        """Return the distance of a shape from a solid, and the direction (3,) to there."""
        import coal

        where = self.geometry.oMg[shape]
        at = coal.Transform3s(where.rotation, where.translation)
        result = coal.DistanceResult()
        request = coal.DistanceRequest()
        found = coal.distance(self.solids[shape], at, solid, placement, request, result)
        return float(found), result.normal


_OF_THREAD = threading.local()


def scene_of(robot: Robot) -> Scene:
    """Return this thread's scene of a robot."""
    scenes = _OF_THREAD.__dict__.setdefault("scenes", WeakKeyDictionary())
    if robot not in scenes:
        scenes[robot] = Scene(robot)
    scene: Scene = scenes[robot]
    return scene


@lru_cache(maxsize=16)
def _shapes(robot: Robot) -> tuple[Any, int]:
    """Return the convex collision shapes with their pairs, and the last link of constant height."""
    if robot.tool is not None and robot.tool.radius is None:
        reason = "its tool has no radius, so the room it needs is not known"
        raise ModelError(robot.name, reason)
    shapes = pin.GeometryModel(robot.collision_model)
    if not shapes.ngeoms:
        raise ModelError(robot.name, "it has no collision shapes, so distances cannot be told")
    for shape in shapes.geometryObjects:
        if hasattr(shape.geometry, "buildConvexHull"):
            try:
                shape.geometry = convex_hull(shape.geometry)
            except MeshError as error:
                raise ModelError(robot.name, f"{error} ({shape.name})") from None
        shape.geometry.computeLocalAABB()
    links = [int(shape.parentJoint) for shape in shapes.geometryObjects]
    pairs = [(a, b) for a, b in combinations(range(len(links)), 2) if abs(links[a] - links[b]) > 1]
    for pair in pairs:
        shapes.addCollisionPair(pin.CollisionPair(*pair))
    between = [(links[a], links[b]) for a, b in pairs]
    farthest = _farthest(robot, shapes, between)
    shapes.removeAllCollisionPairs()
    for pair, ends in zip(pairs, between, strict=True):
        if farthest[ends] >= ALWAYS_NEAR:
            shapes.addCollisionPair(pin.CollisionPair(*pair))
    return shapes, _level_links(robot)


def _farthest(
    robot: Robot, shapes: Any, between: list[tuple[int, int]]
) -> dict[tuple[int, int], float]:
    """Return how far apart, at most, two links get in random configurations."""
    geometry, data = pin.GeometryData(shapes), robot.model.createData()
    farthest = dict.fromkeys(between, -np.inf)
    for q in np.random.default_rng(0).uniform(*robot.finite_limits, (CONFIGURATIONS, robot.n)):
        pin.computeDistances(robot.model, data, shapes, geometry, q)
        now = dict.fromkeys(between, np.inf)
        for ends, result in zip(between, geometry.distanceResults, strict=True):
            now[ends] = min(now[ends], result.min_distance)
        farthest = {ends: max(farthest[ends], now[ends]) for ends in farthest}
    return farthest


def _level_links(robot: Robot) -> int:
    """Return how many joints from the base on turn about the vertical."""
    data, n = robot.model.createData(), robot.n
    columns = np.reshape(pin.computeJointJacobians(robot.model, data, np.zeros(n)), (6, n))
    vertical = (np.abs(columns[3:5]).max(axis=0) < 1e-9) & (np.abs(columns[5]) > 0.5)
    return n if vertical.all() else int(np.argmin(vertical))
