"""Where a motion starts from: as planned, or from a configuration or a point."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

import typer

from .option_groups import OptionGroup
from .options import SeedOption, numbers, triple

if TYPE_CHECKING:
    from hitjoints.hit import Hit
    from hitjoints.model.robot import Robot
    from hitjoints.planning.plan_record import Plan


@dataclass(frozen=True)
class StartOptions(OptionGroup):
    """The start, and the plan that it may come from."""

    panel: ClassVar[str] = "The start"

    plan: Annotated[
        Path | None,
        typer.Option("--plan", metavar="FILE", help="Hit as planned by `plan --out FILE`."),
    ] = None
    q0: Annotated[
        str | None, typer.Option("--q0", metavar="Q1,Q2,...", help="Start configuration.")
    ] = None
    start: Annotated[
        str | None, typer.Option("--start", metavar="X,Y,Z", help="Start of the contact point.")
    ] = None
    torque_limits: Annotated[
        bool,
        typer.Option(
            "--torque-limits", help="Keep the effort limits too: start at rest, speed up."
        ),
    ] = False
    seed: SeedOption = 0

    def planned(self) -> Plan | None:
        """Return the plan, if one is given.

        Raises:
            InputError: the file cannot be read, or is no plan.
            InfeasibleError: the plan says that no joint can do it.
        """
        if self.plan is None:
            return None
        from hitjoints.planning.plan_file import load_plan

        plan = load_plan(self.plan)
        assert plan.chosen_hit
        return plan

    def arguments(self, plan: Plan | None, hit: Hit, robot: Robot) -> dict[str, Any]:
        """Return the arguments of a motion for its start.

        Args:
            plan: that the motion carries out.
            hit: that the motion makes.
            robot: the arm.

        Raises:
            InputError: a value cannot be used, or the plan is for another arm or joint.
        """
        from hitjoints.errors import InputError

        if plan is not None:
            plan.check_robot(robot)
            if hit.contact != plan.chosen_hit.contact:
                joint, planned = hit.chosen_contact.joint, plan.chosen_hit.chosen_contact.joint
                raise InputError("joint", joint, f"the plan is for {planned}, with its offset")
        return {
            "q0": None if self.q0 is None else numbers(self.q0),
            "start": None if self.start is None else triple(self.start, "start"),
            "q_hit": hit.setting.q_hit if plan is None or plan.best is None else plan.best.q,
            "torque_limits": self.torque_limits,
            "seed": self.seed,
        }
