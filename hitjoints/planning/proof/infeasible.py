"""Why a joint cannot do it, with the nearest value that it could."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from hitjoints.built import chain_of
from hitjoints.dynamics.kinematics import feasible_directions, position
from hitjoints.planning.candidates import Refusal, away_gap
from hitjoints.planning.objectives.problem_program import AWAY_MARGIN
from hitjoints.planning.proof.exclusion import exclude
from hitjoints.planning.words import told_apart, vector

if TYPE_CHECKING:
    from hitjoints.kernels import Placement
    from hitjoints.planning.search.found import Found
    from hitjoints.planning.task import Task
    from hitjoints.types import Array

MOST_COMPARED = 64
TOGETHER = 1e-9  # m: origins closer than this are one point


def unreachable(task: Task, placed: Placement, prove: bool) -> Refusal:
    """Say how close the contact gets to the object; prove it, if asked to and possible."""
    nearest = int(np.argmin(placed.error))
    error = float(placed.error[nearest])
    joint, target = task.contact.joint, task.target
    assert target is not None
    pivot, reach = reach_ball(task)
    away = float(np.linalg.norm(target - pivot))
    certified = away > reach
    where = f"({vector(target)})"
    found = f"the closest that {len(placed.q)} inverse kinematics searches found is {error:.4g} m"
    if certified:
        least, most = told_apart(reach, away)
        reason = (
            f"joint {joint} stays at least {away - reach:.4g} m away from {where} (certified: it "
            f"is {most} m from ({vector(pivot)}), from where the links reach {least} m); {found}"
        )
    else:
        reason = f"joint {joint} was not brought to {where}; {found} away"
        proof = exclude(task, away=False) if prove else None
        if proof is not None and proof.proved:
            certified = True
            reason = (
                f"joint {joint} does not get to {where} (certified: {proof.boxes} boxes, all of "
                f"its configurations, excluded); {found} away"
            )
    reason = f"unreachable: {reason}"
    return _refused(task, reason, certified, placed.q[nearest], position_error=error)


def movers(task: Task) -> int:
    """Return how many joints, from the base, move the contact."""
    chain = chain_of(task.robot)
    return chain.attach(task.contact.joint, task.contact.offset)[0]


def fixed(task: Task) -> Refusal:
    """Say that no joint moves the contact."""
    joint, q = task.contact.joint, task.robot.home
    assert task.target is not None
    here = position(task.robot, q, task.contact)
    reason = (
        f"infeasible direction: joint {joint} cannot move at all: no joint of the arm moves its "
        f"origin from ({vector(here)})"
    )
    error = float(np.linalg.norm(here - task.target))
    return _refused(task, reason, True, q, position_error=error)


def reach_ball(task: Task) -> tuple[Array, float]:
    """Return a fixed point (3,) and a distance (m) the contact never exceeds from it.

    The point is the first origin the arm turns about; the distance is the sum of the link lengths
    from there, with what prismatic joints add.
    """
    chain = chain_of(task.robot)
    last, point = chain.attach(task.contact.joint, task.contact.offset)
    reach = float(np.linalg.norm(point)) if last else 0.0
    for i in range(1, last):
        reach += float(np.linalg.norm(chain.links[i].translation))
    for link in chain.links[:last]:
        reach += max(abs(link.lower), abs(link.upper)) if link.prismatic else 0.0
    return np.array(chain.base_position), reach


def immobile(task: Task, q: Array) -> Refusal:
    """Say which directions the contact can be hit along, where it can be placed at all.

    Where it moves along the direction asked for, that is not what is in the way.
    """
    directions = feasible_directions(task.robot, q, task.contact)
    basis = directions.basis
    along = basis @ (basis.T @ task.direction)
    length = float(np.linalg.norm(along))
    nearest = None if length < 1e-6 else along / length
    hint = "" if nearest is None else f"; the nearest direction it can is ({vector(nearest)})"
    if directions.contain(task.direction):
        reason = (
            f"not found: joint {task.contact.joint} can be placed at the object and move along "
            f"({vector(task.direction)}) there, but no configuration that was tried meets all "
            f"conditions"
        )
        return _refused(task, reason, False, q, rank=directions.rank)
    reason = (
        f"infeasible direction: joint {task.contact.joint} cannot move along "
        f"({vector(task.direction)}) there: its Jacobian has rank {directions.rank}, "
        f"it moves in {directions.description}{hint}"
    )
    return _refused(task, reason, False, q, direction=nearest, rank=directions.rank)


def pointed_at(task: Task, found: Found, placed: Array, prove: bool) -> Refusal:
    """Say how far the distal links are from pointing away, at best.

    Args:
        task: what is asked.
        found: the search for the least h . (chi_{k+1} - chi_k).
        placed: (N, n) rad, configurations with the contact at the object.
        prove: try to exclude every configuration by branch and bound.
    """
    joint = task.contact.joint
    known = np.concatenate((found.x, placed))
    gaps = [away_gap(task, q) for q in known[: len(found.x) + MOST_COMPARED]]
    nearest = int(np.argmin(gaps))
    q, gap = known[nearest], gaps[nearest]
    beyond = task.beyond
    next_origin = beyond.joint > joint and not any(beyond.offset)
    following = f"joint {beyond.joint}" if next_origin else "the flange"
    certified = abs(gap) < TOGETHER and _share_origin(task)
    if certified:
        why = f"the origins of joint {joint} and {following} coincide, so no link points away"
    else:
        least = (
            f"the least found is {gap:.4g} m ahead, by {found.samples} configurations and "
            f"{found.restarts.size} independent searches"
        )
        why = f"{following} was not found behind joint {joint} along the direction: {least}"
        proof = exclude(task, away=True) if prove else None
        if proof is not None and proof.proved:
            certified = True
            why = (
                f"{following} is never behind joint {joint} along the direction (certified: "
                f"{proof.boxes} boxes, all of its configurations, excluded); {least}"
            )
    return _refused(task, f"away condition impossible: {why}", certified, q, away_gap=gap)


def short_of_flux(task: Task, flux: float, found: Found, deliverable: bool) -> Refusal:
    """Say what the greatest flux is."""
    most = float(np.exp(found.value[0]))
    reached, asked = told_apart(most, flux)
    verb = "delivers" if deliverable else "reaches"
    how = ", from rest to rest within its limits" if deliverable else ""
    reason = (
        f"flux beyond the maximum: joint {task.contact.joint} {verb} {reached} m/s of the "
        f"{asked} m/s asked for{how}"
    )
    return _refused(task, reason, False, found.x[0], flux=most)


def _share_origin(task: Task) -> bool:
    chain = chain_of(task.robot)
    ends = [
        chain.attach(c.joint, c.offset)
        for c in (type(task.contact)(task.contact.joint), task.beyond)
    ]
    return ends[0][0] == ends[1][0] and bool(
        np.allclose(ends[0][1], ends[1][1], rtol=0, atol=TOGETHER)
    )


def _refused(task: Task, reason: str, certified: bool, q: Array, **nearest: Any) -> Refusal:
    evidence = {"certified": certified, "nearest": {**nearest, "q": q}}
    return Refusal(
        task.contact.joint,
        reason,
        position_error=nearest.get("position_error"),
        evidence=evidence,
    )


def points_away(found: Found) -> bool:
    """Tell whether a search for the least h . (chi_{k+1} - chi_k) met the away condition."""
    return bool(found.value.size) and bool(-found.value[0] <= -AWAY_MARGIN)
