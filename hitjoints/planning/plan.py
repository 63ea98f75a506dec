"""Which joint hits, in which configuration (Eq. 8, 14 and the objectives built on them)."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from hitjoints.dynamics.impact import required_speed
from hitjoints.errors import InputError, UnknownNameError
from hitjoints.planning import infeasible
from hitjoints.planning.candidates import Candidate, evidence_of, measure, plain
from hitjoints.planning.certificate import certify
from hitjoints.planning.objectives import OBJECTIVES, Hit, HitProblem
from hitjoints.planning.sampler import Sampler
from hitjoints.planning.search import Found, search
from hitjoints.planning.start import Start, fastest_start, plan_start
from hitjoints.planning.surroundings import Surroundings
from hitjoints.quantities import place_joint
from hitjoints.vectors import points, unit

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from hitjoints.robot import Contact, Robot

    Array = NDArray[np.float64]

RANKED_BY = {
    "inertia": "inertia",
    "flux": "flux",
    "straight-flux": "straight_flux",
    "rebound": "inertia",
}
"""The quantity that tells which joint is best: least rebound for a given flux is most inertia."""

MOST_ASKED = 2000
"""Configurations shown to `accept` per joint before giving up."""


@dataclass(frozen=True, eq=False)
class Plan:
    """The answer: one candidate per joint, and the best of them.

    Attributes:
        robot: name.
        position: (3,) m. direction: (3,) unit. mass: kg.
        objective: what is best. flux: m/s demanded, if any.
        best: None if no joint can do it.
        candidates: in the order of the joints asked for.
        start: of the best hit, if it was asked for.
    """

    robot: str
    position: Array
    direction: Array
    mass: float
    objective: str
    flux: float | None
    best: Candidate | None
    candidates: tuple[Candidate, ...]
    start: Start | None = None

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
            "position": plain(self.position),
            "direction": plain(self.direction),
            "mass": self.mass,
            "objective": self.objective,
            "required_flux": self.flux,
            "feasible": self.best is not None,
            "summary": self.summary,
            "best": None if self.best is None else self.best.as_dict(),
            "candidates": [one.as_dict() for one in self.candidates],
            "start": None if self.start is None else self.start.as_dict(),
        }


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
        certificate: bound every candidate's inertia over the joints beyond the contact.
        accept: asked of configurations (n,), best first; the first it returns True for is taken.
        surroundings: object, table and margin. The clearance of every candidate is reported, and
            with a margin configurations that do not keep it are passed over.
        start: plan the start of the best hit too: for `flux`, or the fastest there is.

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
    if flux is not None and not (math.isfinite(flux) and flux > 0):
        raise InputError("flux", flux, "a flux to be reached is above 0 m/s")
    if not (math.isfinite(mass) and mass > 0):
        raise InputError("mass", mass, "an object weighs more than 0 kg")
    if seed < 0:
        raise InputError("seed", seed, "a seed is not negative")
    contacts = [robot.contact(k) for k in (robot.hitting_joints if joints is None else joints)]
    if not contacts or len(set(contacts)) < len(contacts):
        raise InputError("joint", [c.joint for c in contacts], "at least one, each once")
    target, h = points(position, "position"), unit(direction)
    for name, vector in (("position", target), ("direction", h)):
        if vector.shape != (3,):
            raise InputError(name, f"shape {vector.shape}", "three numbers x,y,z")
    hits = [Hit(robot, contact, h, float(mass), target, away) for contact in contacts]
    found = []
    for hit in hits:
        demands = _demands(hit, accept, surroundings)
        one = _plan_joint(hit, objective, flux, seed, certificate, demands)
        if one.q is not None and surroundings is not None:
            room = surroundings.clearance(robot, one.q, hit.contact, h)
            one = replace(one, clearance=room.as_dict())
        found.append(one)
    best, candidates = _compare(found, RANKED_BY[objective])
    begin = None
    if start and best is not None:
        chosen = next(hit for hit in hits if hit.contact.joint == best.joint)
        begin = _start(chosen, best, flux)
    return Plan(robot.name, target, h, float(mass), objective, flux, best, candidates, begin)


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


def _start(hit: Hit, best: Candidate, flux: float | None) -> Start:
    """Return the start of the best hit."""
    assert best.q is not None
    assert best.inertia is not None
    if flux is None:
        return fastest_start(hit.robot, best.q, hit.contact, hit.direction)
    speed = required_speed(best.inertia, hit.mass, flux)
    return plan_start(hit.robot, best.q, hit.contact, hit.direction, speed)


def _plan_joint(
    hit: Hit,
    objective: str,
    flux: float | None,
    seed: int,
    certificate: bool,
    accept: Callable[[Array], bool] | None,
) -> Candidate:
    assert hit.position is not None
    if not infeasible.movers(hit):
        return infeasible.fixed(hit)
    probe = place_joint(hit.robot, hit.contact, np.tile(hit.position, (64, 1)), seed)
    if not probe.solved.any():
        return infeasible.unreachable(hit, probe)
    sampler = Sampler(hit, hit.robot.lower, hit.robot.upper)
    problem = HitProblem(hit, "inertia" if objective == "rebound" else objective, flux=flux)
    if flux is None:
        found = search(problem, sampler, seed)
        refusal = None
    else:
        found, refusal = _search_with_flux(hit, problem, sampler, seed)
    if refusal is None and not found.value.size:
        found, refusal = _second_try(hit, problem, sampler, seed, probe.q[probe.solved])
    if refusal is not None:
        return refusal
    q = _accepted(found, problem.n, accept)
    if q is None:
        reason = (
            f"none of the {min(MOST_ASKED, len(found.x) + len(found.screened))} best "
            f"configurations of joint {hit.contact.joint} is accepted"
        )
        return Candidate(hit.contact.joint, False, reason, evidence=evidence_of(found))
    evidence = evidence_of(found)
    if certificate and accept is None:
        evidence["certificate"] = certify(hit, q).as_dict()
    return Candidate(hit.contact.joint, True, "", **measure(hit, q), evidence=evidence)


def _search_with_flux(
    hit: Hit, problem: HitProblem, sampler: Sampler, seed: int
) -> tuple[Found, Candidate | None]:
    """Search where a flux is reached, from where most is: random samples seldom reach it."""
    assert problem.flux is not None
    hardest = search(HitProblem(hit, "flux"), sampler, seed)
    if not hardest.value.size:
        return hardest, None
    enough = hardest.x[np.exp(hardest.value) > problem.flux]
    if not len(enough):
        return hardest, infeasible.short_of_flux(hit, problem.flux, hardest)
    return search(problem, sampler, seed, enough), None


def _second_try(
    hit: Hit, problem: HitProblem, sampler: Sampler, seed: int, placed: Array
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
            return pointing, infeasible.pointed_at(hit, pointing)
        found = search(problem, sampler, seed, pointing.x)
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
