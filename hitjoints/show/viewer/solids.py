"""What an arm looks like, as triangles: its visual shapes, or those of its clearance."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import pinocchio as pin

from hitjoints.dynamics.kinematics import position
from hitjoints.model.collision_shapes import build_shapes, read_shapes

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
    """Return the visual shapes of an arm, its collision shapes, or bars: the first that there are.

    Shapes of which one cannot be read are left for the next kind.
    """
    visual = _visual(robot)
    if visual is not None:
        return _solids(visual)
    if robot.shape_faults or not robot.collision_model.ngeoms:
        return _bars(robot)
    return _solids(robot.collision_model)


def why_bars(robot: Robot) -> tuple[str, str] | None:
    """Return which link's shape is why an arm is drawn with bars, and its fault, if that is so."""
    faults = robot.shape_faults
    return faults[0] if faults and _visual(robot) is None else None


def _visual(robot: Robot) -> Any:
    """Return Pinocchio's geometry of the visual shapes; None if there are none to be read."""
    shapes, faults = read_shapes(robot.xml, "visual")
    if faults or not shapes:
        return None
    folders = robot.package_directory, robot.package_dirs
    geometry, faults = build_shapes(robot.model, shapes, *folders)
    return None if faults else geometry


def _solids(geometry: Any) -> list[Solid]:
    return [
        Solid(str(one.name), int(one.parentJoint), one.placement, *_triangles(one))
        for one in geometry.geometryObjects
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
        return _welded(np.array(it.vertices(), dtype=np.float32), np.array(faces))
    return np.asarray(mesh.vertices), np.asarray(mesh.faces)


def _welded(vertices: Array, faces: NDArray[np.int64]) -> tuple[Array, NDArray[np.int64]]:
    """Return a mesh with each of its points once: an STL holds them once per triangle."""
    rows = np.ascontiguousarray(vertices).view(np.dtype((np.void, 3 * vertices.itemsize))).ravel()
    _, first, back = np.unique(rows, return_index=True, return_inverse=True)
    return vertices[first], back.ravel()[faces]


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
