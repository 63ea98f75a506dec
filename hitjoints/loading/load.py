"""Find a robot by name or path and make a `Robot` of it."""

from __future__ import annotations

import os
import tomllib
import warnings
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from functools import lru_cache
from importlib import metadata, resources
from pathlib import Path
from typing import Any

import numpy as np

from hitjoints.errors import InputError, ModelError, UnknownNameError, shown
from hitjoints.loading.check import check_arm
from hitjoints.model.collision_shapes import without_shapes
from hitjoints.model.robot import Contact, Robot
from hitjoints.model.urdf import Arm, read_arm, read_text
from hitjoints.vectors import real

ERD = "example-robot-data"
# Frames that mark the end of an arm in common URDFs, tried in this order.
FLANGE_NAMES = ("flange", "tool0", "ee_link", "link_eef")
# What a robot's TOML may hold.
KEYS = {
    "name": str, "title": str, "urdf": str, "licence": str, "source": str, "lock": list,
    "hitting_joints": list, "home": list, "flange": str, "armature": list,
    "acceleration": list, "acceleration_source": str, "jerk": list, "jerk_source": str,
    "rotor_inertia": list, "rotor_inertia_source": str,
    "joint_stiffness": list, "joint_stiffness_source": str,
}  # fmt: skip
# Facts of the drives that no description holds; each stays unknown without an entry.
DRIVE_FACTS = ("acceleration", "jerk", "rotor_inertia", "joint_stiffness")


class ModelWarning(UserWarning):
    """A robot description holds a number that spoils the inertias computed from it."""


@dataclass(frozen=True)
class Description:
    """A robot description before Pinocchio sees it."""

    name: str
    arm: Arm
    facts: Mapping[str, Any]
    """The TOML's entries; empty for a bare URDF."""
    package_directory: str


def robot_names() -> list[str]:
    """Return the names of the robots that come with hitjoints."""
    files = resources.files("hitjoints.robots").iterdir()
    return sorted(file.name[:-5] for file in files if file.name.endswith(".toml"))


def load_robot(name_or_path: str | Path, *, lock: Collection[str] = ()) -> Robot:
    """Load an arm.

    Args:
        name_or_path: a name of `robot_names`, the name of a URDF in example-robot-data, or the
            path of a URDF, or of a TOML laid out as those in hitjoints/robots (which adds to a
            URDF the home configuration, hitting joints, flange and rotor inertias).
        lock: names of joints to hold at zero, such as the fingers of a gripper.

    Returns:
        The robot. Continuous joints have infinite position limits.

    Raises:
        InputError: there is no such robot or file.
        ModelError: the file is not a fixed-base serial arm; the message says why.

    Warns:
        ModelWarning: an inertia is physically impossible or out of proportion; the text says what
            that does to the directional inertia.
    """
    description = describe(name_or_path, lock)
    robot = build_robot(description)
    for issue in check_arm(description.arm, robot):
        if issue.severity == "error":
            warnings.warn(f"{robot.name}: {issue}", ModelWarning, stacklevel=2)
    return robot


def describe(name_or_path: str | Path, lock: Collection[str] = ()) -> Description:
    """Read the files of a robot; arguments and errors as `load_robot`."""
    text = str(name_or_path)
    lock = (lock,) if isinstance(lock, str) else lock
    if text in robot_names():
        return _from_toml(Path(str(resources.files("hitjoints.robots"))) / f"{text}.toml", lock)
    path = Path(text)
    if path.suffix == ".toml":
        return _from_toml(path, lock)
    if path.suffix != ".urdf" and "/" not in text and not os.path.isfile(text):
        known = erd_urdfs()
        if text not in known:
            raise UnknownNameError(
                "robot", text, [*robot_names(), "a URDF path", f"a robot of {ERD}"]
            )
        path = known[text]
    arm = read_arm(read_text(str(path)), str(name_or_path), lock)
    return Description(path.stem, arm, {}, _package_directory(path))


def _from_toml(path: Path, lock: Collection[str]) -> Description:
    text = read_text(str(path))
    try:
        facts = tomllib.loads(text)
    except RecursionError:
        raise ModelError(str(path), "not a TOML file (nested too deeply)") from None
    except ValueError as error:
        raise ModelError(str(path), f"not a TOML file ({error})") from None
    for key, value in facts.items():
        if key not in KEYS:
            raise ModelError(str(path), f"unknown key {key!r}; the keys are {', '.join(KEYS)}")
        if not isinstance(value, KEYS[key]):
            kind = "text" if KEYS[key] is str else "a list"
            raise ModelError(str(path), f"{key} = {shown(value, repr)} must be {kind}")
    if "urdf" not in facts:
        raise ModelError(str(path), "the key 'urdf' must name the URDF file")
    if not all(isinstance(joint, str) for joint in facts.get("lock", ())):
        raise ModelError(str(path), f"lock = {shown(facts['lock'])} must be names of joints")
    package, _, inside = facts["urdf"].rpartition(":")
    urdf = (erd_directory() / inside) if package == ERD else path.parent / facts["urdf"]
    name = facts.get("name", path.stem)
    arm = read_arm(read_text(str(urdf)), name, {*facts.get("lock", ()), *lock})
    return Description(name, arm, facts, _package_directory(urdf))


def build_robot(description: Description) -> Robot:
    """Build the Pinocchio model of a description."""
    import pinocchio as pin

    arm, facts, name = description.arm, description.facts, description.name
    try:
        model = pin.buildModelFromXML(without_shapes(arm.xml))
    except (ValueError, RuntimeError) as error:
        raise ModelError(name, f"Pinocchio cannot read it ({str(error).splitlines()[0]})") from None
    if tuple(model.names)[1:] != arm.joints or model.nq != model.nv:
        raise ModelError(name, f"Pinocchio reads joints {list(model.names)[1:]}, not {arm.joints}")
    for joint in arm.continuous:
        index = model.joints[model.getJointId(joint)].idx_q
        model.lowerPositionLimit[index] = -np.inf
        model.upperPositionLimit[index] = np.inf
    n = model.nv
    # Pinocchio 4.1 leaves the upper limit here; a URDF's velocity limit holds both ways.
    model.lowerVelocityLimit = -model.upperVelocityLimit
    model.armature = _facts_vector(facts, "armature", np.zeros(n), name)
    if (model.armature < 0).any():
        raise ModelError(name, f"armature = {shown(facts['armature'])} must not be negative")
    lower, upper = model.lowerPositionLimit, model.upperPositionLimit
    middle, bounded = np.zeros(n), np.isfinite(lower)
    middle[bounded] = (lower[bounded] + upper[bounded]) / 2
    home = _facts_vector(facts, "home", middle, name)
    joints = tuple(facts.get("hitting_joints", range(max(1, n - 2), n + 1)))
    if not joints or not all(type(k) is int and 1 <= k <= n for k in joints):
        raise ModelError(name, f"hitting_joints = {shown(joints)} must be joints from 1 to {n}")
    robot = Robot(
        name=name,
        model=model,
        hitting_joints=joints,
        home=home,
        flange=_flange(model, facts.get("flange"), name),
        xml=arm.xml,
        title=facts.get("title", name),
        source=" ".join(facts.get("source", "").split()),
        licence=facts.get("licence", ""),
        package_directory=description.package_directory,
        **{key: _drive_fact(facts, key, n, name) for key in DRIVE_FACTS},
        provenance=_provenance(facts, name),
    )
    try:
        robot.within_limits(home, "home")
    except InputError as error:
        raise ModelError(name, str(error)) from None
    return robot


def _facts_vector(facts: Mapping[str, Any], key: str, default: Any, name: str) -> Any:
    wanted = f"must be {len(default)} finite numbers"
    try:
        values = real(facts.get(key, default), key, wanted)
    except InputError:
        values = np.empty(0)
    if values.shape != np.shape(default) or not np.isfinite(values).all():
        raise ModelError(name, f"{key} = {shown(facts[key])} {wanted}")
    return values


def _drive_fact(facts: Mapping[str, Any], key: str, n: int, name: str) -> Any:
    if key not in facts:
        return None
    values = _facts_vector(facts, key, np.zeros(n), name)
    # A drive may have a light rotor; a limit or a stiffness of zero would hold the arm still.
    if (values < 0).any() or (key != "rotor_inertia" and not values.all()):
        least = "not be negative" if key == "rotor_inertia" else "be above zero"
        raise ModelError(name, f"{key} = {shown(facts[key])} must {least}")
    return values


def _provenance(facts: Mapping[str, Any], name: str) -> dict[str, str]:
    sources = {key: facts[f"{key}_source"] for key in DRIVE_FACTS if f"{key}_source" in facts}
    for key in DRIVE_FACTS:
        if (key in facts) != (key in sources):
            reason = f"{key} and {key}_source belong together: a number and where it comes from"
            raise ModelError(name, reason)
    return {key: " ".join(source.split()) for key, source in sources.items()}


def _flange(model: Any, frame: str | None, name: str) -> Contact:
    """Return the named frame's point, or that of a usual name, or the last joint's origin."""
    last = model.nv
    ends = {f.name: f.placement.translation for f in model.frames if f.parentJoint == last}
    if frame is not None and frame not in ends:
        reason = f"flange {frame!r} is no frame on the last joint; choose one of {list(ends)}"
        raise ModelError(name, reason)
    for candidate in (frame,) if frame is not None else FLANGE_NAMES:
        if candidate in ends:
            return Contact(last, tuple(ends[candidate]))
    return Contact(last)


@lru_cache(maxsize=1)
def erd_directory() -> Path:
    """Return the folder of robots in the installed example-robot-data."""
    share = f"cmeel.prefix/share/{ERD}/robots"
    try:
        return Path(str(metadata.distribution(ERD).locate_file(share)))
    except metadata.PackageNotFoundError:
        install = "it is not installed: pip install example-robot-data"
        raise InputError("robot", ERD, install) from None


@lru_cache(maxsize=1)
def erd_urdfs() -> dict[str, Path]:
    """Return the URDFs of example-robot-data by file name without its ending."""
    return {path.stem: path for path in sorted(erd_directory().rglob("*.urdf"), reverse=True)}


def _package_directory(urdf: Path) -> str:
    """Return the folder that a URDF's meshes are looked for from."""
    return str(urdf.absolute().parent)
