"""`hitjoints rollout`: move the arm through a hit and say what happens at the impact."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from .options import (
    DIRECTION,
    MASS,
    OBJECT,
    ORIGIN,
    ROBOT,
    JsonOption,
    OutOption,
    PlotOption,
    RobotOption,
    SeedOption,
    TorquesOption,
    check_mass,
    check_outputs,
    numbers,
    triple,
)
from .render import complain, print_json, print_table

if TYPE_CHECKING:
    from hitjoints.hitting.record import Rollout

FLUX = 0.3


def rollout(
    robot: RobotOption = ROBOT,
    position: Annotated[
        str | None,
        typer.Option(
            "--object", metavar="X,Y,Z", help=f"Position of the object (m). (default: {OBJECT})"
        ),
    ] = None,
    direction: Annotated[
        str | None,
        typer.Option(
            "--direction", metavar="X,Y,Z", help=f"Hitting direction. (default: {DIRECTION})"
        ),
    ] = None,
    mass: Annotated[
        float | None,
        typer.Option("--mass", metavar="KG", help=f"Mass of the object. (default: {MASS:g})"),
    ] = None,
    joint: Annotated[
        int | None, typer.Option("--joint", help="Hitting joint, from 1. (default: last but one)")
    ] = None,
    contact_offset: Annotated[
        str,
        typer.Option(
            "--contact-offset", metavar="X,Y,Z", help="Contact point in the joint's frame (m)."
        ),
    ] = ORIGIN,
    flux: Annotated[
        float, typer.Option("--flux", metavar="M/S", help="Desired hitting flux (Eq. 4).")
    ] = FLUX,
    reference: Annotated[
        str, typer.Option("--reference", help="Desired inertia: constant, or optimised (Eq. 13).")
    ] = "optimised",
    law: Annotated[
        str, typer.Option("--law", help="qp (limits as constraints), or paper (Eq. 7, scaled).")
    ] = "qp",
    weighting: Annotated[
        str, typer.Option("--weighting", help="W of Eq. 12: identity, or gradient.")
    ] = "identity",
    speed_profile: Annotated[
        str, typer.Option("--speed-profile", help="Field beside the line: constant, or paper.")
    ] = "constant",
    dt: Annotated[float, typer.Option("--dt", metavar="S", help="Control step.")] = 0.002,
    plan: Annotated[
        Path | None,
        typer.Option("--plan", metavar="FILE", help="Hit as planned by `plan --out FILE`."),
    ] = None,
    q0: Annotated[
        str | None, typer.Option("--q0", metavar="Q1,Q2,...", help="Start configuration.")
    ] = None,
    start: Annotated[
        str | None, typer.Option("--start", metavar="X,Y,Z", help="Start of the contact point.")
    ] = None,
    torque_limits: TorquesOption = False,
    out: OutOption = None,
    plot: PlotOption = None,
    seed: SeedOption = 0,
    as_json: JsonOption = False,
) -> None:
    """Roll a hit out: field, desired inertia, limits, impact (Eq. 5-7, 12-13).

    Without --plan, --q0 or --start it plans the configuration, the start and the run-up first.
    """
    from hitjoints.hitting.hit import Hit
    from hitjoints.hitting.rollout import rollout as roll
    from hitjoints.loading import load_robot
    from hitjoints.maps.files import DATASET_ENDINGS
    from hitjoints.robot import Contact

    check_outputs(plot, (out, "out", DATASET_ENDINGS))
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
        "joint": arm.hitting_joints[-2:][0],
    }
    chosen = {key: _one(key, asked[key], planned.get(key), usual[key]) for key in usual}
    check_mass(chosen["mass"])
    contact = arm.contact(Contact(chosen["joint"], triple(contact_offset, "contact-offset")))
    hit = Hit(contact, chosen["position"], chosen["direction"], chosen["mass"], flux)
    result = roll(
        arm,
        hit,
        q0=None if q0 is None else numbers(q0),
        start=None if start is None else triple(start, "start"),
        q_hit=planned.get("q"),
        dt=dt,
        reference=reference,  # type: ignore[arg-type]  # unknown names are refused there
        law=law,  # type: ignore[arg-type]
        weighting=weighting,  # type: ignore[arg-type]
        speed_profile=speed_profile,  # type: ignore[arg-type]
        torque_limits=torque_limits,
        seed=seed,
    )
    _write(result, out, plot)
    if as_json:
        asked = {
            "robot": robot,
            "joint": contact.joint,
            "flux": flux,
            "torque_limits": torque_limits,
        }
        print_json(asked | result.as_dict())
    else:
        _print(result)
    for path in (out, plot):
        if path is not None:
            complain("written", str(path))
    if result.reason:
        complain("no", result.reason)
        raise typer.Exit(3)


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


def _write(result: Rollout, out: Path | None, plot: Path | None) -> None:
    if out is not None:
        from hitjoints.hitting.record import flattened
        from hitjoints.maps.files import write_dataset

        dataset = result.dataset
        write_dataset(flattened(dataset) if out.suffix == ".csv" else dataset, out)
    if plot is not None:
        from hitjoints.show.figures import save_figure
        from hitjoints.show.rollout import draw_rollout

        save_figure(draw_rollout(result), plot)


def _print(result: Rollout) -> None:
    impact, hit = result.impact, result.hit
    rows: list[tuple[object, ...]] = []
    if impact is not None:
        rows = [
            ("time", impact.time, "s"),
            ("position", impact.position, "m"),
            ("miss", 1e3 * impact.miss, "mm"),
            ("direction error", impact.direction_error, "deg"),
            ("inertia", impact.inertia, "kg"),
            ("desired inertia", impact.desired_inertia, "kg"),
            ("speed", impact.speed, "m/s"),
            (f"flux, {hit.flux:g} m/s desired", impact.flux, "m/s"),
            ("q", impact.q, "rad"),
        ]
    times = result.as_dict()["step_time_us"]
    rows += [
        ("steps", f"{result.steps}, {result.saturated_steps} of them saturated", ""),
        ("fastest joint, of its limit", result.velocity_ratio_max, ""),
        ("greatest torque, of its limit", result.torque_ratio_max, ""),
        ("time of a control step", f"{times['median']:.0f}, 99 %: {times['p99']:.0f}", "us"),
    ]
    joint = result.robot.contact(hit.contact).joint
    at = ", ".join(f"{v:g}" for v in hit.position)
    along = ", ".join(f"{v:.4g}" for v in hit.direction)
    title = f"{result.robot.title}: joint {joint} hits {hit.mass:g} kg at ({at}) m along ({along})"
    print_table(title, ("at the impact", "value", "unit"), rows)
