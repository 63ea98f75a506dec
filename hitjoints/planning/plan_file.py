"""The file of a plan, plan.json: read again, checked, and found equal."""

from __future__ import annotations

import json
from dataclasses import fields
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from pydantic import ConfigDict, Field, TypeAdapter, ValidationError, field_validator

from hitjoints.errors import InputError, shown
from hitjoints.hit_file import Table
from hitjoints.hit_loading import hit_of
from hitjoints.planning.candidates import Candidate, Refusal, Verdict
from hitjoints.planning.plan_record import Plan
from hitjoints.planning.start import Start
from hitjoints.planning.torque_cost import TorqueCost

LARGEST = 2**26  # bytes
NEEDED = ("q", "inertia", "speed", "straight_speed", "flux", "straight_flux", "away", "away_gap")
"""Of a candidate that can do it."""
T = TypeVar("T")
Row = list[float]


class CandidateTable(Table):
    """What a plan says about one joint."""

    joint: int = Field(ge=1, le=1000)
    offset: Row = Field(min_length=3, max_length=3)
    feasible: bool
    reason: str
    q: Row | None
    position_error: float | None
    inertia: float | None
    speed: float | None
    straight_speed: float | None
    flux: float | None
    straight_flux: float | None
    deliverable_flux: float | None
    deliverable_reason: str | None
    away: bool | None
    away_gap: float | None
    clearance: dict[str, Any] | None
    links_inertia: float | None
    arrives: float | None
    evidence: dict[str, Any]


class StartTable(Table):
    """Where the best hit starts."""

    q: Row
    position: Row
    speed: float
    run_up: float
    path: list[Row]

    @field_validator("path")
    @classmethod
    def _even(cls, path: list[Row]) -> list[Row]:
        if len({len(row) for row in path}) > 1:
            raise ValueError("rows of one length are needed")
        return path

    times: Row
    lateral_miss: float
    velocity_ratio_max: float
    feasible: bool
    reason: str


class CostTable(Table):
    """What torque limits cost a joint."""

    joint: int
    straight_flux: float
    flux_without: float | None
    flux_with: float | None


class PlanTables(Table):
    """What is read of the whole file; the rest follows from it, and is there for people."""

    model_config = ConfigDict(extra="ignore")

    hit: dict[str, Any]
    digest: str
    made_with: str
    robot: str
    flux_by: str | None
    best: CandidateTable | None
    candidates: list[CandidateTable] = Field(min_length=1)
    start: StartTable | None
    torque_costs: list[CostTable]


def load_plan(path: str | Path) -> Plan:
    """Read a plan that `Plan.save` or `hitjoints plan --out` wrote.

    Args:
        path: of the file; paths in it are relative to it.

    Raises:
        InputError: it cannot be read or is no plan; the message names the key and its value.
    """
    path = Path(path)
    said = _read(path)
    hit = hit_of(said.hit, path)
    candidates = tuple(_verdict(path, table) for table in said.candidates)
    best: Candidate | None = None
    if said.best is not None:
        place = said.candidates.index(said.best) if said.best in said.candidates else 0
        chosen = candidates[place]
        if said.best != said.candidates[place] or not isinstance(chosen, Candidate):
            raise InputError("plan", path, "it is not a plan (best is no candidate that can do it)")
        best = chosen
    start = None if said.start is None else _made(Start, said.start)
    costs = tuple(_made(TorqueCost, table) for table in said.torque_costs)
    told = said.robot, hit, best, candidates, said.digest, said.made_with, start, costs
    return Plan(*told, deliverable=said.flux_by == "deliverable")


def _read(path: Path) -> PlanTables:
    try:
        if not path.is_file() or path.stat().st_size > LARGEST:
            raise InputError("plan", path, "a file that `hitjoints plan --out` wrote is needed")
        tables = json.loads(path.read_text(encoding="utf-8"))
        return TypeAdapter(PlanTables).validate_python(tables)
    except ValidationError as error:
        found = error.errors(include_url=False, include_context=False)[0]
        key = ".".join(map(str, found["loc"])) or "the whole"
        message = str(found["msg"]).removeprefix("Input should be ")
        reason = f"it is not a plan ({key} = {shown(found['input'], repr)}: {message})"
        raise InputError("plan", path, reason) from None
    except OSError as error:
        raise InputError("plan", path, f"it cannot be read ({error.strerror})") from None
    except RecursionError:
        raise InputError("plan", path, "it is not a plan (nested too deeply)") from None
    except InputError:
        raise
    except ValueError as error:
        raise InputError("plan", path, f"it is not a plan ({error})") from None


def _verdict(path: Path, table: CandidateTable) -> Verdict:
    if not table.feasible:
        return _made(Refusal, table)
    missing = [name for name in NEEDED if getattr(table, name) is None]
    if missing:
        reason = (
            f"it is not a plan (joint {table.joint} can do it, and its {missing[0]} is missing)"
        )
        raise InputError("plan", path, reason)
    return _made(Candidate, table)


def _made(kind: type[T], table: Table) -> T:
    """Return what a table tells, its lists of numbers as arrays."""
    values = table.model_dump()
    arrays = {"q", "position", "path", "times"}
    for name in arrays & values.keys():
        if values[name] is not None:
            values[name] = np.array(values[name], dtype=float)
    if "offset" in values:
        values["offset"] = tuple(values["offset"])
    names = [item.name for item in fields(kind) if item.init]  # type: ignore[arg-type]
    return kind(**{name: values[name] for name in names})
