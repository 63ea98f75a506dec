"""The collision shapes of an arm as flat faces, as it is checked for clearance."""

from __future__ import annotations

from functools import lru_cache
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from hitjoints.dynamics.kinematics import position
from hitjoints.errors import ModelError
from hitjoints.planning.room.shapes import scene_of

if TYPE_CHECKING:
    from hitjoints.model.robot import Contact, Robot
    from hitjoints.types import Array

BAR = 0.03
"""m, radius of the bars that are drawn for an arm without shapes."""
CORNERS = 20
"""Of a circle."""
BOX_FACES = ((0, 1, 3, 2), (4, 5, 7, 6), (0, 1, 5, 4), (2, 3, 7, 6), (0, 2, 6, 4), (1, 3, 7, 5))
"""Corners in the order of `itertools.product((-1, 1), repeat=3)`."""


def arm_faces(robot: Robot, q: Array) -> list[Array]:
    """Return the faces of an arm's shapes at q (n,) rad, each (k, 3) m; bars if it has none."""
    try:
        scene = scene_of(robot)
    except ModelError:
        return _bars(robot, q)
    scene.point(q, robot.flange)
    placed = zip(_shapes(robot), scene.geometry.oMg, strict=True)
    return [
        face @ where.rotation.T + where.translation for shape, where in placed for face in shape
    ]


def box_centre(
    robot: Robot, q: Array, contact: Contact, h: Array, size: Array, axes: Array
) -> Array:
    """Return the centre (3,) m of a box that is touched, its near face at the link's surface.

    Args:
        robot: the arm.
        q: (n,) rad.
        contact: what touches it.
        h: (3,) unit vector, the direction.
        size: (3,) m, edges.
        axes: (3, 3), of these edges as columns.
    """
    try:
        placed = scene_of(robot).place_box(q, contact, h, size, axes)[1]
    except ModelError:
        half = np.min(size / 2 / np.maximum(np.abs(h @ axes), np.finfo(float).tiny))
        return np.asarray(position(robot, q, contact) + (half + BAR) * h)
    return np.array(placed.getTranslation())


def box_faces(corners: Array) -> list[Array]:
    """Return the faces of a box with corners (8, 3) m, in the order of `product`."""
    return [corners[list(face)] for face in BOX_FACES]


@lru_cache(maxsize=16)
def _shapes(robot: Robot) -> list[list[Array]]:
    """Return the faces of every shape of the robot's scene, in the shape's frame."""
    return [_faces(solid) for solid in scene_of(robot).solids]


def _faces(solid: Any) -> list[Array]:
    kind = type(solid).__name__
    if kind == "Box":
        signs = np.array(np.meshgrid(*[(-1, 1)] * 3, indexing="ij")).reshape(3, -1).T
        return box_faces(signs * np.array(solid.halfSide))
    if kind == "Cylinder":
        return _turned(solid.radius * np.ones(2), solid.halfLength * np.array([-1, 1]))
    if kind in ("Sphere", "Capsule"):
        half = solid.halfLength if kind == "Capsule" else 0.0
        turn = np.linspace(-np.pi / 2, np.pi / 2, CORNERS // 2)
        height = solid.radius * np.sin(turn) + half * np.where(turn < 0, -1, 1)
        return _turned(solid.radius * np.cos(turn), height)
    points, count = np.array(solid.points()), solid.num_polygons
    corners = [[solid.polygons(i)[k] for k in range(3)] for i in range(count)]
    return list(points[np.array(corners)])


def _turned(radius: Array, height: Array) -> list[Array]:
    """Return the faces of a body that is turned about z: its radii at heights, from below."""
    turn = np.linspace(0, 2 * np.pi, CORNERS, endpoint=False)
    circle = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    rings = [
        np.column_stack([r * circle, np.full(CORNERS, z)])
        for r, z in zip(radius, height, strict=True)
    ]
    after = np.roll(np.arange(CORNERS), -1)
    sides = [
        np.stack([low[i], low[after[i]], high[after[i]], high[i]])
        for low, high in pairwise(rings)
        for i in range(CORNERS)
    ]
    return [rings[0], *sides, rings[-1]]


def _bars(robot: Robot, q: Array) -> list[Array]:
    """Return a bar from each joint to the next."""
    joints = [position(robot, q, k) for k in range(1, robot.n + 1)]
    ends = [np.zeros(3), *joints, position(robot, q, robot.flange)]
    found = []
    for begin, end in pairwise(ends):
        length = float(np.linalg.norm(end - begin))
        if length > BAR:
            along = (end - begin) / length
            axes = np.linalg.svd(along[None, :])[2][[1, 2, 0]]
            axes[2] = along
            bar = _turned(BAR * np.ones(2), np.array([0.0, length]))
            found += [begin + face @ axes for face in bar]
    return found
