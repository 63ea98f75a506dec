"""Write a tree of links and joints as the URDF that Pinocchio, MuJoCo and the viewer get."""

from __future__ import annotations

from typing import TYPE_CHECKING
from xml.etree import ElementTree
from xml.etree.ElementTree import SubElement

from hitjoints.model.numbers import written

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element

    from hitjoints.model.tree import Body, Connection, Tree

# urdfdom accepts no infinite limit, so a continuous joint passes through it with this range (rad).
UNBOUNDED = 1e9
MOMENTS = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")


def urdf_text(tree: Tree, *, shapes: bool = True) -> str:
    """Write a URDF: every number as it was read, every limit there, continuous joints revolute.

    Args:
        tree: the description.
        shapes: with what it looks like; dynamics need none, and urdfdom complains of it aloud.
    """
    root = ElementTree.Element("robot", name=tree.name)
    if shapes:
        root.extend(tree.materials)
    for body in tree.bodies.values():
        link = _write_body(root, body)
        if shapes:
            link.extend(body.shapes)
    for joint in tree.joints.values():
        _write_joint(root, joint)
    return ElementTree.tostring(root, encoding="unicode")


def _write_body(root: Element, body: Body) -> Element:
    link = SubElement(root, "link", name=body.name)
    if body.has_inertial:
        inertial = SubElement(link, "inertial")
        SubElement(inertial, "origin", xyz=written(body.com), rpy=written(body.rpy))
        SubElement(inertial, "mass", value=repr(body.mass))
        values = map(repr, body.moments.tolist())
        SubElement(inertial, "inertia", dict(zip(MOMENTS, values, strict=True)))
    return link


def _write_joint(root: Element, joint: Connection) -> None:
    kind = "revolute" if joint.kind == "continuous" else joint.kind
    element = SubElement(root, "joint", name=joint.name, type=kind)
    SubElement(element, "parent", link=joint.parent)
    SubElement(element, "child", link=joint.child)
    SubElement(element, "origin", xyz=written(joint.xyz), rpy=written(joint.rpy))
    if not joint.moves:
        return
    bounded = joint.kind != "continuous"
    low, high = (joint.lower, joint.upper) if bounded else (-UNBOUNDED, UNBOUNDED)
    SubElement(element, "axis", xyz=written(joint.axis))
    limits = {"lower": low, "upper": high, "velocity": joint.velocity, "effort": joint.effort}
    SubElement(element, "limit", {side: repr(value) for side, value in limits.items()})
