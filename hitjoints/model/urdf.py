"""Read a URDF and reduce it to what hitjoints accepts: a fixed base and one serial chain.

Pinocchio and urdfdom accept far more than a serial arm, and say little about what they refuse. So
the XML is read here first, every refusal names the joint and the reason, and what Pinocchio gets
is a description that it is known to accept.
"""

from __future__ import annotations

import math
import os
import stat
from collections import Counter
from collections.abc import Collection
from dataclasses import dataclass, field
from typing import TYPE_CHECKING
from xml.etree import ElementTree

import numpy as np

from hitjoints.errors import InputError, ModelError, UnknownNameError

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element

    from numpy.typing import NDArray

MOVING = ("revolute", "continuous", "prismatic")
UNSUPPORTED = {
    "floating": "its base floats; hitjoints needs a base fixed to the world",
    "planar": "planar joints are not supported, only revolute, continuous and prismatic ones",
}
# urdfdom accepts no infinite limit, so a continuous joint passes through it with this range (rad).
UNBOUNDED = 1e9
MOST_JOINTS = 16  # what the kernels take
LARGEST = 1 << 26  # bytes of a description


@dataclass(frozen=True)
class Link:
    """What a link's XML says of its inertia and size."""

    name: str
    mass: float
    com: NDArray[np.float64]
    """(3,) m, in the link frame."""
    inertia: NDArray[np.float64]
    """(3, 3) kg m^2, about the centre of mass, along the link frame's axes."""
    moving: bool
    """The link is the child of a moving joint (not fixed to one)."""
    size: float
    """Distance from the link's origin to its farthest child joint or its mass centre, m."""


@dataclass(frozen=True)
class Arm:
    """A URDF known to be a fixed-base serial chain."""

    xml: str
    """The description with locked joints fixed, continuous joints made revolute, and limits that
    are not written given as zero."""
    joints: tuple[str, ...]
    continuous: frozenset[str]
    links: tuple[Link, ...] = field(repr=False)


def read_arm(text: str, source: str, lock: Collection[str] = ()) -> Arm:
    """Read a URDF text.

    Args:
        text: the URDF.
        source: what to call it in messages.
        lock: names of joints to hold at zero.

    Raises:
        ModelError: the text is no URDF, or no fixed-base serial chain of revolute, continuous and
            prismatic joints; the message names the joint and the reason.
    """
    try:
        return _read(text, source, lock)
    except RecursionError:
        raise ModelError(source, "not a URDF: its elements are nested too deeply") from None


def _read(text: str, source: str, lock: Collection[str]) -> Arm:
    root = _parse(text, source)
    joints = {j.get("name", ""): j for j in root.findall("joint")}
    for name in lock:
        if name not in joints:
            moving = [n for n, joint in joints.items() if joint.get("type") != "fixed"]
            raise UnknownNameError("lock", name, moving)
        joints[name].set("type", "fixed")
    _check_tree(root, joints, source)
    order = _serial_order(joints, source)
    continuous = frozenset(name for name in order if joints[name].get("type") == "continuous")
    for name in order:
        _check_joint(joints[name], source)
    links = tuple(_read_link(link, joints, source) for link in root.findall("link"))
    for name in order:
        _complete_limit(joints[name])
    return Arm(ElementTree.tostring(root, encoding="unicode"), tuple(order), continuous, links)


def _parse(text: str, source: str) -> Element:
    try:
        root = ElementTree.fromstring(text)
    except ElementTree.ParseError as error:
        raise ModelError(source, f"not well-formed XML ({error})") from None
    if root.tag != "robot":
        raise ModelError(source, f"not a URDF: the root element is <{root.tag}>, not <robot>")
    for tag in ("link", "joint"):
        names = [element.get("name") for element in root.findall(tag)]
        if not all(names):
            raise ModelError(source, f"a <{tag}> has no name")
        twice = [name for name, count in Counter(names).items() if count > 1]
        if twice:
            raise ModelError(source, f"two <{tag}> elements are called {twice[0]}")
    return root


def end(joint: Element, side: str) -> str:
    """Return the name of a joint's "parent" or "child" link ("" when the XML names none)."""
    element = joint.find(side)
    return "" if element is None else element.get("link", "")


def _check_tree(root: Element, joints: dict[str, Element], source: str) -> None:
    links = {link.get("name", "") for link in root.findall("link")}
    children: set[str] = set()
    below: dict[str, list[str]] = {}
    for name, joint in joints.items():
        _check_origin(joint, source)
        for side in ("parent", "child"):
            if end(joint, side) not in links:
                raise ModelError(
                    source, f"joint {name}: its {side} link {end(joint, side)!r} does not exist"
                )
        if end(joint, "child") in children:
            raise ModelError(source, f"link {end(joint, 'child')} is the child of two joints")
        children.add(end(joint, "child"))
        below.setdefault(end(joint, "parent"), []).append(end(joint, "child"))
    roots = sorted(links - children)
    if len(roots) != 1:
        raise ModelError(source, f"there must be one root link, not {len(roots)} {roots}")
    reached = roots.copy()
    for link in reached:
        reached += below.get(link, [])
    if loose := sorted(links.difference(reached)):
        raise ModelError(source, f"links {loose} hang in a loop, not on the root link {roots[0]}")


def _check_origin(joint: Element, source: str) -> None:
    for key in ("xyz", "rpy"):
        _vector(joint.find("origin"), key, f"joint {joint.get('name')}: origin", source)


def _serial_order(joints: dict[str, Element], source: str) -> list[str]:
    """Return the moving joints from base to tip, or refuse a branch."""
    parent_joint = {end(joint, "child"): name for name, joint in joints.items()}

    def mover(link: str) -> str | None:
        """Return the nearest moving joint at or above a link."""
        while (name := parent_joint.get(link)) is not None:
            if joints[name].get("type") != "fixed":
                return name
            link = end(joints[name], "parent")
        return None

    follower: dict[str | None, str] = {}
    for name, joint in joints.items():
        if joint.get("type") == "fixed":
            continue
        before = mover(end(joint, "parent"))
        if before in follower:
            where = f"after joint {before}" if before else "at the base"
            raise ModelError(
                source,
                f"not one serial chain: joints {follower[before]} and {name} both come {where} "
                "(lock one of them to hold it at zero)",
            )
        follower[before] = name
    order: list[str] = []
    at: str | None = None
    while (at := follower.get(at)) is not None:
        order.append(at)
    if not order:
        raise ModelError(source, "it has no moving joint")
    if len(order) > MOST_JOINTS:
        raise ModelError(source, f"it has {len(order)} joints, an arm at most {MOST_JOINTS}")
    return order


def _check_joint(joint: Element, source: str) -> None:
    name, kind = joint.get("name"), joint.get("type", "")
    if kind not in MOVING:
        reason = UNSUPPORTED.get(kind, f"its type {kind!r} is none of {', '.join(MOVING)}, fixed")
        raise ModelError(source, f"joint {name}: {reason}")
    if joint.find("mimic") is not None:
        raise ModelError(source, f"joint {name} mimics another joint; lock it to hold it at zero")
    axis = _vector(joint.find("axis"), "xyz", f"joint {name}: axis", source, "1 0 0")
    if not np.linalg.norm(axis) > 0:
        raise ModelError(source, f"joint {name}: its axis is zero")
    limit = joint.find("limit")
    where = f"joint {name}: limit"
    for side in ("velocity", "effort"):
        value = _number(limit, side, where, source)
        if value < 0:
            raise ModelError(source, f"joint {name}: its {side} limit {value:g} is negative")
    if kind == "continuous":
        return
    if limit is None:
        raise ModelError(source, f"joint {name}: it has no <limit>, which a {kind} joint needs")
    lower, upper = (_number(limit, side, where, source) for side in ("lower", "upper"))
    if lower > upper:
        raise ModelError(source, f"joint {name}: lower limit {lower:g} is above upper {upper:g}")


def _complete_limit(joint: Element) -> None:
    """Write what urdfdom insists on: a range, a velocity and an effort."""
    limit = joint.find("limit")
    if limit is None:
        limit = ElementTree.SubElement(joint, "limit")
    for side in ("velocity", "effort"):
        limit.set(side, limit.get(side, "0"))
    if joint.get("type") == "continuous":
        joint.set("type", "revolute")
        limit.set("lower", repr(-UNBOUNDED))
        limit.set("upper", repr(UNBOUNDED))


def _read_link(link: Element, joints: dict[str, Element], source: str) -> Link:
    name = link.get("name", "")
    above = [joint for joint in joints.values() if end(joint, "child") == name]
    moving = bool(above) and above[0].get("type") != "fixed"
    below = [joint.find("origin") for joint in joints.values() if end(joint, "parent") == name]
    reach = [np.linalg.norm(_vector(o, "xyz", f"link {name}", source)) for o in below]
    inertial = link.find("inertial")
    if inertial is None:
        zero = np.zeros(3)
        return Link(name, 0.0, zero, np.zeros((3, 3)), moving, float(max(reach, default=0.0)))
    where = f"link {name}: inertial"
    mass = _number(inertial.find("mass"), "value", f"{where} mass", source, required=True)
    origin = inertial.find("origin")
    com = _vector(origin, "xyz", f"{where} origin", source)
    turn = _rotation(_vector(origin, "rpy", f"{where} origin", source))
    tensor = inertial.find("inertia")
    xx, yy, zz, xy, xz, yz = (
        _number(tensor, key, f"{where} inertia", source, required=True)
        for key in ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
    )
    inertia = turn @ np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]) @ turn.T
    size = max([float(np.linalg.norm(com)), *map(float, reach)])
    return Link(name, mass, com, inertia, moving, size)


def _rotation(rpy: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the rotation matrix of roll, pitch and yaw about the fixed axes."""
    (cr, cp, cy), (sr, sp, sy) = np.cos(rpy), np.sin(rpy)
    roll = np.array([[1, 0, 0], [0, cr, -sr], [0, sr, cr]])
    pitch = np.array([[cp, 0, sp], [0, 1, 0], [-sp, 0, cp]])
    yaw = np.array([[cy, -sy, 0], [sy, cy, 0], [0, 0, 1]])
    return np.asarray(yaw @ pitch @ roll)


def _number(
    element: Element | None, key: str, where: str, source: str, *, required: bool = False
) -> float:
    text = None if element is None else element.get(key)
    if text is None and required:
        # urdfdom would drop the whole inertia of the link and go on.
        raise ModelError(source, f"{where} has no {key}")
    if text is None:
        return 0.0  # URDF's own default for a limit
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise ModelError(source, f"{where} {key} = {text!r} is not a finite number")
    return value


def _vector(
    element: Element | None, key: str, where: str, source: str, default: str = "0 0 0"
) -> NDArray[np.float64]:
    text = default if element is None else element.get(key, default)
    try:
        value = np.array([float(word) for word in text.split()])
    except ValueError:
        value = np.empty(0)
    if value.shape != (3,) or not np.isfinite(value).all():
        raise ModelError(source, f"{where} {key} = {text!r} is not three finite numbers")
    return value


def read_text(path: str) -> str:
    """Return a description file's text.

    Raises:
        InputError: the file cannot be read as text, is no plain file, or is larger than any
            description.
    """
    try:
        # A device or a pipe may never end.
        status = os.stat(path)
        if not (stat.S_ISREG(status.st_mode) or stat.S_ISDIR(status.st_mode)):
            raise InputError("robot", path, "a description is a file, not a device or a pipe")
        if status.st_size > LARGEST:
            raise InputError("robot", path, f"a description has at most {LARGEST >> 20} MB")
        with open(path, encoding="utf-8-sig") as file:
            return file.read()
    except UnicodeDecodeError:
        raise InputError("robot", path, "not a UTF-8 text file") from None
    except OSError as error:
        raise InputError("robot", path, str(error.strerror)) from None
    except InputError:
        raise
    except ValueError:
        raise InputError("robot", path, "a path holds no null character") from None
