"""`hitjoints inspect`: everything about hitting with one joint in one configuration."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import typer

from .complaints import complain
from .hit_options import AskedHit, HitOptions
from .impact_options import ImpactOptions, impact_rows
from .option_groups import without
from .options import ConfigurationOption, JsonOption, numbers
from .render import print_json, print_table
from .robot_options import RobotOptions
from .start_options import StartOptions

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from hitjoints.model.robot import Contact, Robot


def inspect(
    robot: RobotOptions,
    hit: Annotated[HitOptions, without("flux", "object_speed", "restitution")],
    impact: ImpactOptions,
    start: Annotated[StartOptions, without("q0", "start", "torque_limits", "seed")],
    q: ConfigurationOption = None,
    as_json: JsonOption = False,
) -> None:
    """Show position, inertia, gradient, speed and flux at one configuration.

    It is --q, that of --plan, one that holds the joint at --object, or home. With --impact, what
    the arm shows in a hit at its greatest speed, by models of its drives.
    """
    from hitjoints.errors import InfeasibleError

    impact.check()
    plan = start.planned()
    asked = hit.read(plan, restitution=impact.restitution)
    arm = robot.load()
    contact = asked.contact(arm)
    if plan is not None and q is None:
        configuration = start.arguments(plan, asked.hit(contact), arm)["q_hit"]
    else:
        configuration = _configuration(arm, contact, hit, asked, q)
    try:
        result = _quantities(arm, configuration, contact, asked.direction, asked.mass)
        reason = None
        if impact.impact is not None:
            h, speed = result["direction"], result["speed"]
            result["impact"] = impact.of(arm, configuration, contact, h, asked.mass, speed)
    except InfeasibleError as error:
        result, reason = error.data, error.reason
    if as_json:
        print_json(result | {"feasible": reason is None, "reason": reason})
    else:
        _print(arm, contact, result)
    if reason is not None:
        complain("no", reason)
        raise typer.Exit(3)


def _configuration(
    arm: Robot, contact: Contact, hit: HitOptions, asked: AskedHit, q: str | None
) -> NDArray[np.float64]:
    """Return the configuration asked for: at an object that is named, else at home.

    Raises:
        InputError: outside the limits, or of the wrong length.
        InfeasibleError: the contact does not reach the object.
    """
    if q is not None:
        return arm.within_limits(numbers(q))
    if hit.position is None:
        return arm.home
    import numpy as np

    from hitjoints.rollouts.prepare import placed

    return placed(arm, contact, np.array(asked.position), arm.home)


def _quantities(
    robot: Robot, q: Any, contact: Contact, direction: tuple[float, ...], mass: float
) -> dict[str, Any]:
    """Compute what is shown.

    Raises:
        InfeasibleError: the contact cannot move along the direction; `data` holds the rest.
    """
    import hitjoints as hj
    from hitjoints.vectors import unit

    h = unit(direction)
    directions = hj.feasible_directions(robot, q, contact)
    speeds = [hj.hitting_speed(robot, q, contact, h, straight=s) for s in (False, True)]
    result: dict[str, Any] = {
        "robot": robot.name,
        "joint": contact.joint,
        "offset": contact.offset,
        "q": q,
        "direction": h,
        "mass": mass,
        "position": hj.position(robot, q, contact),
        "rank": directions.rank,
        "feasible_directions": {
            "description": directions.description,
            "basis": directions.basis.T,
            "speed": directions.speed,
        },
        "manipulability": hj.manipulability(robot, q, contact),
        "inverse_inertia": hj.inverse_inertia(robot, q, contact),
        "speed": speeds[0],
        "straight_speed": speeds[1],
    }
    try:
        inertia = hj.directional_inertia(robot, q, contact, h)
    except hj.InfeasibleError as error:
        missing = dict.fromkeys(("inertia", "gradient"))
        still = dict.fromkeys(("speed", "straight_speed", "flux", "straight_flux"), 0.0)
        raise hj.InfeasibleError(error.reason, result | missing | still) from None
    result["inertia"] = inertia
    result["gradient"] = hj.directional_inertia_gradient(robot, q, contact, h)
    result["flux"] = hj.hitting_flux(inertia, mass, speeds[0])
    result["straight_flux"] = hj.hitting_flux(inertia, mass, speeds[1])
    return result


def _print(robot: Robot, contact: Contact, result: dict[str, Any]) -> None:
    directions = result["feasible_directions"]
    where = f", offset ({', '.join(f'{v:g}' for v in contact.offset)}) m"
    rows = [
        ("configuration q", result["q"], "rad"),
        ("position", result["position"], "m"),
        ("feasible directions", f"{directions['description']} (rank {result['rank']})", ""),
        ("manipulability", result["manipulability"], "m^3/rad^3"),
        ("inertia", result["inertia"], "kg"),
        ("gradient", result["gradient"], "kg/rad"),
        ("speed", result["speed"], "m/s"),
        ("straight speed", result["straight_speed"], "m/s"),
        (f"flux, {result['mass']:g} kg object", result["flux"], "m/s"),
        ("straight flux", result["straight_flux"], "m/s"),
        *impact_rows(result.get("impact", {})),
    ]
    title = (
        f"{robot.title}: hit with joint {contact.joint}"
        f"{where if any(contact.offset) else ''} "
        f"along ({', '.join(f'{v:g}' for v in result['direction'])})"
    )
    print_table(title, ("quantity", "value", "unit"), rows)
