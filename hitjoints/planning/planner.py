"""Which joint hits, in which configuration (Eq. 8, 14 and the objectives built on them)."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import singledispatch
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from hitjoints.datasets.describe import origin
from hitjoints.datasets.files import write_whole
from hitjoints.errors import InfeasibleError, InputError, UnknownNameError
from hitjoints.hit import Hit as Wish
from hitjoints.hit import check_flux
from hitjoints.hit_setting import HitSetting, RobotChoice
from hitjoints.impact.collision import required_speed
from hitjoints.loading.catalogue import robot_names
from hitjoints.model.robot import Contact
from hitjoints.planning.candidates import Candidate, plain
from hitjoints.planning.joint_plan import plan_joint
from hitjoints.planning.objectives.hit_problem import OBJECTIVES, Hit
from hitjoints.planning.room.surroundings import Surroundings
from hitjoints.planning.start import Start, fastest_start, plan_start
from hitjoints.planning.torque_cost import TorqueCost, torque_cost
from hitjoints.vectors import points, unit

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from hitjoints.model.robot import Robot

    Array = NDArray[np.float64]

RANKED_BY = {
    "inertia": "inertia",
    "flux": "flux",
    "straight-flux": "straight_flux",
    "rebound": "inertia",
}
"""The quantity that tells which joint is best: least rebound for a given flux is most inertia."""


@dataclass(frozen=True, eq=False)
class Plan:
    """The answer: one candidate per joint, and the best of them.

    Attributes:
        robot: name.
        hit: that was asked for, with how it was planned.
        best: None if no joint can do it.
        candidates: in the order of the joints asked for.
        digest: of the robot: whatever has the same gives the same numbers.
        made_with: versions of hitjoints and of what its numbers depend on.
        start: of the best hit, if it was asked for.
        torque_costs: of every candidate that can do it, if torque limits were asked for.
    """

    robot: str
    hit: Wish
    best: Candidate | None
    candidates: tuple[Candidate, ...]
    digest: str
    made_with: str
    start: Start | None = None
    torque_costs: tuple[TorqueCost, ...] = ()

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
    def summary(self) -> str:
        """The paper's question answered in one line, the joints that can do it first."""
        parts = [
            f"joint {one.joint}: {one.inertia:.1f} kg, {one.speed:.2f} m/s"
            if one.feasible
            else f"joint {one.joint}: infeasible here because {one.reason}"
            for one in sorted(self.candidates, key=lambda one: not one.feasible)
        ]
        return "; ".join(parts)

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
            "flux": self.flux,
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
        choice = self.hit.setting.robot
        if choice is None:
            raise InputError("robot", self.robot, "the plan does not say how to load it")
        return self.check_robot(choice.load())

    def check_robot(self, robot: Robot) -> Robot:
        """Return a robot that is the one the plan was made for.

        Raises:
            InputError: it is another.
        """
        if robot.digest != self.digest:
            same = "what was" if robot.name == self.robot else "the robot"
            expected = f"the plan is made for {self.robot}, and this is not {same} it was made for"
            raise InputError("robot", robot.name, expected)
        return robot

    @property
    def chosen_hit(self) -> Wish:
        """The hit with what is best to hit with.

        Raises:
            InfeasibleError: no joint can do it.
        """
        if self.best is None:
            raise InfeasibleError(f"the plan says no: {self.summary}")
        return self.hit.with_contact(Contact(self.best.joint, self.best.offset))

    def __eq__(self, other: object) -> bool:
        """Tell whether two plans say the same."""
        return isinstance(other, Plan) and self.as_dict() == other.as_dict()

    __hash__ = None  # type: ignore[assignment]


@singledispatch
def plan(
    robot: Robot,
    position: ArrayLike,
    direction: ArrayLike,
    mass: float,
    joints: Sequence[Contact | int] | None = None,
    objective: str = "inertia",
    flux: float | None = None,
    away: bool = True,
    seed: int = 0,
    certificate: bool = True,
    accept: Callable[[Array], bool] | None = None,
    surroundings: Surroundings | None = None,
    start: bool = False,
    hints: Mapping[int, ArrayLike] | None = None,
    torque_limits: bool = False,
) -> Plan:
    """Choose the joint and the configuration for a hit.

    Args:
        robot: the arm.
        position: (3,) m, of the object.
        direction: (3,), the hitting direction.
        mass: of the object, kg.
        joints: hitting joints (or contacts); the robot's own when not given.
        objective: "inertia" (Eq. 14), "flux" (Eq. 10 with the speed of Eq. 9), "straight-flux"
            (the same for motion exactly along the direction), or "rebound" (the least Eq. 11
            among the configurations that can reach `flux`: the greatest inertia among them).
        flux: m/s that the hit must be able to reach (Eq. 10); "rebound" needs one.
        away: demand h . (chi_{k+1} - chi_k) < 0 (Eq. 14), by a margin of 1e-6 m.
        seed: of the samples; the optimum does not depend on it.
        certificate: bound every candidate's inertia over the joints beyond the contact, and
            try to prove an infeasible joint infeasible.
        accept: asked of configurations (n,), best first; the first it returns True for is taken.
        surroundings: object, table and margin. The clearance of every candidate is reported, and
            with a margin configurations that do not keep it are passed over.
        hints: configurations (M, n) rad by joint to search from as well, with the contact at the
            object, such as `Feasibility.propose` gives; not used when there is a `flux`.
        start: plan the start of the best hit too: for `flux`, or the fastest there is.
        torque_limits: the start is one from rest, with the way that the motors need; and for every
            joint find what torque limits cost.

    Returns:
        A candidate per joint, feasible or with the reason why not, and the best.

    Raises:
        InputError: an argument cannot be used.
        SolverError: a configuration found failed the final check.
    """
    if objective not in OBJECTIVES:
        raise UnknownNameError("objective", objective, OBJECTIVES)
    if objective == "rebound" and flux is None:
        raise InputError("flux", flux, "rebound needs the flux to be reached (m/s)")
    if flux is not None:
        check_flux(flux)
    if not (math.isfinite(mass) and mass > 0):
        raise InputError("mass", mass, "an object weighs more than 0 kg")
    if seed < 0:
        raise InputError("seed", seed, "a seed is not negative")
    contacts = robot.contacts(joints)
    target, h = points(position, "position"), unit(direction)
    for name, vector in (("position", target), ("direction", h)):
        if vector.shape != (3,):
            raise InputError(name, f"shape {vector.shape}", "three numbers x,y,z")
    hits = [Hit(robot, contact, h, float(mass), target, away) for contact in contacts]
    found = []
    for hit in hits:
        demands = _demands(hit, accept, surroundings)
        near = None if hints is None else hints.get(hit.contact.joint)
        near = None if near is None else np.atleast_2d(robot.configuration(near, "hints"))
        one = plan_joint(hit, objective, flux, seed, certificate, demands, near)
        if one.q is not None and surroundings is not None:
            one = replace(one, clearance=surroundings.report(robot, one.q, hit.contact, h))
        found.append(replace(one, offset=hit.contact.offset))
    best, candidates = _compare(found, RANKED_BY[objective])
    begin = None
    if start and best is not None:
        chosen = next(hit for hit in hits if hit.contact.joint == best.joint)
        begin = _start(chosen, best, flux, torque_limits)
    costs = tuple(
        torque_cost(robot, one.q, hit.contact, h, mass)
        for one, hit in zip(candidates, hits, strict=True)
        if torque_limits and one.q is not None
    )
    around = Surroundings() if surroundings is None else surroundings
    alone, offsets = len(contacts) == 1, {contact.offset for contact in contacts}
    setting = HitSetting(
        RobotChoice(robot.name) if robot.name in robot_names() else None,
        None if alone else tuple(contact.joint for contact in contacts),
        next(iter(offsets)) if len(offsets) == 1 and not alone else (0.0, 0.0, 0.0),
        around.object_size,
        around.table_height,
        around.margin,
        objective,
        away,
        torque_limits,
        seed,
    )
    wish = Wish(contacts[0] if alone else None, target, h, float(mass), flux, setting=setting)
    made_with = str(origin(robot)["source"])
    return Plan(robot.name, wish, best, candidates, robot.digest, made_with, begin, costs)


@plan.register(Wish)
def plan_hit(  # type: ignore[misc]  # its first argument is another than that of plan
    hit: Wish, robot: Robot | None = None, certificate: bool = True
) -> Plan:
    """Choose the joint and the configuration for a hit that says all the rest itself.

    Args:
        hit: what is asked, with the arm and how to plan in its setting.
        robot: the arm, if it is loaded already.
        certificate: as `plan`.
    """
    setting = hit.setting
    if robot is None:
        if setting.robot is None:
            raise InputError("robot", None, "the hit does not say with which arm")
        robot = setting.robot.load()
    planned: Plan = plan(
        robot,
        hit.position,
        hit.direction,
        hit.mass,
        joints=hit.contacts(robot),
        objective=setting.objective,
        flux=hit.flux,
        away=setting.away,
        seed=setting.seed,
        certificate=certificate,
        surroundings=Surroundings.of(hit),
        start=True,
        torque_limits=setting.torque_limits,
    )
    return replace(planned, hit=hit)


def _demands(
    hit: Hit, accept: Callable[[Array], bool] | None, surroundings: Surroundings | None
) -> Callable[[Array], bool] | None:
    """Return what a configuration must satisfy beyond the planning problem, if anything."""
    if surroundings is None or surroundings.margin is None:
        return accept

    def both(q: Array) -> bool:
        room = surroundings.leave_room(hit.robot, q, hit.contact, hit.direction)
        return room and (accept is None or accept(q))

    return both


def _start(hit: Hit, best: Candidate, flux: float | None, torque_limits: bool) -> Start:
    """Return the start of the best hit."""
    assert best.q is not None
    assert best.inertia is not None
    if flux is None:
        return fastest_start(
            hit.robot, best.q, hit.contact, hit.direction, torque_limits=torque_limits
        )
    speed = required_speed(best.inertia, hit.mass, flux)
    return plan_start(
        hit.robot, best.q, hit.contact, hit.direction, speed, torque_limits=torque_limits
    )


def _compare(
    found: Sequence[Candidate], quantity: str
) -> tuple[Candidate | None, tuple[Candidate, ...]]:
    """Return the best candidate, and all with the reason why they are not it."""
    able = [one for one in found if one.feasible]
    if not able:
        return None, tuple(found)
    winner = max(able, key=lambda one: float(getattr(one, quantity)))
    most = float(getattr(winner, quantity))
    word = quantity.replace("_", " ")
    best: Candidate | None = None
    said = []
    for one in found:
        if one.feasible:
            less = 100 * (1.0 - float(getattr(one, quantity)) / most)
            reason = f"{less:.2g} % less {word} than joint {winner.joint}"
            if one is winner:
                reason = f"the most {word}" if len(found) > 1 else "the only joint asked for"
            said.append(replace(one, reason=reason))
        else:
            said.append(one)
        best = said[-1] if one is winner else best
    return best, tuple(said)
