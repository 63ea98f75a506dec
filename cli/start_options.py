"""Where a motion starts from: as planned, or from a configuration or a point."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, ClassVar

import typer

from .option_groups import OptionGroup
from .options import SeedOption, numbers, triple


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

    def arguments(self, planned: dict[str, Any]) -> dict[str, Any]:
        """Return the arguments of `rollout` for its start.

        Raises:
            InputError: a value cannot be used.
        """
        return {
            "q0": None if self.q0 is None else numbers(self.q0),
            "start": None if self.start is None else triple(self.start, "start"),
            "q_hit": planned.get("q"),
            "torque_limits": self.torque_limits,
            "seed": self.seed,
        }

    def planned(self, robot: str, digest: str) -> dict[str, Any]:
        """Return what the plan says: position, directions, mass, joints, q; nothing without one.

        Args:
            robot: as it is asked for.
            digest: of the arm that was loaded.

        Raises:
            InputError: the file cannot be read, is no plan, or is one for another robot.
            InfeasibleError: the plan says that no joint can do it.
        """
        return {} if self.plan is None else _read_plan(self.plan, robot, digest)


def _read_plan(path: Path, robot: str, digest: str) -> dict[str, Any]:
    from hitjoints.errors import InfeasibleError, InputError

    try:
        plan = json.loads(path.read_text(encoding="utf-8"))
        best = plan["best"]
        found = {"position": plan["position"], "mass": plan["mass"]}
        found["directions"] = (plan["direction"],)
        if best is not None:
            found |= {"joints": (best["joint"],), "q": best["q"], "offset": best.get("offset")}
        made_for = plan["robot"]
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise InputError("plan", path, f"it is not a plan ({error})") from None
    if best is None:
        raise InfeasibleError(f"the plan {path} says no: {plan.get('summary', '')}")
    if made_for != robot:
        raise InputError("plan", path, f"it is made for {made_for}, not for {robot}")
    if plan.get("robot_digest", digest) != digest:
        wanted = f"it is made for another {robot}: with other numbers, tip, locked joints or tool"
        raise InputError("plan", path, wanted)
    return found
