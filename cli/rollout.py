"""`hitjoints rollout`: move the arm through a hit and say what happens at the impact."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

import typer

from .complaints import complain
from .hit_options import HitOptions
from .option_groups import OptionGroup
from .options import AccelerationOption, for_joints
from .output_options import OutputOptions
from .render import print_json, print_table
from .robot_options import RobotOptions
from .start_options import StartOptions

if TYPE_CHECKING:
    from hitjoints.rollouts.record import Rollout


@dataclass(frozen=True)
class LawOptions(OptionGroup):
    """How the arm moves."""

    panel: ClassVar[str] = "The motion"

    reference: Annotated[
        str, typer.Option("--reference", help="Desired inertia: constant, or optimised (Eq. 13).")
    ] = "optimised"
    law: Annotated[
        str, typer.Option("--law", help="qp (limits as constraints), or paper (Eq. 7, scaled).")
    ] = "qp"
    weighting: Annotated[
        str, typer.Option("--weighting", help="W of Eq. 12: identity, or gradient.")
    ] = "identity"
    speed_profile: Annotated[
        str, typer.Option("--speed-profile", help="Field beside the line: constant, or paper.")
    ] = "constant"
    dt: Annotated[
        float, typer.Option("--dt", metavar="S", help="Control step, 2e-5 to 0.05 s.")
    ] = 0.002
    acceleration_limits: Annotated[
        bool,
        typer.Option(
            "--acceleration-limits", help="Keep acceleration limits too: start at rest, speed up."
        ),
    ] = False
    acceleration: AccelerationOption = None

    def arguments(self) -> dict[str, Any]:
        """Return the arguments of `rollout` for the motion; given limits are kept."""
        given = asdict(self)
        told = for_joints(given.pop("acceleration"))
        return given if told is None else given | {"acceleration_limits": told}


def rollout(
    robot: RobotOptions,
    hit: HitOptions,
    start: StartOptions,
    motion: LawOptions,
    output: OutputOptions,
) -> None:
    """Roll a hit out: field, desired inertia, limits, impact (Eq. 5-7, 12-13).

    Without --plan, --q0 or --start it plans the configuration, the start and the run-up first.
    """
    from hitjoints.rollouts.follow import rollout as roll
    from hitjoints.show import figures

    output.check(robot.robot, start.plan, hit.file)
    planned = start.planned()
    asked = hit.read(planned)
    arm = robot.load()
    wanted = asked.flux_hit(arm)
    result = roll(arm, wanted, **start.arguments(planned, wanted, arm), **motion.arguments())
    _write(result, output.out)
    output.save(figures.rollout, result)
    if output.as_json:
        said = {
            "robot": robot.robot,
            "joint": arm.contact(wanted.chosen_contact).joint,
            "flux": wanted.flux,
            "torque_limits": start.torque_limits,
            "acceleration_limits": result.parameters.get("acceleration_limits"),
        }
        print_json(said | result.as_dict())
    else:
        _print(result)
    output.tell()
    if not result.sendable:
        complain("warning", f"not sendable: {result.why}; `hitjoints swing` makes a motion that is")
    if result.reason:
        complain("no", result.reason)
        raise typer.Exit(3)


def _write(result: Rollout, out: Path | None) -> None:
    if out is not None:
        from hitjoints.datasets.files import write_dataset
        from hitjoints.rollouts.record import flattened

        dataset = result.dataset
        write_dataset(flattened(dataset) if out.suffix == ".csv" else dataset, out)


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
            (f"flux, {hit.desired_flux:g} m/s desired", impact.flux, "m/s"),
            ("q", impact.q, "rad"),
        ]
    times = result.as_dict()["step_time_us"]
    rows += [
        ("steps", f"{result.steps}, {result.saturated_steps} of them saturated", ""),
        ("fastest joint, of its limit", result.velocity_ratio_max, ""),
        ("greatest torque, of its limit", result.torque_ratio_max, ""),
        ("time of a control step", f"{times['median']:.0f}, 99 %: {times['p99']:.0f}", "us"),
    ]
    joint = result.robot.contact(hit.chosen_contact).joint
    title = f"{result.robot.title}: joint {joint} hits {hit.words}"
    print_table(title, ("at the impact", "value", "unit"), rows)
