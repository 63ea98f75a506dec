"""The file of a hit, hit.toml: what may stand in it, read and written.

This file knows the format alone: tables and keys, their types and ranges. What the values mean
together is `Hit`'s.
"""

from __future__ import annotations

import difflib
import json
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from hitjoints.errors import InputError, shown
from hitjoints.hit_setting import MOST_HITS, TOLERANCE

SCHEMA = 1
LARGEST = 2**20  # bytes
Vector = Annotated[list[float], Field(min_length=3, max_length=3)]
Seed = Annotated[int, Field(ge=0, le=2**63 - 1)]


class Table(BaseModel):
    """Keys that are not known are refused, and so are texts where numbers are wanted."""

    model_config = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False)


class RobotTable(Table):
    """The arm."""

    source: str = "iiwa14"
    tip: str | None = None
    base: str | None = None
    lock: dict[str, float] = {}
    tool: str | None = None
    package_dirs: list[str] = []
    xacro_args: dict[str, str] = {}


class ContactTable(Table):
    """What hits."""

    joints: Annotated[list[Annotated[int, Field(ge=1, le=1000)]], Field(min_length=1)] | None = None
    offset: Vector | list[Vector] | None = None


class ObjectTable(Table):
    """What is hit."""

    position: Vector
    mass: float
    size: Vector | None = None
    yaw: float = 0.0
    restitution: float | None = None
    friction: float | None = None
    spread: dict[str, float] = {}


class WishTable(Table):
    """What is to become of it."""

    goal: Vector | None = None
    direction: Vector | None = None
    flux: float | None = None
    object_speed: float | None = None


class SurroundingsTable(Table):
    """What stands around."""

    object_size: Vector | None = None
    table_height: float | None = None
    margin: float | None = None


class HowTable(Table):
    """How it is planned and made."""

    objective: str = "inertia"
    deliverable: bool | None = None
    away: bool = True
    torque_limits: bool = False
    seed: Seed = 0
    dt: float | None = None
    q0: list[float] | None = None
    q_hit: list[float] | None = None
    hits: Annotated[int, Field(ge=1, le=MOST_HITS)] = 1
    tolerance: float = TOLERANCE


class LimitsTable(Table):
    """Limits of the drives that the arm's own file does not tell, or tells otherwise."""

    acceleration: float | list[float] | None = None
    jerk: float | list[float] | None = None


class ImpactTable(Table):
    """The model of the arm's drives."""

    model: str = "rigid"
    contact_time: float = 0.01
    restitution: float = 0.5
    stiffness: float | list[float] | None = None
    rotor_inertia: float | list[float] | None = None


class HitTables(Table):
    """The whole file."""

    schema_: Annotated[int, Field(alias="schema", ge=SCHEMA, le=SCHEMA)]
    robot: RobotTable = RobotTable()
    contact: ContactTable = ContactTable()
    object: ObjectTable
    wish: WishTable
    surroundings: SurroundingsTable = SurroundingsTable()
    how: HowTable = HowTable()
    limits: LimitsTable = LimitsTable()
    impact: ImpactTable = ImpactTable()


def read_tables(path: Path) -> HitTables:
    """Read a file.

    Raises:
        InputError: it cannot be read or is no TOML, or a key is unknown, missing or wrong; the
            message names the file, the key, its value and what is allowed.
    """
    try:
        if not path.is_file() or path.stat().st_size > LARGEST:
            raise InputError("hit", path, "a TOML file that describes a hit is needed")
        tables = tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError("hit", path, f"it cannot be read ({error.strerror})") from None
    except RecursionError:
        raise InputError("hit", path, "it is no TOML file (nested too deeply)") from None
    except InputError:
        raise
    except ValueError as error:
        raise InputError("hit", path, f"it is no TOML file ({error})") from None
    return check_tables(tables, str(path))


def check_tables(tables: object, source: str) -> HitTables:
    """Check the tables of a hit, from whatever file; `source` is what to call it in messages.

    Raises:
        InputError: as `read_tables`.
    """
    try:
        return HitTables.model_validate(tables)
    except RecursionError:
        raise InputError(source, "...", "it is nested too deeply") from None
    except ValidationError as error:
        found = error.errors(include_url=False, include_context=False)
        first = next((one for one in found if one["type"] == "extra_forbidden"), found[0])
        raise _refusal(first, source) from None


def write_tables(tables: HitTables) -> str:
    """Return the text of a file; what is not given is left out."""
    given = tables.model_dump(by_alias=True, exclude_none=True)
    lines = [f"schema = {given.pop('schema')}"]
    for name, table in given.items():
        inner = {key: value for key, value in table.items() if value not in ({}, [])}
        if inner:
            lines += ["", f"[{name}]", *(f"{key} = {_toml(value)}" for key, value in inner.items())]
    return "\n".join(lines) + "\n"


def told(tables: Mapping[str, Mapping[str, Any]]) -> dict[str, Any]:
    """Return tables without what was not given, as JSON and TOML know them."""
    inner = {name: _said(table) for name, table in tables.items()}
    return {"schema": SCHEMA} | {name: table for name, table in inner.items() if table}


def _said(table: Mapping[str, Any]) -> dict[str, Any]:
    plain = {
        name: value.tolist() if hasattr(value, "tolist") else value for name, value in table.items()
    }
    return {
        name: _listed(value)
        for name, value in plain.items()
        if value is not None and value not in ({}, ())
    }


def _listed(value: Any) -> Any:
    if isinstance(value, Mapping):
        return dict(value)
    return list(map(_listed, value)) if isinstance(value, (tuple, list)) else value


def _refusal(found: Mapping[str, Any], source: str) -> InputError:
    """Return one line for what pydantic found."""
    # Where a value may be of several kinds, pydantic names the kind that it tried.
    said = [str(part) for part in found["loc"] if not str(part).startswith(("list[", "float"))]
    *tables, key = said or ["the whole"]
    name = f"{source}: {'.'.join((*tables, key))}"
    if found["type"] == "extra_forbidden":
        known = _keys(tables)
        near = difflib.get_close_matches(key, known, n=1, cutoff=0.5)
        hint = f"did you mean {near[0]}? " if near else ""
        expected = f"no such key; {hint}The keys here are {', '.join(known)}"
        return InputError(shown(name), shown(found["input"], repr), expected)
    if found["type"] == "missing":
        return InputError(shown(name), "nothing", "it is needed")
    message = str(found["msg"]).removeprefix("Input should be ")
    return InputError(shown(name), shown(found["input"], repr), f"it should be {message}")


def _keys(tables: list[str]) -> list[str]:
    """Return the keys that a table may have."""
    model: Any = HitTables
    for table in tables:
        model = model.model_fields[table].annotation
    return [field.alias or name for name, field in model.model_fields.items()]


def _toml(value: object) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{_toml(str(k))} = {_toml(v)}" for k, v in value.items()) + " }"
    if isinstance(value, (list, tuple)):
        return f"[{', '.join(map(_toml, value))}]"
    return repr(value)
