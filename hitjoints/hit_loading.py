"""A hit from its file, or from the tables that a result keeps of it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from hitjoints.errors import InputError
from hitjoints.hit import HOW_HARD, OBJECT, Hit
from hitjoints.hit_file import HitTables, check_tables, read_tables
from hitjoints.hit_in_result import ENDINGS, tables_in
from hitjoints.hit_setting import HitSetting, RobotChoice, offsets_of
from hitjoints.impact.drives import Drives
from hitjoints.model.robot import Contact

KEYS = {
    "contact": ("joint", "offset"),
    "object": OBJECT,
    "wish": ("goal", "direction", *HOW_HARD),
    "how": ("hits", "tolerance"),
    "impact": ("impact", "contact_time"),
}
"""The tables of a file that hold a hit's arguments."""


def load_hit(path: str | Path) -> Hit:
    """Read a hit.toml, or the hit that a result keeps.

    Args:
        path: of the file, or of a plan, an answer, a trajectory, a data set or a figure that
            hitjoints wrote; paths in it are relative to it.

    Raises:
        InputError: it cannot be read, or a key is unknown, missing or wrong; the message names
            the file, the key, its value and what is allowed.
    """
    path = Path(path)
    if path.suffix in ENDINGS:
        return hit_of(tables_in(path), path)
    return _found_from(_hit(read_tables(path), str(path)), path.parent)


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
    said: dict[str, Any] = _tuples(tables.model_dump())
    offset, named = said["contact"]["offset"], said["contact"]["joints"]
    one = named[0] if named is not None and len(named) == 1 else None
    try:
        return Hit(
            None if one is None else Contact(one, offsets_of(offset, 1)[0]),
            **said["object"],
            **said["wish"],
            setting=HitSetting(
                robot=RobotChoice(**said["robot"]),
                joints=named if one is None else None,
                offset=offset if one is None else None,
                **said["surroundings"],
                **said["how"],
                **said["limits"],
                drives=Drives(**said["impact"]),
            ),
        )
    except InputError as error:
        table = next((name for name, keys in KEYS.items() if error.argument in keys), "")
        name = ".".join(filter(None, (table, error.argument)))
        raise InputError(f"{source}: {name}", error.value, error.expected) from None


def _tuples(value: Any) -> Any:
    """Return the same with tuples in the place of lists."""
    if isinstance(value, Mapping):
        return {name: _tuples(item) for name, item in value.items()}
    return tuple(map(_tuples, value)) if isinstance(value, list) else value
