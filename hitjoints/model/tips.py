"""Where an arm ends: the tip that is meant when none is named."""

from __future__ import annotations

import re
from collections.abc import Collection
from dataclasses import dataclass
from typing import TYPE_CHECKING

from hitjoints.errors import ModelError

if TYPE_CHECKING:
    from hitjoints.model.tree import Connection, Tree

# Links that mark the end of an arm, alone or after a prefix, the surest first.
END_NAMES = (
    "flange", "tool0", "ee_link", "link_eef", "link8", "link_ee", "end_effector",
    "end_effector_link", "tool_link", "tool_frame", "tcp", "tip",
)  # fmt: skip
END = [re.compile(rf"(.*[_\-./])?{name}", re.IGNORECASE) for name in END_NAMES]
FINGER_WORDS = r"finger|thumb|jaw|claw|knuckle|pinky|hand[_\-.](index|middle|ring|little)"
FINGER_LINK = re.compile(FINGER_WORDS, re.IGNORECASE)
FINGER_JOINT = re.compile(rf"{FINGER_WORDS}|grip", re.IGNORECASE)
MOST_LISTED = 12


def end_rank(link: str) -> int | None:
    """Return how surely a name marks the end of an arm, 0 the surest; None if it does not."""
    if FINGER_LINK.search(link):
        return None
    return next((rank for rank, pattern in enumerate(END) if pattern.fullmatch(link)), None)


@dataclass(frozen=True)
class Branch:
    """A way from the base to an end of the tree: the joints that move along it, and its tip."""

    joints: tuple[str, ...]
    tip: str


def find_tip(tree: Tree, held: Collection[str], source: str) -> str:
    """Return the link at the end of the one arm that a description holds.

    One chain is the arm, without a finger or jaw at its end; else the one chain whose end has a
    usual name; else the one that is left without fingers. Joints that mimic others do not count.

    Args:
        tree: the description.
        held: names of joints that are locked.
        source: what to call it in messages.

    Raises:
        ModelError: nothing moves, or there are several arms; the message lists their tips.
    """
    free = [j for j in tree.joints.values() if j.moves and not j.mimic and j.name not in held]
    if not free:
        raise ModelError(source, "it has no moving joint")
    all_ends = branches(tree, free)
    named = _named(tree, free, all_ends)
    if len(named) == 1 and (len(all_ends) > 1 or _is_jaw(named[0], all_ends[0])):
        return named[0].tip
    if len(all_ends) == 1:
        *others, last = (tree.joints[name] for name in all_ends[0].joints)
        jaw = is_finger(last) and others and not any(map(is_finger, others))
        return branches(tree, others if jaw else free)[0].tip
    without = _without_fingers(tree, free)
    ends = branches(tree, without)
    if len(ends) == 1:
        return ends[0].tip
    raise ModelError(source, _listed(named, ends))


def is_finger(joint: Connection) -> bool:
    """Tell whether a joint is named as one of a gripper."""
    return bool(FINGER_JOINT.search(joint.name) or FINGER_LINK.search(joint.child))


def branches(tree: Tree, free: Collection[Connection]) -> list[Branch]:
    """Return the ways from the base that no other goes on from, each with the best of its tips.

    Args:
        tree: the description.
        free: the joints that count as moving.
    """
    moving = {joint.name for joint in free}
    child = {joint.name: joint.child for joint in free}
    ways = {link: _way(tree, link, moving) for link in tree.bodies}
    longer = {way[:end] for way in ways.values() for end in range(len(way))}
    found = []
    for way in dict.fromkeys(ways.values()):
        if way and way not in longer:
            there = [link for link, its in ways.items() if its == way]
            named = [link for link in there if end_rank(link) is not None]
            tip = min(named, key=lambda link: end_rank(link) or 0, default=child[way[-1]])
            found.append(Branch(way, tip))
    return found


def _way(tree: Tree, link: str, moving: Collection[str]) -> tuple[str, ...]:
    return tuple(joint.name for joint in tree.above(link) if joint.name in moving)


def _is_jaw(named: Branch, whole: Branch) -> bool:
    return len(whole.joints) == len(named.joints) + 1


def _named(tree: Tree, free: list[Connection], ends: list[Branch]) -> list[Branch]:
    """Return the ways to links with the name of an end, except those that go on as an arm does."""
    moving = {joint.name for joint in free}
    best: dict[tuple[str, ...], str] = {}
    links = [link for link in tree.bodies if end_rank(link) is not None]
    for link in sorted(links, key=lambda link: end_rank(link) or 0):
        best.setdefault(_way(tree, link, moving), link)
    found = []
    for way, link in best.items():
        if not way or any(len(other) > len(way) and other[: len(way)] == way for other in best):
            continue
        beyond = [len(end.joints) - len(way) for end in ends if end.joints[: len(way)] == way]
        # Several ways on are a hand, one more joint is a jaw; a longer way is the arm itself.
        if len(beyond) > 1 or beyond[0] <= 1:
            found.append(Branch(way, link))
    return found


def _without_fingers(tree: Tree, free: list[Connection]) -> list[Connection]:
    """Return the joints without those of fingers, from the ends towards the base."""
    left = list(free)
    while True:
        last = {end.joints[-1] for end in branches(tree, left)}
        kept = [joint for joint in left if not (joint.name in last and is_finger(joint))]
        if len(kept) == len(left) or not kept:
            return left
        left = kept


def _listed(named: list[Branch], ends: list[Branch]) -> str:
    """List the ends, those with a usual name first and without what hangs on them."""
    ways = [end.joints for end in named]
    others = [end for end in ends if not any(end.joints[: len(way)] == way for way in ways)]
    listed = [*named, *sorted(others, key=lambda end: -len(end.joints))]
    choices = {end.tip: len(end.joints) for end in listed}
    first = list(choices)
    words = [f"--tip {tip} ({_counted(choices[tip])})" for tip in first[:MOST_LISTED]]
    more = f", or one of {len(first) - MOST_LISTED} more" if len(first) > MOST_LISTED else ""
    choose = f'choose one with {", ".join(words)}{more} (in Python tip="{first[0]}")'
    return f"it ends in {len(first)} places: {choose}"


def _counted(joints: int) -> str:
    return "1 joint" if joints == 1 else f"{joints} joints"


def tips(tree: Tree) -> list[str]:
    """Return the links that an arm may end with: the ends with and without fingers."""
    free = [joint for joint in tree.joints.values() if joint.moves and not joint.mimic]
    ends = branches(tree, free)
    whole = [*_named(tree, free, ends), *branches(tree, _without_fingers(tree, free)), *ends]
    return list(dict.fromkeys(end.tip for end in whole))
