"""What a robot's TOML adds to a description, and how it is checked."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from hitjoints.errors import InputError, ModelError, shown
from hitjoints.vectors import real

if TYPE_CHECKING:
    from numpy.typing import NDArray

# What a robot's TOML may hold.
KEYS: dict[str, type | tuple[type, ...]] = {
    "name": str, "title": str, "urdf": str, "licence": str, "source": str,
    "tip": str, "base": str, "lock": (list, dict), "flange": str,
    "tool": (str, dict), "package_dirs": list, "xacro_args": dict,
    "hitting_joints": list, "home": list, "armature": list,
    "position": list, "velocity": list, "effort": list,
    "acceleration": list, "acceleration_source": str, "jerk": list, "jerk_source": str,
    "rotor_inertia": list, "rotor_inertia_source": str,
    "joint_stiffness": list, "joint_stiffness_source": str,
}  # fmt: skip
KINDS = {
    (str, dict): "text or a table",
    str: "text",
    dict: "a table",
    list: "a list",
    (list, dict): "a list or a table",
}
# Facts of the drives that no description holds; each stays unknown without an entry.
DRIVE_FACTS = ("acceleration", "jerk", "rotor_inertia", "joint_stiffness")
# Limits that go before those of the description.
LIMITS = ("position", "velocity", "effort")

Facts = Mapping[str, Any]


def read_facts(text: str, path: Path) -> Facts:
    """Read the text of a robot's TOML.

    Raises:
        ModelError: it is no TOML, or a key is unknown or of the wrong type.
    """
    try:
        facts = tomllib.loads(text)
    except RecursionError:
        raise ModelError(str(path), "not a TOML file (nested too deeply)") from None
    except ValueError as error:
        raise ModelError(str(path), f"not a TOML file ({error})") from None
    for key, value in facts.items():
        if key not in KEYS:
            raise ModelError(
                str(path), f"unknown key {shown(key, repr)}; the keys are {', '.join(KEYS)}"
            )
        if not isinstance(value, KEYS[key]):
            kind = KINDS[KEYS[key]]
            raise ModelError(str(path), f"{key} = {shown(value, repr)} must be {kind}")
    if "urdf" not in facts:
        raise ModelError(str(path), "the key 'urdf' must name the URDF file")
    return facts


def read_lock(lock: str | Iterable[str] | Mapping[str, float] | None) -> dict[str, float]:
    """Return the positions (rad or m) of joints to hold, by name.

    Args:
        lock: positions by name; or one or several of "NAME" (held at zero) and "NAME=VALUE".

    Raises:
        InputError: a name is no text or a position no finite number.
    """
    wanted = "NAME or NAME=VALUE, a joint and the position (rad or m) to hold it at"
    if lock is None:
        return {}
    if isinstance(lock, str):
        lock = [lock]
    items = lock.items() if isinstance(lock, Mapping) else [_parted(item, wanted) for item in lock]
    read = {}
    for name, value in items:
        if not isinstance(name, str) or isinstance(value, bool):
            raise InputError("lock", name, wanted)
        try:
            read[name] = float(value)
        except (TypeError, ValueError, OverflowError):
            read[name] = math.nan
        if not math.isfinite(read[name]):
            raise InputError("lock", f"{name}={value}", wanted)
    return read


def _parted(item: Any, wanted: str) -> tuple[str, Any]:
    if not isinstance(item, str):
        raise InputError("lock", item, wanted)
    name, equals, value = item.rpartition("=")
    return (name, value) if equals else (item, 0.0)


def per_joint(facts: Facts, key: str, default: NDArray[np.float64], name: str) -> Any:
    """Return a fact with one number per joint, or the default (n,).

    Raises:
        ModelError: wrong count, or not finite.
    """
    wanted = f"must be {len(default)} finite numbers"
    try:
        values = real(facts.get(key, default), key, wanted)
    except InputError:
        values = np.empty(0)
    if values.shape != np.shape(default) or not np.isfinite(values).all():
        raise ModelError(name, f"{key} = {shown(facts.get(key, default))} {wanted}")
    return values


def drive_fact(facts: Facts, key: str, n: int, name: str) -> Any:
    """Return one of `DRIVE_FACTS`, (n,), or None when it is not known.

    Raises:
        ModelError: wrong count, not finite, or out of its range.
    """
    if key not in facts:
        return None
    values = per_joint(facts, key, np.zeros(n), name)
    # A drive may have a light rotor; a limit or a stiffness of zero would hold the arm still.
    if (values < 0).any() or (key != "rotor_inertia" and not values.all()):
        least = "not be negative" if key == "rotor_inertia" else "be above zero"
        raise ModelError(name, f"{key} = {shown(facts[key])} must {least}")
    return values


def provenance(facts: Facts, name: str) -> dict[str, str]:
    """Return where the facts of the drives come from, by name.

    Raises:
        ModelError: a fact without a source, or a source without a fact.
    """
    sources = {key: facts[f"{key}_source"] for key in DRIVE_FACTS if f"{key}_source" in facts}
    for key in DRIVE_FACTS:
        if (key in facts) != (key in sources):
            reason = f"{key} and {key}_source belong together: a number and where it comes from"
            raise ModelError(name, reason)
    return {key: " ".join(source.split()) for key, source in sources.items()}
