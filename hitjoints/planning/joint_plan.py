"""The plan of one joint: search, look for what is in the way, prove."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from hitjoints.dynamics.kinematics import position
from hitjoints.kernels.ik import TOLERANCE
from hitjoints.planning.candidates import Candidate, evidence_of, measure
from hitjoints.planning.objectives.freedom import blind_slack
from hitjoints.planning.objectives.hit_problem import FLUX_MARGIN, Hit, HitProblem
from hitjoints.planning.proof import infeasible
from hitjoints.planning.proof.certificate import certify
from hitjoints.planning.search.climb import ON_MANIFOLD
from hitjoints.planning.search.groups import Found, dealt, search
from hitjoints.planning.search.sampler import Sampler
from hitjoints.quantities import place_joint

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from hitjoints.kernels import Placement

    Array = NDArray[np.float64]

EQUAL = 1e-6
"""A flux beyond the maximum by no more than this share is the maximum: both are rounded."""

MOST_ASKED = 2000
"""Configurations shown to `accept` per joint before giving up."""


def plan_joint(
    hit: Hit,
    objective: str,
    flux: float | None,
    seed: int,
    certificate: bool,
    accept: Callable[[Array], bool] | None,
    hints: Array | None = None,
) -> Candidate:
    """Return the best configuration for a hit, with evidence, or the reason why there is none.

    Arguments and errors as `plan`.
    """
    assert hit.position is not None
    if not infeasible.movers(hit):
        return infeasible.fixed(hit)
    probe = place_joint(hit.robot, hit.contact, np.tile(hit.position, (64, 1)), seed)
    placed = probe.q[probe.solved | (probe.error <= blind_slack(hit.robot, hit.contact))]
    if not len(placed):
        return infeasible.unreachable(hit, probe, certificate)
    asked, hit = hit, _within_reach(hit, probe)
    sampler = Sampler(hit, hit.robot.lower, hit.robot.upper)
    problem = HitProblem(hit, "inertia" if objective == "rebound" else objective, flux=flux)
    if flux is None:
        found = search(problem, sampler, seed, _admissible(problem, hints))
        refusal = None
    else:
        found, refusal = _search_with_flux(hit, problem, sampler, seed)
    if refusal is None and not found.value.size:
        found, refusal = _second_try(hit, problem, sampler, seed, placed, certificate)
    if refusal is not None:
        return refusal
    q = _accepted(found, problem.n, accept)
    if q is None:
        reason = (
            f"none of the {min(MOST_ASKED, len(found.x) + len(found.screened))} best "
            f"configurations of joint {hit.contact.joint} is accepted"
        )
        return Candidate(hit.contact.joint, False, reason, evidence=evidence_of(found))
    q = hit.robot.nearest_turn(q)
    evidence = evidence_of(found)
    if certificate and accept is None:
        evidence["certificate"] = certify(hit, q).as_dict()
    return Candidate(hit.contact.joint, True, "", **measure(asked, q), evidence=evidence)


def _within_reach(hit: Hit, probe: Placement) -> Hit:
    """Return the hit at what can be met exactly.

    At the edge of reach an object may lie a hair's breadth beyond it: near enough for what inverse
    kinematics promises, but no search could keep to it.
    """
    nearest = int(np.argmin(probe.error))
    if not ON_MANIFOLD < probe.error[nearest] <= TOLERANCE:
        return hit
    return replace(hit, position=position(hit.robot, probe.q[nearest], hit.contact))


def _admissible(problem: HitProblem, hints: Array | None) -> list[Array]:
    """Return those of the hints (H, n) that a search may start from, dealt out to its groups."""
    if hints is None or not len(hints):
        return []
    return dealt(hints[problem.screen(hints)[1] == 0])


def _search_with_flux(
    hit: Hit, problem: HitProblem, sampler: Sampler, seed: int
) -> tuple[Found, Candidate | None]:
    """Search where a flux is reached, from where most is: random samples seldom reach it."""
    assert problem.flux is not None
    hardest = search(HitProblem(hit, "flux"), sampler, seed)
    if not hardest.value.size:
        return hardest, None
    most = float(np.exp(hardest.value[0]))
    if problem.flux * (1 - EQUAL) > most:
        return hardest, infeasible.short_of_flux(hit, problem.flux, hardest)
    problem.flux = min(problem.flux, most * (1 - 4 * FLUX_MARGIN))
    able = [part[problem.screen(part)[1] == 0] for part in hardest.by_group]
    if not any(map(len, able)):
        able = [hardest.x[:1]]
    return search(problem, sampler, seed, able), None


def _second_try(
    hit: Hit, problem: HitProblem, sampler: Sampler, seed: int, placed: Array, prove: bool
) -> tuple[Found, Candidate | None]:
    """Look for what stands in the way of a search that found nothing.

    Returns:
        A new search from where nothing does, or the reason why there is no such place.
    """
    free = HitProblem(replace(hit, away=False), "inertia")
    pointing = None
    if hit.away and np.isfinite(free.screen(placed)[0]).any():
        pointing = search(HitProblem(hit, "away"), sampler, seed)
        if not infeasible.points_away(pointing):
            return pointing, infeasible.pointed_at(hit, pointing, placed, prove)
        found = search(problem, sampler, seed, pointing.by_group)
        if found.value.size:
            return found, None
    q = placed[0] if pointing is None else pointing.x[0]
    return Found.nothing(), infeasible.immobile(hit, q)


def _accepted(found: Found, n: int, accept: Callable[[Array], bool] | None) -> Array | None:
    """Return the best configuration that is accepted: the optima first, then the samples."""
    if accept is None:
        return np.array(found.x[0, :n])
    for q in np.concatenate((found.x[:, :n], found.screened))[:MOST_ASKED]:
        if accept(np.array(q)):
            return np.array(q)
    return None
