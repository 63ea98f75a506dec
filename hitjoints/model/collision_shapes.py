"""Read a description's collision shapes, and build what Pinocchio and Coal need of them.

urdfdom leaves out a shape it cannot read, with a line on its own error stream, and takes negative
lengths as they are. Here every shape that is written is built, or is a fault with its reason.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal
from xml.etree import ElementTree

import numpy as np

from hitjoints.errors import shown
from hitjoints.model.meshes import FARTHEST, MeshError, find_mesh, read_mesh

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element

LENGTHS = {
    "box": ("size", 3),
    "sphere": ("radius", 1),
    "cylinder": ("radius length", 2),
    "capsule": ("radius length", 2),
}
"""The attributes of each solid and how many lengths they hold. A capsule's length is that of its
cylinder: its caps come on top."""


@dataclass(frozen=True)
class Shape:
    """A collision shape as it is written.

    Attributes:
        link: that carries it.
        name: link and number, as Pinocchio names shapes.
        kind: box, sphere, cylinder, capsule or mesh.
        numbers: m, the solid's lengths; of a mesh, its three scales.
        xyz: m, rad, its placement in the link.
        rpy: m, rad, its placement in the link.
        mesh: the name of the mesh's file, as written.
    """

    link: str
    name: str
    kind: str
    numbers: tuple[float, ...]
    xyz: tuple[float, ...]
    rpy: tuple[float, ...]
    mesh: str = ""


class ShapeError(Exception):
    """A shape that is written cannot be read; the text says why."""


def read_shapes(
    xml: str, kind: Literal["collision", "visual"] = "collision"
) -> tuple[list[Shape], list[tuple[str, str]]]:
    """Return the shapes of a URDF, and what cannot be read: links and reasons.

    Args:
        xml: the URDF.
        kind: those that are checked for clearance, or what the arm looks like.
    """
    shapes, faults = [], []
    for link in ElementTree.fromstring(xml).findall("link"):
        name = link.get("name", "")
        for number, element in enumerate(link.findall(kind)):
            try:
                shapes.append(_read(element, name, f"{name}_{number}"))
            except ShapeError as error:
                faults.append((name, str(error)))
    return shapes, faults


def _read(element: Element, link: str, name: str) -> Shape:
    origin, geometry = element.find("origin"), element.find("geometry")
    xyz, rpy = (
        (0.0, 0.0, 0.0) if origin is None else _numbers(origin, key, 3, "0 0 0")
        for key in ("xyz", "rpy")
    )
    solids = [] if geometry is None else list(geometry)
    if len(solids) != 1:
        raise ShapeError(f"a <{element.tag}> needs one solid in its <geometry>, not {len(solids)}")
    solid, kind = solids[0], solids[0].tag
    if kind == "mesh":
        scale = _numbers(solid, "scale", 3, "1 1 1")
        if 0 in scale:
            raise ShapeError(f"mesh scale = {solid.get('scale')!r} flattens it")
        if not solid.get("filename"):
            raise ShapeError("a <mesh> has no filename")
        return Shape(link, name, kind, scale, xyz, rpy, solid.get("filename", ""))
    if kind not in LENGTHS:
        raise ShapeError(f"<{kind}> is none of {', '.join(LENGTHS)}, mesh")
    keys, count = LENGTHS[kind]
    each = count // len(keys.split())
    lengths = tuple(v for key in keys.split() for v in _numbers(solid, key, each))
    if min(lengths) <= 0:
        raise ShapeError(f"{kind} {keys} = {_brief(lengths)} must be above zero")
    return Shape(link, name, kind, lengths, xyz, rpy)


def _numbers(
    element: Element, key: str, count: int, default: str | None = None
) -> tuple[float, ...]:
    text = element.get(key, default)
    if text is None:
        raise ShapeError(f"{element.tag} has no {key}")
    try:
        values = tuple(float(word) for word in text.split())
    except ValueError:
        values = ()
    if len(values) != count or not all(map(math.isfinite, values)):
        wanted = "one finite number" if count == 1 else f"{count} finite numbers"
        raise ShapeError(f"{element.tag} {key} = {shown(text, repr)} is not {wanted}")
    if max(map(abs, values)) > FARTHEST:
        raise ShapeError(f"{element.tag} {key} = {shown(text, repr)} is larger than any arm")
    return values


def _brief(values: Sequence[float]) -> str:
    return " ".join(f"{v:g}" for v in values)


def build_shapes(
    model: Any, shapes: Sequence[Shape], folder: str, package_dirs: Sequence[str] = ()
) -> tuple[Any, list[tuple[str, str]]]:
    """Return Pinocchio's geometry of the shapes, and what cannot be read: links and reasons.

    Args:
        model: pin.Model that has the links as frames.
        shapes: from `read_shapes`.
        folder: where the description is, for its meshes.
        package_dirs: see `find_mesh`.
    """
    import pinocchio as pin

    geometry, faults = pin.GeometryModel(), []
    meshes: dict[tuple[str, tuple[float, ...]], Any] = {}
    for shape in shapes:
        try:
            solid = _solid(shape, folder, package_dirs, meshes)
        except MeshError as error:
            faults.append((shape.link, str(error)))
            continue
        frame = model.getFrameId(shape.link, pin.FrameType.BODY)
        at = pin.SE3(pin.rpy.rpyToMatrix(*shape.rpy), np.array(shape.xyz))
        carrier = model.frames[frame]
        placement = carrier.placement * at
        geometry.addGeometryObject(
            pin.GeometryObject(shape.name, carrier.parentJoint, frame, placement, solid)
        )
    return geometry, faults


def _solid(
    shape: Shape,
    folder: str,
    package_dirs: Sequence[str],
    meshes: dict[tuple[str, tuple[float, ...]], Any],
) -> Any:
    import coal

    if shape.kind == "mesh":
        key = shape.mesh, shape.numbers
        if key not in meshes:
            meshes[key] = read_mesh(find_mesh(shape.mesh, folder, package_dirs), shape.numbers)
        return meshes[key]
    solids = {
        "box": coal.Box, "sphere": coal.Sphere, "cylinder": coal.Cylinder, "capsule": coal.Capsule,
    }  # fmt: skip
    return solids[shape.kind](*shape.numbers)


def mesh_digest(xml: str, folder: str, package_dirs: Sequence[str] = ()) -> str:
    """Return a hash of the mesh files that a URDF's collision shapes name, "" for none.

    A file that cannot be read counts as the reason.
    """
    if "<mesh" not in xml:
        return ""
    names = sorted({shape.mesh for shape in read_shapes(xml)[0] if shape.mesh})
    digest = hashlib.sha256()
    for name in names:
        try:
            content = find_mesh(name, folder, package_dirs).read_bytes()
        except (MeshError, OSError) as error:
            content = str(error).encode()
        digest.update(hashlib.sha256(content).digest())
    return digest.hexdigest()[:16] if names else ""
