"""Make a `Robot` of a name, a file or a text."""

from __future__ import annotations

import warnings
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from hitjoints.errors import InputError, ModelError, shown
from hitjoints.loading.check import check_arm
from hitjoints.loading.facts import (
    DRIVE_FACTS,
    LIMITS,
    Facts,
    drive_fact,
    per_joint,
    provenance,
    read_lock,
)
from hitjoints.loading.source import Description, describe
from hitjoints.loading.tool_file import Asked as AskedTool
from hitjoints.loading.tool_file import read_tool
from hitjoints.model.arm import Arm, choose_arm
from hitjoints.model.compare import compare_model
from hitjoints.model.robot import Contact, Robot
from hitjoints.model.tips import end_rank
from hitjoints.model.tool import Tool
from hitjoints.model.turns import middle
from hitjoints.model.urdf_text import urdf_text

Lock = str | Iterable[str] | Mapping[str, float] | None


class ModelWarning(UserWarning):
    """A robot description holds a number that spoils the inertias computed from it."""


def load_robot(
    source: str | Path,
    tip: str | None = None,
    base: str | None = None,
    lock: Lock = None,
    tool: AskedTool | None = None,
    package_dirs: Sequence[str | Path] = (),
    xacro_args: Mapping[str, str] | None = None,
) -> Robot:
    """Load an arm.

    Args:
        source: a name of `robot_names`; the name of a URDF in example-robot-data; the path of a
            URDF, or of a TOML laid out as those in hitjoints/robots (which adds to a URDF what it
            has no field for); or a URDF as text.
        tip: the link that the arm ends with. Joints off the way from the base to the tip are held,
            their links ride along. Not needed when the description holds one arm.
        base: the link that the arm stands on, whose frame becomes the world's; the root of the
            description when not given.
        lock: joints to hold: positions (rad or m) by name, or "NAME" (at zero) and "NAME=VALUE".
        tool: what is welded to the flange: a `Tool`, or a TOML with its mass, com, inertia and
            tip. Its tip becomes the end of the arm, and what hits when no joint is named.
        package_dirs: folders that hold the packages of `package://` addresses.
        xacro_args: arguments of a xacro file, by name.

    Returns:
        The robot. Continuous joints have infinite position limits.

    Raises:
        InputError: there is no such robot, file, tip, base or joint.
        ModelError: the file is not a fixed-base serial arm; the message says why.

    Warns:
        ModelWarning: an inertia is physically impossible or out of proportion; the text says what
            that does to the directional inertia.
    """
    _, arm, robot = read_robot(source, tip, base, lock, tool, package_dirs, xacro_args)
    if not (isinstance(tool, Tool) or "<" in str(source)):
        asked = {
            "source": str(source),
            "tip": tip,
            "base": base,
            "lock": read_lock(lock),
            "tool": None if tool is None else str(tool),
            "package_dirs": tuple(map(str, package_dirs)),
            "xacro_args": dict(xacro_args or {}),
        }
        robot = replace(robot, asked=asked)
    for issue in check_arm(arm, robot, doubts=False):
        if issue.at_load:
            warnings.warn(f"{robot.name}: {issue}", ModelWarning, stacklevel=2)
    return robot


def read_robot(
    source: str | Path,
    tip: str | None = None,
    base: str | None = None,
    lock: Lock = None,
    tool: AskedTool | None = None,
    package_dirs: Sequence[str | Path] = (),
    xacro_args: Mapping[str, str] | None = None,
) -> tuple[Description, Arm, Robot]:
    """Load an arm without a word on what is doubtful, with what it was made of.

    Arguments and errors as `load_robot`.
    """
    description = describe(source, package_dirs, xacro_args)
    arm = read_arm(description, tip, base, lock, tool)
    return description, arm, build_robot(description, arm)


def read_arm(
    description: Description,
    tip: str | None = None,
    base: str | None = None,
    lock: Lock = None,
    tool: AskedTool | None = None,
) -> Arm:
    """Read a description and choose the arm in it; arguments and errors as `load_robot`.

    What is asked for goes before what the TOML says; joints locked in either are held.
    """
    facts, name = description.facts, description.name
    try:
        told = read_lock(facts.get("lock"))
    except InputError as error:
        raise ModelError(name, str(error)) from None
    arm = choose_arm(
        description.tree,
        description.source,
        facts.get("tip") if tip is None else tip,
        facts.get("base") if base is None else base,
        told | read_lock(lock),
        {key: facts[key] for key in LIMITS if key in facts},
    )
    try:
        held = read_tool(tool) or read_tool(facts.get("tool"), description.home)
    except InputError as error:
        if tool is not None:
            raise
        raise ModelError(name, str(error)) from None
    return arm if held is None else arm.with_tool(held, _flange_link(arm, facts, name))


def _flange_link(arm: Arm, facts: Facts, name: str) -> str:
    """Return the link that a tool is welded to."""
    links = {link: link for link in arm.riding()}
    carried = {n: j.child for n, j in arm.tree.joints.items() if j.parent in links}
    return links.get(found := _flange_name(links | carried, facts, arm, name)) or carried[found]


def build_robot(description: Description, arm: Arm) -> Robot:
    """Build the Pinocchio model of an arm.

    Raises:
        ModelError: Pinocchio does not read what was read here, or a fact does not fit the arm.
    """
    facts, name = description.facts, description.name
    model = _model(arm, name)
    n = model.nv
    chain = [arm.tree.joints[joint] for joint in arm.joints]
    told = np.array([joint.armature for joint in chain])
    model.armature = per_joint(facts, "armature", told, name)
    if (model.armature < 0).any():
        raise ModelError(name, f"armature = {shown(facts['armature'])} must not be negative")
    turning = np.array([joint.kind != "prismatic" for joint in chain])
    usual = middle(model.lowerPositionLimit, model.upperPositionLimit, turning)
    rest = [m if joint.home is None else joint.home for joint, m in zip(chain, usual, strict=True)]
    home = per_joint(facts, "home", np.array(rest), name)
    joints = tuple(facts.get("hitting_joints", range(max(1, n - 2), n + 1)))
    if not joints or not all(type(k) is int and 1 <= k <= n for k in joints):
        raise ModelError(name, f"hitting_joints = {shown(joints)} must be joints from 1 to {n}")
    robot = Robot(
        name=name,
        model=model,
        hitting_joints=joints,
        home=home,
        flange=_flange(model, facts, arm, name),
        xml=arm.xml,
        title=facts.get("title", name),
        source=" ".join(facts.get("source", "").split()),
        licence=facts.get("licence", ""),
        package_directory="" if description.folder is None else str(description.folder),
        package_dirs=description.package_dirs,
        tool=arm.tool,
        **{key: drive_fact(facts, key, n, name) for key in DRIVE_FACTS},
        provenance=provenance(facts, name),
    )
    try:
        robot.within_limits(home, "home")
    except InputError as error:
        raise ModelError(name, str(error)) from None
    return robot


def _model(arm: Arm, name: str) -> Any:
    import pinocchio as pin

    try:
        model = pin.buildModelFromXML(urdf_text(arm.tree, shapes=False))
    except (ValueError, RuntimeError) as error:
        raise ModelError(name, f"Pinocchio cannot read it ({str(error).splitlines()[0]})") from None
    if tuple(model.names)[1:] != arm.joints or model.nq != model.nv:
        raise ModelError(name, f"Pinocchio reads joints {list(model.names)[1:]}, not {arm.joints}")
    compare_model(model, arm, name)
    model.name = name  # what messages from below call it
    for joint in arm.continuous:
        index = model.joints[model.getJointId(joint)].idx_q
        model.lowerPositionLimit[index] = -np.inf
        model.upperPositionLimit[index] = np.inf
    # Pinocchio 4.1 leaves the upper limit here; a URDF's velocity limit holds both ways.
    model.lowerVelocityLimit = -model.upperVelocityLimit
    return model


def _flange(model: Any, facts: Facts, arm: Arm, name: str) -> Contact:
    last = model.nv
    ends = {f.name: f.placement.translation for f in model.frames if f.parentJoint == last}
    end = arm.tip if arm.tool else _flange_name(ends, facts, arm, name)
    return Contact(last, tuple(ends[end]))


def _flange_name(ends: Collection[str], facts: Facts, arm: Arm, name: str) -> str:
    """Return the frame named in the TOML, or one with a usual name, or the tip."""
    frame = facts.get("flange")
    if frame is not None and frame not in ends:
        reason = f"flange {frame!r} is no frame on the last joint; choose one of {list(ends)}"
        raise ModelError(name, reason)
    usual = [(rank, end) for end in ends if (rank := end_rank(end)) is not None]
    return str(frame) if frame is not None else min(usual)[1] if usual else arm.tip
