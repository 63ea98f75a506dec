"""`hitjoints plan`: which joint hits, in which configuration, and how sure that is."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

import typer

from .complaints import complain
from .completion import objectives
from .figure_options import FigureOptions
from .hit_options import HitOptions
from .impact_options import ImpactOptions
from .option_groups import OptionGroup, without
from .options import (
    JsonOption,
    SeedOption,
    TorquesOption,
    check_outputs,
    triple,
)
from .output_options import tell_written
from .render import print_json, print_table, say
from .robot_options import RobotOptions

if TYPE_CHECKING:
    from collections.abc import Sequence

    from hitjoints.model.robot import Robot
    from hitjoints.planning.candidates import Candidate, Verdict
    from hitjoints.planning.plan_record import Plan
    from hitjoints.planning.start import Start
    from hitjoints.planning.torque_cost import TorqueCost


FLUX_BY = ("deliverable", "speed")
COLUMNS = (
    *("hit with", "inertia", "speed", "straight", "flux", "straight", "deliverable"),
    *("optimum", "verdict"),
)


@dataclass(frozen=True)
class AimOptions(OptionGroup):
    """What is best, and how it is searched for."""

    panel: ClassVar[str] = "The aim"

    objective: Annotated[
        str,
        typer.Option(
            "--objective",
            help="inertia, flux, straight-flux, deliverable, rebound with --flux, "
            "or landing with --goal.",
            autocompletion=objectives,
        ),
    ] = "inertia"
    flux_by: Annotated[
        str | None,
        typer.Option(
            "--flux-by",
            metavar="deliverable|speed",
            help="What --flux has to be within: what a motion from rest to rest can deliver, "
            "where the arm's acceleration limits are known, or the speed of Eq. 9.",
        ),
    ] = None
    away: Annotated[
        bool, typer.Option("--away/--no-away", help="Demand the away condition of Eq. 14.")
    ] = True
    certificate: Annotated[
        bool,
        typer.Option(
            "--certificate/--no-certificate", help="Bound the inertia by branch and bound."
        ),
    ] = True
    torque_limits: TorquesOption = False
    seed: SeedOption = 0

    def deliverable(self, arm: Robot) -> bool:
        """Tell whether a flux has to be deliverable.

        Raises:
            UnknownNameError: `--flux-by` is neither of its values.
        """
        from hitjoints.errors import UnknownNameError

        if self.flux_by not in (None, *FLUX_BY):
            raise UnknownNameError("flux_by", self.flux_by, FLUX_BY)
        if self.flux_by is None:
            return arm.acceleration is not None
        return self.flux_by == "deliverable"

    def setting(self) -> dict[str, Any]:
        """Return what a hit keeps of it."""
        names = ("objective", "away", "torque_limits", "seed")
        return {name: getattr(self, name) for name in names}


@dataclass(frozen=True)
class RoomOptions(OptionGroup):
    """What stands around the hit."""

    panel: ClassVar[str] = "The surroundings"

    object_size: Annotated[
        str | None,
        typer.Option("--object-size", metavar="X,Y,Z", help="Edges of the object, a box (m)."),
    ] = None
    table_height: Annotated[
        float | None,
        typer.Option("--table-height", metavar="M", help="Height of the table's plane (m)."),
    ] = None
    margin: Annotated[
        float | None,
        typer.Option(
            "--margin", metavar="M", help="Distance to keep from object, table and itself (m)."
        ),
    ] = None

    def setting(self) -> dict[str, Any]:
        """Return what a hit keeps of it.

        Raises:
            InputError: a value cannot be used.
        """
        size = None if self.object_size is None else triple(self.object_size, "object_size")
        return {
            "object_size": size,
            "table_height": self.table_height,
            "margin": self.margin,
        }


@dataclass(frozen=True)
class PlanOutputs(FigureOptions):
    """The plan, a figure, JSON instead of a table."""

    out: Annotated[
        Path | None, typer.Option("--out", metavar="FILE", help="Write the plan: .json.")
    ] = None
    as_json: JsonOption = False


def plan(
    robot: RobotOptions,
    hit: Annotated[HitOptions, without("restitution")],
    aim: AimOptions,
    room: RoomOptions,
    impact: ImpactOptions,
    output: PlanOutputs,
) -> None:
    """Choose the joint to hit with and its configuration, with evidence (Eq. 8, 14).

    With --impact by the inertia that a real arm shows: rotor is planned for exactly, composite
    without a certificate; by elastic each joint's best configuration of the links is ranked again.
    """
    from hitjoints.planning.planner import plan_hit
    from hitjoints.show import figures

    asked = hit.read(restitution=impact.restitution)
    check_outputs(output.plot, (output.out, "out", (".json",)), inputs=[robot.robot, hit.file])
    output.check_look()
    arm = robot.load()
    setting = aim.setting() | room.setting() | {"deliverable": aim.deliverable(arm)}
    setting |= impact.setting()
    wanted = asked.hit(arm, robot=robot.choice, **setting)
    planned = plan_hit(wanted, arm, aim.certificate)
    result = planned.as_dict() | {"robot": robot.robot}
    plot = None if planned.best is None else output.plot
    if output.out is not None:
        planned.save(output.out)
    if planned.best is not None:
        output.save(figures.plan, planned, arm)
    if output.as_json:
        print_json(result)
    else:
        _print(arm.title, planned)
    tell_written(output.out, plot)
    if planned.best is None:
        reasons = "; ".join(one.reason for one in planned.candidates)
        complain("no", f"no joint can do it: {reasons}")
        raise typer.Exit(3)


def _print(title: str, planned: Plan) -> None:
    at = ", ".join(f"{v:g}" for v in planned.position)
    along = ", ".join(f"{v:g}" for v in planned.direction)
    flux = "" if planned.flux is None else f" for a flux of {planned.flux:g} m/s"
    if planned.deliverable:
        flux = f" for a deliverable flux of {planned.flux:g} m/s"
    if planned.impact != "rigid":
        flux += f", inertia by the model {planned.impact}"
    print_table(
        f"{title}: hit {planned.mass:g} kg at ({at}) m along ({along}), {planned.objective}{flux}",
        (
            "hit with",
            "inertia",
            "speed",
            "straight",
            "flux",
            "straight",
            "deliverable",
            "optimum",
            "verdict",
        ),
        [_row(one, one is planned.best) for one in planned.candidates],
        caption="kg and m/s; straight: moving along the direction only; deliverable: the same from "
        "rest to rest within the arm's limits; optimum: proved over the "
        "joints beyond the contact, and found by so many of the independent searches",
    )
    say(planned.summary)
    if planned.best is not None:
        say("q = " + ",".join(f"{v:.6g}" for v in planned.best.as_dict()["q"]))
        _print_room(planned.best)
    if planned.start is not None:
        _print_start(planned.start)
    if planned.torque_costs:
        _print_torque_costs(planned.torque_costs)


def _print_room(best: Candidate) -> None:
    assert best.clearance is not None, "every candidate of a plan has one"
    if reason := best.clearance.get("not_known"):
        say(f"clearance not known: {reason}")
        return
    near = [
        f"{best.clearance[name]:.3f} m from {name} ({' - '.join(pair)})"
        for name, pair in best.clearance["closest"].items()
    ]
    say(f"clearance, {best.clearance['approach']:.2g} m of approach included: {'; '.join(near)}")


def _print_start(start: Start) -> None:
    at = ", ".join(f"{v:.3f}" for v in start.position)
    verdict = "" if start.feasible else f"; not feasible: {start.reason}"
    say(
        f"start: {start.run_up:.3f} m behind at ({at}) m for {start.speed:.3g} m/s{verdict}\n"
        "q0 = " + ",".join(f"{v:.6g}" for v in start.q)
    )


def _print_torque_costs(costs: Sequence[TorqueCost]) -> None:
    print_table(
        "flux at these configurations",
        ("hit with", "straight maximum", "reached", "with torque limits", "cost"),
        [
            (f"joint {one.joint}", one.straight_flux, one.flux_without, one.flux_with, _share(one))
            for one in costs
        ],
        caption="m/s; reached: by the controller, from rest, without and with torque limits",
    )


def _share(one: TorqueCost) -> str | None:
    """Return what torque limits take of the flux reached without them."""
    if one.flux_without is None or one.flux_with is None:
        return None
    cost = round(100 * (1 - one.flux_with / one.flux_without), 1)
    return f"{cost + 0.0:.1f} %"  # a cost of -0.0 is none


def _row(one: Verdict, best: bool) -> list[object]:
    from hitjoints.planning.words import at_most

    name = f"joint {one.joint}"
    if not one.feasible:
        return [name, *[""] * 7, f"no: {one.reason.partition(':')[0]}"]
    evidence: dict[str, Any] = one.evidence
    certificate = evidence["certificate"]
    proof = "" if certificate is None else f"{100 * max(certificate['gap'], 1e-4):.2g} %, "
    sure = f"{proof}{evidence['agreeing']}/{len(evidence['restarts'])}"
    verdict = f"best: {one.reason}" if best else one.reason
    numbers = (one.inertia, one.speed, one.straight_speed, one.flux, one.straight_flux)
    known = "" if one.deliverable_flux is None else at_most(one.deliverable_flux)
    return [name, *(at_most(value) for value in numbers), known, sure, verdict]
