"""Choose one serial chain of a description and hold everything else still."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from hitjoints.errors import InputError, ModelError, UnknownNameError
from hitjoints.model.limits import with_limits
from hitjoints.model.tips import find_tip, tips
from hitjoints.model.tool import weld
from hitjoints.model.tree import MOVING, roll_pitch_yaw, rotation, turn_about
from hitjoints.model.urdf import check_moving
from hitjoints.model.urdf_text import urdf_text

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from hitjoints.model.tool import Tool
    from hitjoints.model.tree import Body, Connection, Tree

MOST_JOINTS = 16  # what the kernels take


@dataclass(frozen=True)
class Link:
    """What a description says of a link's inertia and size."""

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
    """A description known to be a fixed-base serial chain."""

    xml: str
    """What Pinocchio gets: joints off the chain fixed, continuous joints made revolute."""
    tree: Tree = field(repr=False)
    """The same, as it was read."""
    joints: tuple[str, ...]
    continuous: frozenset[str]
    links: tuple[Link, ...] = field(repr=False)
    tip: str
    """The link that the chain leads to."""
    held: Mapping[str, float]
    """Positions (rad or m) of the joints off the chain, and of those that were locked."""
    tool: Tool | None = None
    """What `with_tool` welded to it; the tip is then that of the tool."""

    def riding(self) -> list[str]:
        """Return the links that the last joint carries."""
        return self.tree.below(self.tree.joints[self.joints[-1]].child)

    def with_tool(self, tool: Tool, flange: str) -> Arm:
        """Return the arm with a tool welded to one of its links, in that link's frame."""
        tree, tip = weld(self.tree, flange, tool)
        links = tuple(_sized(body, tree) for body in tree.bodies.values())
        return replace(self, xml=urdf_text(tree), tree=tree, links=links, tip=tip, tool=tool)


def choose_arm(
    tree: Tree,
    source: str,
    tip: str | None = None,
    base: str | None = None,
    lock: Mapping[str, float] | None = None,
    limits: Mapping[str, Any] | None = None,
) -> Arm:
    """Choose the chain from a base to a tip; all other joints are held.

    Args:
        tree: the description.
        source: what to call it in messages.
        tip: link (or joint, for its child) that the chain leads to; found when not given.
        base: link that the arm stands on, whose frame becomes the world's: the root by default.
        lock: positions (rad or m) of joints to hold. A joint off the chain that is not among them
            is held at zero, or at the limit nearest to it; one that mimics a held joint follows.
        limits: of the chain's joints, as `with_limits`.

    Raises:
        InputError: no such tip, base or joint, or a position outside the joint's limits.
        ModelError: the tip is not below the base, there are several arms to choose from, or the
            chain holds a joint that an arm cannot have.
    """
    locked = _checked_lock(tree, lock or {})
    if base is not None:
        base = _link(tree, "base", base, tree.bodies)
    if tip is not None:
        tip = _link(tree, "tip", tip, tips(tree))
    rooted = tree if base is None else tree.rooted(base)
    if tip is None:
        tip = find_tip(rooted, locked, source)
    elif tip not in rooted.bodies:
        raise ModelError(source, f"the tip {tip} does not hang on the base {base}")
    chain = [j for j in rooted.above(tip) if j.moves and j.name not in locked]
    if not chain:
        raise ModelError(source, f"it has no moving joint before the tip {tip}")
    if len(chain) > MOST_JOINTS:
        raise ModelError(source, f"it has {len(chain)} joints, an arm at most {MOST_JOINTS}")
    chain = with_limits(chain, limits or {}, source)
    for joint in chain:
        if joint.mimic:
            follows = f"joint {joint.name} on the way to the tip {tip} follows {joint.mimic}"
            raise ModelError(source, f"{follows}: choose a tip before it")
        check_moving(joint, source)
    free = {joint.name for joint in chain}
    held = {
        name: _held_at(rooted, joint, locked, free)
        for name, joint in rooted.joints.items()
        if joint.moves and name not in free
    }
    joints = {n: _fixed(j, held[n]) if n in held else j for n, j in rooted.joints.items()}
    joints |= {joint.name: joint for joint in chain}
    still = replace(rooted, joints=joints)
    return Arm(
        xml=urdf_text(still),
        tree=still,
        joints=tuple(joint.name for joint in chain),
        continuous=frozenset(joint.name for joint in chain if joint.kind == "continuous"),
        links=tuple(_sized(body, still) for body in still.bodies.values()),
        tip=tip,
        held=held,
    )


def _link(tree: Tree, argument: str, name: str, choices: object) -> str:
    if name in tree.bodies:
        return name
    if name in tree.joints:
        return tree.joints[name].child
    raise UnknownNameError(argument, name, choices)  # type: ignore[arg-type]


def _checked_lock(tree: Tree, lock: Mapping[str, float]) -> dict[str, float]:
    for name, value in lock.items():
        if name not in tree.joints:
            moving = [n for n, joint in tree.joints.items() if joint.moves]
            raise UnknownNameError("lock", name, moving)
        joint = tree.joints[name]
        if not math.isfinite(value) or (value and joint.clipped(value) != value):
            wanted = f"joint {name} moves from {joint.lower:g} to {joint.upper:g}"
            raise InputError("lock", f"{name}={value:g}", wanted)
    return dict(lock)


def _held_at(
    tree: Tree, joint: Connection, locked: Mapping[str, float], free: set[str], depth: int = 0
) -> float:
    if joint.name in locked:
        return locked[joint.name]
    leader = tree.joints.get(joint.mimic)
    if leader is None or leader.name in free or depth > MOST_JOINTS:
        return joint.clipped(0.0)
    lead = _held_at(tree, leader, locked, free, depth + 1) if leader.moves else 0.0
    return joint.mimic_factor * lead + joint.mimic_offset


def _fixed(joint: Connection, value: float) -> Connection:
    """Return a joint fixed at a position (rad or m)."""
    if value == 0 or joint.kind not in MOVING:
        return replace(joint, kind="fixed")
    turn = rotation(joint.rpy)
    if joint.kind == "prismatic":
        along = joint.axis / np.linalg.norm(joint.axis)
        return replace(joint, kind="fixed", xyz=joint.xyz + value * turn @ along)
    return replace(joint, kind="fixed", rpy=roll_pitch_yaw(turn @ turn_about(joint.axis, value)))


def _sized(body: Body, tree: Tree) -> Link:
    above = tree.above(body.name)[-1:]
    reach = [np.linalg.norm(j.xyz) for j in tree.joints.values() if j.parent == body.name]
    if body.has_inertial:
        reach.append(np.linalg.norm(body.com))
    moving = bool(above) and above[0].moves
    size = float(max(reach, default=0.0))
    return Link(body.name, body.mass, body.com, body.inertia, moving, size)
