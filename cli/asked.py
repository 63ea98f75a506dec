"""The hit that a command is asked for: its options, the file of a plan, and the usual values."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple

import typer

from .options import DIRECTION, MASS, OBJECT, check_mass, numbers, triple

if TYPE_CHECKING:
    from hitjoints.hit import Hit
    from hitjoints.model.robot import Robot

FLUX = 0.3

ObjectAsked = Annotated[
    str | None,
    typer.Option(
        "--object", metavar="X,Y,Z", help=f"Position of the object (m). (default: {OBJECT})"
    ),
]
DirectionAsked = Annotated[
    str | None,
    typer.Option("--direction", metavar="X,Y,Z", help=f"Hitting direction. (default: {DIRECTION})"),
]
MassAsked = Annotated[
    float | None,
    typer.Option("--mass", metavar="KG", help=f"Mass of the object. (default: {MASS:g})"),
]
ContactOffsetOption = Annotated[
    str,
    typer.Option(
        "--contact-offset", metavar="X,Y,Z", help="Contact point in the joint's frame (m)."
    ),
]
FluxOption = Annotated[
    float, typer.Option("--flux", metavar="M/S", help="Desired hitting flux (Eq. 4).")
]
PlanOption = Annotated[
    Path | None,
    typer.Option("--plan", metavar="FILE", help="Hit as planned by `plan --out FILE`."),
]
Q0Option = Annotated[
    str | None, typer.Option("--q0", metavar="Q1,Q2,...", help="Start configuration.")
]
StartOption = Annotated[
    str | None, typer.Option("--start", metavar="X,Y,Z", help="Start of the contact point.")
]


class Asked(NamedTuple):
    """The arm, the hit, and where from: `starts` are the arguments of `rollout` for its start."""

    robot: Robot
    hit: Hit
    starts: dict[str, Any]


def read_asked(
    robot: str,
    position: str | None,
    direction: str | None,
    mass: float | None,
    joint: int | None,
    contact_offset: str,
    flux: float,
    plan: Path | None,
    q0: str | None,
    start: str | None,
) -> Asked:
    """Read the options: what is not asked for is as planned, or else as usual.

    Raises:
        InputError: a value cannot be used, or an option contradicts the plan.
        InfeasibleError: the plan says that no joint can do it.
    """
    from hitjoints.hit import Hit
    from hitjoints.loading.load import load_robot
    from hitjoints.model.robot import Contact

    asked: dict[str, Any] = {
        "position": None if position is None else triple(position, "object"),
        "direction": None if direction is None else triple(direction, "direction"),
        "mass": mass,
        "joint": joint,
    }
    planned = {} if plan is None else _read_plan(plan, robot)
    arm = load_robot(robot)
    usual = {
        "position": numbers(OBJECT),
        "direction": numbers(DIRECTION),
        "mass": MASS,
        "joint": arm.usual_joint,
    }
    chosen = {key: _one(key, asked[key], planned.get(key), usual[key]) for key in usual}
    check_mass(chosen["mass"])
    contact = arm.contact(Contact(chosen["joint"], triple(contact_offset, "contact-offset")))
    starts = {
        "q0": None if q0 is None else numbers(q0),
        "start": None if start is None else triple(start, "start"),
        "q_hit": planned.get("q"),
    }
    hit = Hit(contact, chosen["position"], chosen["direction"], chosen["mass"], flux)
    return Asked(arm, hit, starts)


def _read_plan(path: Path, robot: str) -> dict[str, Any]:
    """Return position, direction, mass, joint and q of a plan's best candidate.

    Raises:
        InputError: the file cannot be read, is no plan, or is one for another robot.
        InfeasibleError: the plan says that no joint can do it.
    """
    from hitjoints.errors import InfeasibleError, InputError

    try:
        plan = json.loads(path.read_text(encoding="utf-8"))
        best = plan["best"]
        found = {key: plan[key] for key in ("position", "direction", "mass")}
        if best is not None:
            found |= {key: best[key] for key in ("joint", "q")}
        made_for = plan["robot"]
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise InputError("plan", path, f"it is not a plan ({error})") from None
    if best is None:
        raise InfeasibleError(f"the plan {path} says no: {plan.get('summary', '')}")
    if made_for != robot:
        raise InputError("plan", path, f"it is made for {made_for}, not for {robot}")
    return found


def _one(name: str, asked: Any, planned: Any, usual: Any) -> Any:
    """Return what is asked for, planned or usual, and refuse to be asked for what is not planned.

    Raises:
        InputError: an option contradicts the plan.
    """
    import numpy as np

    from hitjoints.errors import InputError

    if asked is None:
        return usual if planned is None else planned
    if planned is not None and not np.allclose(asked, planned, rtol=0, atol=1e-9):
        raise InputError(name.replace("position", "object"), asked, f"the plan is for {planned}")
    return asked
