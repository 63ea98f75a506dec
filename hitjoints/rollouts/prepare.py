"""What a rollout starts from: the configuration that hits, and the start of the run-up."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from hitjoints.dynamics.contact_point import ContactPoint
from hitjoints.errors import InfeasibleError, InputError
from hitjoints.impact.drives import RIGID
from hitjoints.impact.shown_inertia import shown_inertia
from hitjoints.planning.planner import plan
from hitjoints.planning.start import plan_start
from hitjoints.programs.joint_velocity import WITHIN_REACH
from hitjoints.quantities import hitting_speed, place_joint
from hitjoints.tolerances import exceeds, told_apart
from hitjoints.vectors import points

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from hitjoints.hit import Hit
    from hitjoints.model.robot import Contact, Robot
    from hitjoints.planning.start import Start
    from hitjoints.types import Array

TRIES = 12
"""Configurations whose run-up is looked at, best first."""
AT_THE_OBJECT = 1e-4
"""m, how far from the object a given hitting configuration may hold the contact."""


class Preparation(NamedTuple):
    """The start q0 (n,) rad, and the hitting configuration q_hit (n,) rad it belongs to."""

    q0: Array
    q_hit: Array


def prepare(  # noqa: PLR0913
    robot: Robot,
    hit: Hit,
    *,
    q0: ArrayLike | None = None,
    start: ArrayLike | None = None,
    q_hit: ArrayLike | None = None,
    run_up: float | None = None,
    torque_limits: bool = False,
    acceleration_limits: bool | ArrayLike = False,
    seed: int = 0,
) -> Preparation:
    """Find what is not given: a hitting configuration that has the flux, and a start behind it.

    Args:
        robot: the arm.
        hit: what is asked.
        q0: (n,) rad, where the motion starts.
        start: (3,) m, where the contact starts; not together with q0.
        q_hit: (n,) rad, the hitting configuration, such as a plan's.
        run_up: m, along the direction; what the field needs by default, and with torque limits
            the motors.
        torque_limits: a planned start has the way that the motors need to reach the speed.
        acceleration_limits: the same for these; see `Controller`.
        seed: of the samples.

    Raises:
        InputError: an argument cannot be used.
        InfeasibleError: the object is out of reach, the flux is beyond the maximum (which `data`
            holds as `maximum_flux`), or there is no run-up.
    """
    point = ContactPoint(robot, hit.chosen_contact)
    if q0 is not None:
        if start is not None:
            raise InputError("start", start, "give a start position or q0, not both")
        begin = robot.within_limits(q0, "q0")
        end = placed(robot, point.contact, hit.position, begin) if q_hit is None else q_hit
        return Preparation(_behind(point, hit, begin, "q0"), _at_object(point, hit, end))
    kept = {"torque_limits": torque_limits, "acceleration_limits": acceleration_limits}
    if q_hit is None:
        q_hit, found = _planned(point, hit, run_up, kept, seed)
        if start is None:
            return Preparation(found.q, q_hit)
    q_hit = _at_object(point, hit, q_hit)
    if start is not None:
        begin = placed(robot, point.contact, points(start, "start"), q_hit)
        return Preparation(_behind(point, hit, begin, "start"), q_hit)
    _refuse_flux(point, hit, q_hit)
    found = _start(point, hit, q_hit, run_up, kept)
    if not found.feasible:
        raise InfeasibleError(found.reason, {"run_up": found.run_up})
    return Preparation(found.q, q_hit)


def by_links(robot: Robot, hit: Hit, q: Array) -> Hit:
    """Return the hit as an arm of links makes it at q (n,) rad: with the speed that is asked for.

    A model of the drives shows another inertia, and makes the flux asked for of another speed.
    """
    if hit.setting.drives.rigid or hit.flux is None:
        return hit
    contact = robot.contact(hit.chosen_contact)
    speed = hit.speed(float(shown_inertia(robot, q[None], contact, hit)[0]))
    links = ContactPoint(robot, contact).inertia(q, hit.direction)
    alone = replace(hit.setting, drives=RIGID)
    return hit.with_flux(hit.flux_of(links, speed)).changed(setting=alone)


def _planned(
    point: ContactPoint, hit: Hit, run_up: float | None, kept: dict[str, Any], seed: int
) -> tuple[Array, Start]:
    """Return the hitting configuration of greatest straight flux that has a run-up, and that."""
    starts: list[Start] = []

    def has_run_up(q: Array) -> bool:
        if not starts:
            _refuse_flux(point, hit, q)  # the first is the best: none has more
        starts.append(_start(point, hit, q, run_up, kept))
        return starts[-1].feasible or len(starts) >= TRIES

    planned = plan(
        point.robot,
        hit.position,
        hit.direction,
        hit.mass,
        joints=[point.contact],
        objective="straight-flux",
        seed=seed,
        certificate=False,
        accept=has_run_up,
    )
    if starts and not starts[-1].feasible:
        reason = f"none of {len(starts)} configurations has a run-up: {starts[0].reason}"
        raise InfeasibleError(reason, {"run_up": starts[0].run_up})
    best = planned.best
    if best is None or best.q is None:
        raise InfeasibleError(planned.candidates[0].reason, {"joint": planned.candidates[0].joint})
    return best.q, starts[-1]


def _start(
    point: ContactPoint, hit: Hit, q: Array, run_up: float | None, kept: dict[str, Any]
) -> Start:
    robot, contact, h = point.robot, point.contact, hit.direction
    straight = hitting_speed(robot, q, contact, h, straight=True)
    # What the controller asks for too: at the very maximum round-off decides if there is a way.
    speed = min(hit.speed(point.inertia(q, h)), WITHIN_REACH * straight)
    return plan_start(robot, q, contact, h, speed, run_up=run_up, **kept)


def _refuse_flux(point: ContactPoint, hit: Hit, q: Array) -> None:
    robot, contact, h = point.robot, point.contact, hit.direction
    straight = hitting_speed(robot, q, contact, h, straight=True)
    most = hit.flux_of(point.inertia(q, h), straight)
    if exceeds(hit.desired_flux, most):
        wish, limit = told_apart(hit.desired_flux, most)
        raise InfeasibleError(
            f"a flux of {wish} m/s is beyond the maximum of {limit} m/s for motion "
            f"along the direction with joint {contact.joint} at the object",
            {"maximum_flux": most, "flux": hit.desired_flux},
        )


def placed(robot: Robot, contact: Contact, where: Array, near: ArrayLike) -> Array:
    """Return the configuration (n,) rad with the contact at `where` (3,) m, searched from `near`.

    Raises:
        InfeasibleError: out of reach.
    """
    found = place_joint(robot, contact, where, start=np.asarray(near))
    if not found.solved[0]:
        at = ", ".join(f"{v:g}" for v in where)
        raise InfeasibleError(
            f"({at}) m is out of reach: joint {contact.joint} comes no nearer than "
            f"{found.error[0]:.3g} m",
            {"joint": contact.joint, "nearest": float(found.error[0])},
        )
    return np.array(found.q[0])


def _at_object(point: ContactPoint, hit: Hit, q: ArrayLike) -> Array:
    q = point.robot.within_limits(q, "q_hit")
    error = float(np.linalg.norm(point.position(q) - hit.position))
    if error > AT_THE_OBJECT:
        raise InputError("q_hit", q.tolist(), f"it holds the contact {error:.3g} m off the object")
    return q


def _behind(point: ContactPoint, hit: Hit, q: Array, argument: str) -> Array:
    here = point.position(q)
    ahead = float(hit.direction @ (hit.position - here))
    if ahead <= 0:
        expected = f"the contact starts {-ahead:.3g} m beyond the object; it must start behind it"
        raise InputError(argument, [round(float(v), 6) for v in here], expected)
    return q
