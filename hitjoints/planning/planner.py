"""Which joint hits, in which configuration (Eq. 8, 14 and the objectives built on them)."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from hitjoints.counting import counted
from hitjoints.datasets.describe import origin
from hitjoints.errors import InfeasibleError, InputError
from hitjoints.first_argument import by_first_argument
from hitjoints.goals.landing import landing
from hitjoints.hit import Hit
from hitjoints.hit_checks import check_flux
from hitjoints.hit_setting import HitSetting, setting_of
from hitjoints.hitting.drive_limits import drive_limits
from hitjoints.impact.collision import required_speed
from hitjoints.impact.drives import RIGID, Drives
from hitjoints.model.robot import Contact
from hitjoints.planning.candidates import Candidate, Verdict
from hitjoints.planning.earlier_plan import planned_at
from hitjoints.planning.joint_plan import plan_joint
from hitjoints.planning.objectives.registry import objective_named
from hitjoints.planning.plan_record import Plan
from hitjoints.planning.real_arm import ranked_again
from hitjoints.planning.request import Request
from hitjoints.planning.room.margin_kept import MarginKept
from hitjoints.planning.room.surroundings import Surroundings
from hitjoints.planning.start import Start, fastest_start, plan_start
from hitjoints.planning.task import Task
from hitjoints.planning.torque_cost import torque_cost
from hitjoints.vectors import LARGEST_SEED, points, positive_mass, unit, whole

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from hitjoints.model.robot import Robot
    from hitjoints.types import Array


@by_first_argument
def plan(  # noqa: PLR0913
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
    deliverable: bool = False,
    drives: Drives = RIGID,
    near: Plan | None = None,
    arrives: Callable[[Candidate], float] | None = None,
) -> Plan:
    """Choose the joint and the configuration for a hit.

    Args:
        robot: the arm.
        position: (3,) m, of the object.
        direction: (3,), the hitting direction.
        mass: of the object, kg.
        joints: hitting joints (or contacts); the robot's own when not given.
        objective: "inertia" (Eq. 14), "flux" (Eq. 10 with the speed of Eq. 9), "straight-flux"
            (the same for motion exactly along the direction), "deliverable" (the same for a motion
            that comes from rest and stops within the arm's limits), "rebound" (the least Eq. 11
            among the configurations that can reach `flux`: the greatest inertia among them), or
            "landing" (the greatest share of objects that arrive at a hit's goal).
        flux: m/s that the hit must be able to reach (Eq. 10); "rebound" needs one.
        deliverable: `flux` has to be deliverable in the sense above; the arm's acceleration limits
            have to be known.
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
        drives: model of the arm's drives: the inertia, and what follows from it, is then what the
            arm shows in a hit. "rotor" is planned for exactly, "composite" without a certificate;
            by "elastic" each joint's best configuration of the links alone is ranked again.
        arrives: returns the share of objects that arrive, for "landing".
        torque_limits: the start is one from rest, with the way that the motors need; and for every
            joint find what torque limits cost.
        near: a plan of the same arm for a hit that was little different: in milliseconds each of
            its candidates is led to the nearest optimum. Others may be better by now, so that
            `evidence["local"]` is true; a joint with nothing there is planned anew.

    Returns:
        A candidate per joint, feasible or with the reason why not, and the best.

    Raises:
        InputError: an argument cannot be used, or acceleration limits are needed and not known.
        SolverError: a configuration found failed the final check.
    """
    wanted = objective_named(objective)
    digest, robot = robot.digest, drives.arm(robot)
    if wanted.needs_flux and flux is None:
        raise InputError("flux", flux, f"{objective} needs the flux to be reached (m/s)")
    if wanted.needs_goal and arrives is None:
        raise InputError("objective", objective, "a hit with a goal is needed (`hj.Hit`)")
    if flux is not None:
        check_flux(flux)
    mass = positive_mass(mass)
    seed = whole(seed, "seed", 0, LARGEST_SEED)
    contacts = robot.contacts(joints)
    target, h = points(position, "position"), unit(direction)
    for name, vector in (("position", target), ("direction", h)):
        if vector.shape != (3,):
            raise InputError(name, f"shape {vector.shape}", "three numbers x,y,z")
    along = np.asarray(direction, dtype=float)  # normalised once, by the hit
    by = HitSetting(drives=drives)
    tasks = [Task(robot, Hit(c, target, along, mass, setting=by), target, away) for c in contacts]
    request = Request(wanted, flux, deliverable and flux is not None, seed, certificate)
    if wanted.stopping or request.deliverable:
        drive_limits(robot)  # are they known?
    found = []
    for task in counted(tasks, "joints"):
        hinted = None if hints is None else hints.get(task.contact.joint)
        hinted = None if hinted is None else np.atleast_2d(robot.configuration(hinted, "hints"))
        demands = accept
        if surroundings is not None and surroundings.margin is not None:
            demands = MarginKept(task, surroundings, accept)
        known = None if near is None else planned_at(near, task, digest)
        one = plan_joint(task, replace(request, accept=demands, hints=hinted, near=known))
        if one.q is not None and surroundings is not None:
            one = replace(one, clearance=surroundings.report(robot, one.q, task.contact, h))
        if one.feasible and drives.model == "elastic":
            one = ranked_again(task, one)
        if one.feasible and arrives is not None:
            one = replace(one, arrives=arrives(replace(one, offset=task.contact.offset)))
        found.append(replace(one, offset=task.contact.offset))
    best, candidates = _compare(found, wanted.ranked_by)
    begin = None
    if start and best is not None:
        chosen = next(task for task in tasks if _is_of(task, best))
        begin = _start(chosen, best, flux, torque_limits)
    costs = tuple(
        torque_cost(robot, one.q, task.contact, h, mass)
        for one, task in zip(candidates, tasks, strict=True)
        if torque_limits and one.q is not None
    )
    alone = contacts[0] if len(contacts) == 1 else None
    named = None if joints is None or alone is not None else contacts
    around = surroundings or Surroundings()
    setting = replace(
        setting_of(robot, named),
        object_size=around.object_size,
        table_height=around.table_height,
        margin=around.margin,
        objective=objective,
        deliverable=request.deliverable if flux is not None else None,
        away=away,
        torque_limits=torque_limits,
        seed=seed,
        drives=drives,
    )
    return Plan(
        robot.name,
        Hit(alone, target, h, float(mass), flux, setting=setting),
        best,
        candidates,
        digest,
        str(origin(robot)["source"]),
        begin,
        costs,
        request.deliverable,
    )


@plan.register(Hit)
def plan_hit(
    hit: Hit, robot: Robot | None = None, certificate: bool = True, near: Plan | None = None
) -> Plan:
    """Choose the joint and the configuration for a hit that says all the rest itself.

    Args:
        hit: what is asked, with the arm and how to plan in its setting.
        robot: the arm, if it is loaded already.
        certificate: as `plan`.
        near: as `plan`.
    """
    setting = hit.setting
    robot = setting.arm(robot)
    asked, drives = setting.deliverable, setting.drives
    if hit.restitution is not None:
        drives = replace(drives, restitution=hit.restitution)
    needs_goal = objective_named(setting.objective).needs_goal
    if needs_goal and hit.goal is None:
        raise InputError("objective", setting.objective, "it needs a goal")
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
        near=near,
        surroundings=Surroundings.of(hit),
        start=True,
        torque_limits=setting.torque_limits,
        deliverable=robot.acceleration is not None if asked is None else asked,
        drives=drives,
        arrives=partial(_arriving, robot, hit) if needs_goal else None,
    )
    return replace(planned, hit=hit.made_by(robot))


def _arriving(robot: Robot, hit: Hit, one: Candidate) -> float:
    """Return the share of objects that arrive when a candidate hits as hard as it should."""
    chosen = hit.with_contact(Contact(one.joint, one.offset))
    speed = required_speed(one.inertia, hit.mass, hit.desired_flux)
    try:
        return landing(robot, one.q, chosen, speed, seed=hit.setting.seed).within
    except InfeasibleError:  # none of them simply slides
        return 0.0


def _start(task: Task, best: Candidate, flux: float | None, torque_limits: bool) -> Start:
    """Return the start of the best hit."""
    if flux is None:
        return fastest_start(
            task.robot, best.q, task.contact, task.direction, torque_limits=torque_limits
        )
    speed = required_speed(best.inertia, task.mass, flux)
    return plan_start(
        task.robot, best.q, task.contact, task.direction, speed, torque_limits=torque_limits
    )


def _compare(
    found: Sequence[Verdict], quantity: str
) -> tuple[Candidate | None, tuple[Verdict, ...]]:
    """Return the best candidate, and all with the reason why they are not it."""
    able = [one for one in found if one.feasible]
    if not able:
        return None, tuple(found)
    winner = max(able, key=lambda one: float(getattr(one, quantity)))
    most = float(getattr(winner, quantity))
    word = quantity.replace("_", " ")
    praise = f"the most {word}" if len(found) > 1 else "the only joint asked for"
    best = replace(winner, reason=praise)
    said: list[Verdict] = []
    for one in found:
        if one is winner:
            said.append(best)
        elif one.feasible:
            less = 100 * (1.0 - float(getattr(one, quantity)) / most) if most > 0 else 0.0
            said.append(replace(one, reason=f"{less:.2g} % less {word} than joint {winner.joint}"))
        else:
            said.append(one)
    return best, tuple(said)


def _is_of(task: Task, one: Verdict) -> bool:
    return (task.contact.joint, task.contact.offset) == (one.joint, one.offset)
