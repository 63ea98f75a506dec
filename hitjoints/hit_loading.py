"""A hit from its file, or from the tables that a result keeps of it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from hitjoints.errors import InputError
from hitjoints.hit import HOW_HARD, OBJECT, Hit
from hitjoints.hit_file import HitTables, check_tables, read_tables
from hitjoints.hit_setting import HitSetting, RobotChoice
from hitjoints.impact.drives import Drives
from hitjoints.model.robot import Contact

KEYS = {
    "contact": ("joint", "offset"),
    "object": OBJECT,
    "wish": ("goal", "direction", *HOW_HARD),
    "impact": ("impact", "contact_time"),
}
"""The tables of a file that hold a hit's arguments."""


def load_hit(path: str | Path) -> Hit:
    """Read a hit.toml.

    Args:
        path: of the file; paths in it are relative to it.

    Raises:
        InputError: it cannot be read, or a key is unknown, missing or wrong; the message names
            the file, the key, its value and what is allowed.
    """
    return _found_from(_hit(read_tables(Path(path)), str(path)), Path(path).parent)


def hit_of(tables: Mapping[str, Any], path: Path) -> Hit:
    """Return the hit that `Hit.as_dict` told, from a result in a file.

    Args:
        tables: as told.
        path: of the file; paths in the tables are relative to it.

    Raises:
        InputError: as `load_hit`.
    """
    return _found_from(_hit(check_tables(tables, str(path)), str(path)), path.parent)


def _found_from(hit: Hit, folder: Path) -> Hit:
    robot = hit.setting.robot
    found = None if robot is None else robot.found_from(folder)
    return hit.changed(setting=replace(hit.setting, robot=found))


def _hit(tables: HitTables, source: str) -> Hit:
    said = tables.model_dump()
    robot, how, contact = said["robot"], said["how"], tables.contact
    offset = None if contact.offset is None else _triple(contact.offset)
    one = contact.joints[0] if contact.joints is not None and len(contact.joints) == 1 else None
    joints = None if contact.joints is None or one is not None else tuple(contact.joints)
    try:
        return Hit(
            None if one is None else Contact(one, offset or (0.0, 0.0, 0.0)),
            **said["object"],
            **said["wish"],
            setting=HitSetting(
                robot=RobotChoice(**robot | {"package_dirs": tuple(robot["package_dirs"])}),
                joints=joints,
                offset=offset if one is None else None,
                **said["surroundings"] | _tuple(said["surroundings"], "object_size"),
                **how | _tuple(how, "q0"),
                drives=Drives(**said["impact"]),
            ),
        )
    except InputError as error:
        table = next((name for name, keys in KEYS.items() if error.argument in keys), "")
        name = ".".join(filter(None, (table, error.argument)))
        raise InputError(f"{source}: {name}", error.value, error.expected) from None


def _tuple(table: Mapping[str, Any], name: str) -> dict[str, Any]:
    return {name: None if table[name] is None else tuple(table[name])}


def _triple(values: list[float]) -> tuple[float, float, float]:
    x, y, z = values
    return x, y, z
