"""Collision shapes as triangles, to draw an arm as it is checked for clearance."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import pinocchio as pin

from hitjoints.dynamics.kinematics import position

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from hitjoints.model.robot import Robot
    from hitjoints.types import Array

THICKNESS = 0.03  # m, radius of the bars drawn for an arm without shapes
SECTIONS = 32


class Solid(NamedTuple):
    """Triangles carried by a joint.

    Attributes:
        name: of the shape.
        joint: 0 for the base.
        placement: pin.SE3 in the joint's frame.
        vertices: (V, 3) m.
        faces: (F, 3), indices of vertices.
    """

    name: str
    joint: int
    placement: Any
    vertices: Array
    faces: NDArray[np.int64]


def solids(robot: Robot) -> list[Solid]:
    """Return the collision shapes of an arm, or a bar per link if it has none that can be read."""
    if robot.shape_faults or not robot.collision_model.ngeoms:
        return _bars(robot)
    objects = robot.collision_model.geometryObjects
    return [
        Solid(str(one.name), int(one.parentJoint), one.placement, *_triangles(one))
        for one in objects
    ]


def _triangles(shape: Any) -> tuple[Array, NDArray[np.int64]]:
    import trimesh

    kind, it = type(shape.geometry).__name__, shape.geometry
    if kind == "Sphere":
        mesh = trimesh.creation.icosphere(radius=it.radius)
    elif kind == "Box":
        mesh = trimesh.creation.box(2 * it.halfSide)
    elif kind == "Cylinder":
        mesh = trimesh.creation.cylinder(it.radius, 2 * it.halfLength, sections=SECTIONS)
    elif kind == "Capsule":
        mesh = trimesh.creation.capsule(2 * it.halfLength, it.radius, count=[SECTIONS, SECTIONS])
        mesh.apply_translation([0, 0, -mesh.bounds.mean(axis=0)[2]])
    else:
        faces = [[int(it.tri_indices(i)[k]) for k in range(3)] for i in range(it.num_tris)]
        return np.array(it.vertices()), np.array(faces)
    return np.asarray(mesh.vertices), np.asarray(mesh.faces)


def _bars(robot: Robot) -> list[Solid]:
    """Return a bar from each joint to the next, in the frame of the first."""
    import trimesh

    q = pin.neutral(robot.model)
    ends = [position(robot, q, k) for k in range(1, robot.n + 1)]
    ends = [np.zeros(3), *ends, position(robot, q, robot.flange)]
    frames = [pin.SE3.Identity(), *(robot.data.oMi[k].copy() for k in range(1, robot.n + 1))]
    bars = []
    for joint, frame in enumerate(frames):
        segment = np.array([frame.actInv(ends[joint]), frame.actInv(ends[joint + 1])])
        if np.linalg.norm(segment[1] - segment[0]) > THICKNESS:
            bar = trimesh.creation.cylinder(THICKNESS, segment=segment, sections=SECTIONS)
            at = pin.SE3.Identity()
            bars.append(
                Solid(f"link_{joint}", joint, at, np.asarray(bar.vertices), np.asarray(bar.faces))
            )
    return bars
