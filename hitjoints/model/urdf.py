"""Read a URDF text into a tree of links and joints.

Pinocchio and urdfdom say little about what they refuse or drop. So the XML is read here, every
refusal names the link or joint and the reason, and what Pinocchio gets is written anew from what
was read (`urdf_text`).
"""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING
from xml.etree.ElementTree import TreeBuilder
from xml.parsers import expat

import numpy as np

from hitjoints.errors import ModelError
from hitjoints.model.numbers import number, vector
from hitjoints.model.tree import MOVING, Body, Connection, Tree

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element

UNSUPPORTED = {
    "floating": "its base floats; hitjoints needs a base fixed to the world",
    "planar": "planar joints are not supported, only revolute, continuous and prismatic ones",
}
MOMENTS = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
WORLD = "world"  # may be a parent without being declared, as in Gazebo
LARGEST = 1e30  # kg or kg m^2: far above any link, far below what overflows
MOST_DEEP = 100  # elements within each other


def read_urdf(text: str, source: str) -> Tree:
    """Read a URDF text.

    Args:
        text: the URDF. Prefixes that no namespace is declared for, a robot without a name, blank
            lines before the XML declaration and an undeclared `world` are taken as they are meant.
        source: what to call it in messages.

    Raises:
        ModelError: the text is no URDF, holds xacro, or is no tree of links; or a number in it
            cannot be read; the message names the link or joint.
    """
    root = _parse(text, source)
    links, joints = root.findall("link"), root.findall("joint")
    for tag, elements in (("link", links), ("joint", joints)):
        names = [element.get("name") for element in elements]
        if not all(names):
            raise ModelError(source, f"a <{tag}> has no name")
        twice = [name for name, count in Counter(names).items() if count > 1]
        if twice:
            raise ModelError(source, f"two <{tag}> elements are called {twice[0]}")
    bodies = {body.name: body for body in (_body(link, source) for link in links)}
    read = {joint.name: joint for joint in (_joint(joint, source) for joint in joints)}
    if any(joint.parent == WORLD for joint in read.values()):
        bodies.setdefault(WORLD, Body(WORLD))
    top = _root(bodies, read, source)
    materials = tuple(root.findall("material"))
    return Tree(root.get("name") or "robot", top, bodies, read, materials)


def check_moving(joint: Connection, source: str) -> None:
    """Refuse a joint that an arm cannot have.

    Raises:
        ModelError: its type, axis or limits; the message says which.
    """
    name, kind = joint.name, joint.kind
    if kind not in MOVING:
        reason = UNSUPPORTED.get(kind, f"its type {kind!r} is none of {', '.join(MOVING)}, fixed")
        raise ModelError(source, f"joint {name}: {reason}")
    if not np.linalg.norm(joint.axis) > 0:
        raise ModelError(source, f"joint {name}: its axis is zero")
    for side in ("velocity", "effort"):
        value = getattr(joint, side)
        if value < 0:
            raise ModelError(source, f"joint {name}: its {side} limit {value:g} is negative")
    if kind == "continuous":
        return
    if not joint.has_limit:
        raise ModelError(source, f"joint {name}: it has no <limit>, which a {kind} joint needs")
    low, high = joint.lower, joint.upper
    if low > high:
        raise ModelError(source, f"joint {name}: lower limit {low:g} is above upper {high:g}")


def _parse(text: str, source: str) -> Element:
    """Parse the XML as urdfdom does: prefixes are part of the names, declared or not."""
    builder, parser = TreeBuilder(), expat.ParserCreate()
    parser.buffer_text = True
    depth = 0

    def start(tag: str, attributes: dict[str, str]) -> None:
        nonlocal depth
        depth += 1
        if depth > MOST_DEEP:
            raise ModelError(source, "not a URDF: its elements are nested too deeply")
        if tag.startswith("xacro:"):
            reason = f"it holds <{tag}>, which is xacro and not URDF: it must be expanded first"
            raise ModelError(source, reason)
        builder.start(tag, attributes)

    def end(tag: str) -> None:
        nonlocal depth
        depth -= 1
        builder.end(tag)

    parser.StartElementHandler, parser.EndElementHandler = start, end
    parser.CharacterDataHandler = builder.data
    try:
        parser.Parse(text.lstrip("\ufeff \t\r\n"), True)
    except (expat.ExpatError, UnicodeError) as error:
        raise ModelError(source, f"not well-formed XML ({error})") from None
    root = builder.close()
    if root.tag != "robot":
        raise ModelError(source, f"not a URDF: the root element is <{root.tag}>, not <robot>")
    return root


def _root(bodies: dict[str, Body], joints: dict[str, Connection], source: str) -> str:
    children: set[str] = set()
    for name, joint in joints.items():
        for side, link in (("parent", joint.parent), ("child", joint.child)):
            if link not in bodies:
                raise ModelError(source, f"joint {name}: its {side} link {link!r} does not exist")
        if joint.child in children:
            raise ModelError(source, f"link {joint.child} is the child of two joints")
        children.add(joint.child)
    roots = sorted(bodies.keys() - children)
    if len(roots) != 1:
        raise ModelError(source, f"there must be one root link, not {len(roots)} {roots}")
    reached = Tree("", roots[0], bodies, joints).below(roots[0])
    if loose := sorted(bodies.keys() - set(reached)):
        raise ModelError(source, f"links {loose} hang in a loop, not on the root link {roots[0]}")
    return roots[0]


def _joint(joint: Element, source: str) -> Connection:
    name, kind = joint.get("name", ""), joint.get("type", "")
    where, origin, limit = f"joint {name}", joint.find("origin"), joint.find("limit")
    lower, upper, velocity, effort = (
        number(limit, side, f"{where}: limit", source)
        for side in ("lower", "upper", "velocity", "effort")
    )
    mimic = joint.find("mimic")
    ends = [joint.find(side) for side in ("parent", "child")]
    parent, child = ("" if end is None else end.get("link", "") for end in ends)
    return Connection(
        name,
        kind,
        parent,
        child,
        vector(origin, "xyz", f"{where}: origin", source),
        vector(origin, "rpy", f"{where}: origin", source),
        vector(joint.find("axis"), "xyz", f"{where}: axis", source, "1 0 0"),
        lower,
        upper,
        velocity,
        effort,
        limit is not None,
        "" if mimic is None else mimic.get("joint", "?"),
        number(mimic, "multiplier", f"{where}: mimic", source, default=1.0),
        number(mimic, "offset", f"{where}: mimic", source),
    )


def _body(link: Element, source: str) -> Body:
    name, inertial = link.get("name", ""), link.find("inertial")
    shapes = tuple(shape for shape in link if shape.tag in ("visual", "collision"))
    if inertial is None:
        return Body(name, shapes=shapes)
    where, origin = f"link {name}: inertial", inertial.find("origin")
    mass = number(inertial.find("mass"), "value", f"{where} mass", source, default=None)
    com = vector(origin, "xyz", f"{where} origin", source)
    rpy = vector(origin, "rpy", f"{where} origin", source)
    tensor = inertial.find("inertia")
    moments = [number(tensor, key, f"{where} inertia", source, default=None) for key in MOMENTS]
    if max(mass, *map(abs, moments)) > LARGEST:
        raise ModelError(
            source, f"{where} holds {max(mass, *map(abs, moments)):.3g}: no link is so heavy"
        )
    return Body(name, mass, com, rpy, np.array(moments), True, shapes)
