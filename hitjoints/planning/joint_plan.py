"""The plan of one joint: search, look for what is in the way, prove."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from hitjoints.dynamics.kinematics import position
from hitjoints.kernels.ik import TOLERANCE
from hitjoints.planning.candidates import Candidate, Refusal, Verdict, evidence_of, measure
from hitjoints.planning.objectives.farthest_away import FarthestAway
from hitjoints.planning.objectives.freedom import blind_slack
from hitjoints.planning.objectives.hit_problem import FLUX_MARGIN, HitProblem
from hitjoints.planning.objectives.most_flux import MostDeliverable, MostFlux
from hitjoints.planning.objectives.most_inertia import MostInertia
from hitjoints.planning.proof import infeasible
from hitjoints.planning.proof.certificate import certify
from hitjoints.planning.search.climb import ON_MANIFOLD
from hitjoints.planning.search.found import Found
from hitjoints.planning.search.groups import dealt, search
from hitjoints.planning.search.nearby import search_near
from hitjoints.planning.search.sampler import Sampler
from hitjoints.quantities import place_joint

if TYPE_CHECKING:
    from hitjoints.kernels import Placement
    from hitjoints.planning.request import Request
    from hitjoints.planning.task import Task
    from hitjoints.types import Array

EQUAL = 1e-6
"""A flux beyond the maximum by no more than this share is the maximum: both are rounded."""

MOST_ASKED = 2000
"""Configurations shown to `accept` per joint before giving up."""


def plan_joint(task: Task, request: Request) -> Verdict:
    """Return the best configuration for a task, with evidence, or the reason why there is none.

    Raises:
        SolverError: a configuration found failed the final check.
    """
    assert task.target is not None
    if not infeasible.movers(task):
        return infeasible.fixed(task)
    if request.near is not None:
        close = _near(task, request)
        if close is not None:
            return close
    probe = place_joint(task.robot, task.contact, np.tile(task.target, (64, 1)), request.seed)
    placed = probe.q[probe.solved | (probe.error <= blind_slack(task.robot, task.contact))]
    if not len(placed):
        return infeasible.unreachable(task, probe, request.certificate)
    near = _within_reach(task, probe)
    sampler = Sampler(near, task.robot.lower, task.robot.upper)
    problem = HitProblem(
        near, request.objective, flux=request.flux, deliverable=request.deliverable
    )
    if request.flux is None:
        found = search(problem, sampler, request.seed, _admissible(problem, request.hints))
        refusal = None
    else:
        found, refusal = _search_with_flux(near, problem, sampler, request.seed)
    if refusal is None and not found.value.size:
        found, refusal = _second_try(problem, sampler, placed, request)
    if refusal is not None:
        return refusal
    q = _accepted(found, problem.n, request.accept)
    if q is None:
        reason = (
            f"none of the {min(MOST_ASKED, len(found.x) + len(found.screened))} best "
            f"configurations of joint {task.contact.joint} is accepted"
        )
        if said := getattr(request.accept, "reason", ""):
            reason = f"{reason}: {said}"
        return Refusal(task.contact.joint, reason, evidence=evidence_of(found))
    return _candidate(problem, found, q, request)


def _candidate(problem: HitProblem, found: Found, q: Array, request: Request) -> Candidate:
    """Return what a search found, measured and with its evidence."""
    task = problem.task
    if problem.room is None:  # else the turn tells how much room there is to stop
        q = task.robot.nearest_turn(q)
    evidence = evidence_of(found)
    if request.certificate and request.accept is None and not problem.locked:
        evidence["certificate"] = certify(task, q).as_dict()
    return Candidate(task.contact.joint, "", **measure(task, q), evidence=evidence)


def _near(task: Task, request: Request) -> Candidate | None:
    """Return the best near known configurations; None if there is nothing near them."""
    assert request.near is not None
    problem = HitProblem(
        task, request.objective, flux=request.flux, deliverable=request.deliverable
    )
    sampler = Sampler(task, task.robot.lower, task.robot.upper)
    found = search_near(problem, sampler, request.seed, request.near)
    q = _accepted(found, problem.n, request.accept) if found.value.size else None
    return None if q is None else _candidate(problem, found, q, request)


def _within_reach(task: Task, probe: Placement) -> Task:
    """Return the task at what can be met exactly.

    At the edge of reach an object may lie a hair's breadth beyond it: near enough for what inverse
    kinematics promises, but no search could keep to it.
    """
    nearest = int(np.argmin(probe.error))
    if not ON_MANIFOLD < probe.error[nearest] <= TOLERANCE:
        return task
    return replace(task, target=position(task.robot, probe.q[nearest], task.contact))


def _admissible(problem: HitProblem, hints: Array | None) -> list[Array]:
    """Return those of the hints (H, n) that a search may start from, dealt out to its groups."""
    if hints is None or not len(hints):
        return []
    return dealt(hints[problem.screen(hints)[1] == 0])


def _search_with_flux(
    task: Task, problem: HitProblem, sampler: Sampler, seed: int
) -> tuple[Found, Refusal | None]:
    """Search where a flux is reached, from where most is: random samples seldom reach it."""
    assert problem.flux is not None
    greatest = MostDeliverable() if problem.deliverable else MostFlux()
    hardest = search(HitProblem(task, greatest), sampler, seed)
    if not hardest.value.size:
        return hardest, None
    most = float(np.exp(hardest.value[0]))
    if problem.flux * (1 - EQUAL) > most:
        short = infeasible.short_of_flux(task, problem.flux, hardest, problem.deliverable)
        return hardest, short
    problem.flux = min(problem.flux, most * (1 - 4 * FLUX_MARGIN))
    able = [part[problem.screen(part)[1] == 0] for part in hardest.by_group]
    if not any(map(len, able)):
        able = [hardest.x[:1]]
    return search(problem, sampler, seed, able), None


def _second_try(
    problem: HitProblem, sampler: Sampler, placed: Array, request: Request
) -> tuple[Found, Refusal | None]:
    """Look for what stands in the way of a search that found nothing.

    Returns:
        A new search from where nothing does, or the reason why there is no such place.
    """
    task = problem.task
    free = HitProblem(replace(task, away=False), MostInertia())
    pointing = None
    if task.away and np.isfinite(free.screen(placed)[0]).any():
        pointing = search(HitProblem(task, FarthestAway()), sampler, request.seed)
        if not infeasible.points_away(pointing):
            no = infeasible.pointed_at(task, pointing, placed, request.certificate)
            return pointing, no
        found = search(problem, sampler, request.seed, pointing.by_group)
        if found.value.size:
            return found, None
    q = placed[0] if pointing is None else pointing.x[0]
    return Found.nothing(), infeasible.immobile(task, q)


def _accepted(found: Found, n: int, accept: Callable[[Array], bool] | None) -> Array | None:
    """Return the best configuration that is accepted: the optima first, then the samples."""
    if accept is None:
        return np.array(found.x[0, :n])
    for q in np.concatenate((found.x[:, :n], found.screened))[:MOST_ASKED]:
        if accept(np.array(q)):
            return np.array(q)
    return None
