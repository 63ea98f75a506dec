"""A plan: one candidate per joint, the best of them, and what they answer."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

from hitjoints.datasets.files import write_whole
from hitjoints.errors import InfeasibleError, InputError
from hitjoints.model.robot import Contact
from hitjoints.planning.candidates import Candidate, Verdict, plain
from hitjoints.planning.start import Start
from hitjoints.planning.torque_cost import TorqueCost
from hitjoints.plotted import Plotted
from hitjoints.told import Told

if TYPE_CHECKING:
    from hitjoints.hit import Hit
    from hitjoints.model.robot import Robot
    from hitjoints.types import Array


@dataclass(frozen=True, eq=False, repr=False)
class Plan(Told, Plotted):
    """The answer: one candidate per joint, and the best of them.

    Attributes:
        robot: name.
        hit: that was asked for, with how it was planned.
        deliverable: that flux is demanded of a motion from rest to rest; else of Eq. 9's speed.
        best: None if no joint can do it.
        candidates: in the order of the joints asked for.
        digest: of the robot: whatever has the same gives the same numbers.
        made_with: versions of hitjoints and of what its numbers depend on.
        start: of the best hit, if it was asked for.
        torque_costs: of every candidate that can do it, if torque limits were asked for.
    """

    drawn_by: ClassVar[str] = "plan"

    robot: str
    hit: Hit
    best: Candidate | None
    candidates: tuple[Verdict, ...]
    digest: str
    made_with: str
    start: Start | None = None
    torque_costs: tuple[TorqueCost, ...] = ()
    deliverable: bool = False

    @property
    def position(self) -> Array:
        """Where the object is, (3,) m."""
        return self.hit.position

    @property
    def direction(self) -> Array:
        """The hitting direction, (3,) unit."""
        return self.hit.direction

    @property
    def mass(self) -> float:
        """Of the object, kg."""
        return self.hit.mass

    @property
    def objective(self) -> str:
        """What is best."""
        return self.hit.setting.objective

    @property
    def flux(self) -> float | None:
        """The flux demanded, m/s, if any."""
        return self.hit.flux

    @property
    def impact(self) -> str:
        """The model of the arm's drives that inertia and flux are reckoned with."""
        return self.hit.setting.drives.model

    @property
    def summary(self) -> str:
        """The paper's question answered in one line, the joints that can do it first."""
        parts = [
            f"joint {one.joint}: {one.inertia:.1f} kg, {one.speed:.2f} m/s"
            if one.feasible
            else f"joint {one.joint}: infeasible here because {one.reason}"
            for one in sorted(self.candidates, key=lambda one: not one.feasible)
        ]
        return "; ".join(parts)

    @property
    def words(self) -> str:
        """The answer, in a line."""
        asked = f"{self.robot}, {self.objective}, {self.hit.words}"
        if self.best is None:
            return f"{asked}: no joint can do it"
        one = self.best
        return f"{asked}: joint {one.joint}, {one.inertia:.4g} kg, {one.speed:.4g} m/s"

    def lines(self) -> list[tuple[str, object]]:
        """Return what it says about each joint."""
        return [(f"joint {one.joint}", _in_short(one)) for one in self.candidates]

    @property
    def _flux_by(self) -> str:
        return "deliverable" if self.deliverable else "speed"

    def as_dict(self) -> dict[str, Any]:
        """Return the answer as JSON knows it."""
        return {
            "robot": self.robot,
            "digest": self.digest,
            "made_with": self.made_with,
            "hit": self.hit.as_dict(),
            "position": plain(self.position),
            "direction": plain(self.direction),
            "mass": self.mass,
            "objective": self.objective,
            "impact": self.impact,
            "flux": self.flux,
            "flux_by": None if self.flux is None else self._flux_by,
            "feasible": self.best is not None,
            "summary": self.summary,
            "best": None if self.best is None else self.best.as_dict(),
            "candidates": [one.as_dict() for one in self.candidates],
            "start": None if self.start is None else self.start.as_dict(),
            "torque_costs": [one.as_dict() for one in self.torque_costs],
        }

    def save(self, path: str | Path) -> None:
        """Write a file that `load_plan` reads, with paths relative to it.

        Raises:
            InputError: it cannot be written.
        """
        path = Path(path)
        told = self.as_dict() | {"hit": self.hit.seen_from(path.parent).as_dict()}
        text = json.dumps(told, allow_nan=False, indent=1) + "\n"
        write_whole(path, "out", lambda made: made.write_text(text, encoding="utf-8"))

    def load_robot(self) -> Robot:
        """Load the arm it was made for.

        Raises:
            InputError: the plan does not know where it is from, or it has changed since.
        """
        if self.hit.setting.robot is None:
            raise InputError("robot", self.robot, "the plan does not say how to load it")
        return self.check_robot(None)

    def check_robot(self, robot: Robot | None) -> Robot:
        """Return the arm that the plan was made for, with the limits that its hit tells.

        Args:
            robot: the arm as it is loaded, or so limited already; None to load it.

        Raises:
            InputError: it is another.
        """
        robot = self.hit.setting.arm(robot)
        if robot.digest != self.digest:
            same = "what was" if robot.name == self.robot else "the robot"
            expected = f"the plan is made for {self.robot}, and this is not {same} it was made for"
            raise InputError("robot", robot.name, expected)
        return robot

    @property
    def chosen_hit(self) -> Hit:
        """The hit with what is best to hit with.

        Raises:
            InfeasibleError: no joint can do it.
        """
        if self.best is None:
            raise InfeasibleError(f"the plan says no: {self.summary}")
        return self.hit.with_contact(Contact(self.best.joint, self.best.offset))

    def carried_out(self, robot: Robot | None = None) -> tuple[Robot, Hit, dict[str, Any]]:
        """Return what a motion that carries it out is made of.

        Args:
            robot: the arm, if it is loaded already.

        Returns:
            The arm, the hit with what is best to hit with, and `q_hit`, `q0` and `seed`.

        Raises:
            InputError: it cannot be loaded, or is another than the plan was made for.
            InfeasibleError: no joint can do it.
        """
        setting, hit = self.hit.setting, self.chosen_hit
        arm = self.load_robot() if robot is None else self.check_robot(robot)
        assert self.best is not None
        return arm, hit, {"q_hit": self.best.q, "q0": setting.q0, "seed": setting.seed}

    def __eq__(self, other: object) -> bool:
        """Tell whether two plans say the same."""
        return isinstance(other, Plan) and self.as_dict() == other.as_dict()

    __hash__ = None  # type: ignore[assignment]


def _in_short(one: Verdict) -> str:
    if not one.feasible:
        return f"no: {one.reason}"
    flux = one.flux if one.deliverable_flux is None else one.deliverable_flux
    kind = "flux" if one.deliverable_flux is None else "deliverable flux"
    return f"{one.inertia:.4g} kg, {one.speed:.4g} m/s, {kind} {flux:.4g} m/s; {one.reason}"
