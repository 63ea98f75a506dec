"""Find the mesh files a description names, read them, and wrap them in convex hulls.

Coal reads a mesh as it comes and then ends the process on one that has no volume. So every vertex
is looked at here first: what is not a number is refused, and a flat mesh gets a thickness.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from hitjoints.model.packages import packages

if TYPE_CHECKING:
    from hitjoints.types import Array

FLAT = 1e-4
"""A mesh thinner than this share of its length gets that thickness (Coal fails below 1e-7)."""
FARTHEST = 1e5
"""m: a vertex beyond is a mistake."""
SMALLEST = 1e-6
"""m, and share of its distance from its origin: a mesh shorter than that is a dot."""
HULLS = ("Qt", "QJ")
"""Of qhull: exact, but a large round face becomes a fan about one corner, which Coal may refuse;
else with the points moved by some 1e-10 of the size, which no fan survives."""
PACKAGE = ("package://", "model://")


class MeshError(Exception):
    """A mesh cannot be used; the text says which and why."""


def find_mesh(name: str, folder: str, package_dirs: Sequence[str] = ()) -> Path:
    """Return the file that a description's mesh name stands for.

    `package://NAME/rest` is looked for in all of `packages`.

    Args:
        name: as written in the description.
        folder: where the description is.
        package_dirs: folders that hold packages, or are one.

    Raises:
        MeshError: there is no such file.
    """
    scheme = next((one for one in PACKAGE if name.startswith(one)), None)
    if scheme is None:
        path = Path(folder, name.removeprefix("file://"))
        if _is_file(path):
            return path
        raise MeshError(f"mesh {name} not found: there is no file {path}")
    package, _, rest = name.removeprefix(scheme).partition("/")
    for root in packages(package, folder, package_dirs):
        if _is_file(root / rest):
            return root / rest
    raise MeshError(
        f"mesh {name} not found in a folder above the description, "
        "--package-dir, ROS_PACKAGE_PATH or AMENT_PREFIX_PATH"
    )


def _is_file(path: Path) -> bool:
    try:
        return path.is_file()
    except (OSError, ValueError):  # a name too long, or with a zero byte
        return False


def read_mesh(path: Path, scale: Sequence[float]) -> Any:
    """Return a mesh as Coal's triangles.

    Args:
        path: a file of a format Coal reads (STL, OBJ, DAE, PLY, OFF ...).
        scale: three factors; negative ones mirror.

    Raises:
        MeshError: it cannot be read, or its vertices span no surface.
    """
    import coal

    try:
        # Bounding boxes along the axes: fitting turned ones prints a line per bad vertex.
        mesh = coal.MeshLoader(coal.NODE_TYPE.BV_AABB).load(str(path), np.array(scale, float))
    except (ValueError, RuntimeError) as error:
        raise MeshError(f"mesh {path.name} cannot be read: {_reason(error)}") from None
    check_surface(mesh, path.name)
    return mesh


def check_surface(mesh: Any, name: str) -> None:
    """Refuse a mesh that has no hull.

    Args:
        mesh: Coal's triangles.
        name: what to call it in messages.

    Raises:
        MeshError: its vertices are no numbers, too far away, too near each other, or on a line.
    """
    points = vertices(mesh)
    if not np.isfinite(points).all():
        raise MeshError(f"mesh {name} has a vertex that is no finite number")
    if not len(points):
        raise MeshError(f"mesh {name} is no surface: it has no vertex")
    far, lengths = float(np.abs(points).max()), _extents(points)[0]
    if far > FARTHEST:
        raise MeshError(f"mesh {name} has a vertex {far:.3g} m away: is its scale right?")
    if lengths[0] < SMALLEST * max(1, far):
        raise MeshError(f"mesh {name} is {lengths[0]:.3g} m long: is its scale right?")
    if lengths[1] <= FLAT * lengths[0]:
        raise MeshError(f"mesh {name} is no surface: its points lie on one line")


def vertices(mesh: Any) -> Array:
    """Return the vertices of Coal's triangles, (V, 3) m."""
    return np.reshape(np.array(mesh.vertices(), dtype=float), (-1, 3))


def convex_hull(mesh: Any) -> Any:
    """Return the convex hull of a mesh that `read_mesh` accepted, as Coal's solid.

    A flat mesh is made as thick as FLAT times its length, half on each side: distances from it
    are too small by that half at most.

    Raises:
        MeshError: a corner of the hull has more neighbours than Coal can count (255).
    """
    import coal

    points = vertices(mesh)
    lengths, axes = _extents(points)
    if lengths[2] < FLAT * lengths[0]:
        half = FLAT * lengths[0] / 2 * axes[2]
        points = np.concatenate([points - half, points + half])
    cloud = coal.BVHModelOBBRSS()
    cloud.beginModel(0, len(points))
    cloud.addVertices(points)
    cloud.endModel()
    for option in HULLS:
        try:
            cloud.buildConvexHull(True, option)
            return cloud.convex
        except RuntimeError:
            continue
    raise MeshError("the convex hull of a mesh has a corner with more than 255 neighbours")


def _extents(points: Array) -> tuple[Array, Array]:
    """Return the lengths along the principal axes, greatest first, and the axes as rows."""
    centred = points - points.mean(axis=0)
    axes = np.linalg.eigh(centred.T @ centred)[1].T
    lengths = np.ptp(centred @ axes.T, axis=0)
    order = np.argsort(-lengths)
    return lengths[order], axes[order]


def _reason(error: Exception) -> str:
    """Return the one line of Coal's message that says what is wrong."""
    lines = [line.strip() for line in str(error).splitlines()]
    after = [i for i, line in enumerate(lines) if "Could not load resource" in line]
    rest = [line for line in lines[after[0] + 1 :] if line] if after else lines
    return (rest or ["no reason given"])[0].rstrip(".")
