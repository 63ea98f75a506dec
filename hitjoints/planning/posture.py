"""Eq. 14 alone: the posture of the joints beyond a joint that is already placed."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any

import numpy as np

from hitjoints.dynamics.kinematics import position
from hitjoints.errors import InfeasibleError
from hitjoints.hit import Hit
from hitjoints.model.robot import Contact
from hitjoints.planning.candidates import evidence_of, measure, plain
from hitjoints.planning.objectives.farthest_away import FarthestAway
from hitjoints.planning.objectives.hit_problem import HitProblem
from hitjoints.planning.objectives.most_inertia import MostInertia
from hitjoints.planning.proof import infeasible
from hitjoints.planning.proof.certificate import certify
from hitjoints.planning.search.groups import search
from hitjoints.planning.search.sampler import Sampler
from hitjoints.planning.task import Task
from hitjoints.told import Told

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from hitjoints.model.robot import Robot


@dataclass(frozen=True, eq=False, repr=False)
class Posture(Told):
    """The posture of greatest inertia for given q_1 .. q_{k-1}.

    Attributes:
        joint: k.
        q: (n,) rad within the limits; q_1 .. q_{k-1} as given.
        inertia: kg.
        away: h . (chi_{k+1} - chi_k) < 0.
        away_gap: m, that number.
        evidence: as of a plan's candidate; its certificate bounds the inertia from above.
    """

    joint: int
    q: NDArray[np.float64]
    inertia: float
    away: bool
    away_gap: float
    evidence: dict[str, Any]

    def as_dict(self) -> dict[str, Any]:
        """Return the attributes by name, arrays as lists."""
        return {item.name: plain(getattr(self, item.name)) for item in fields(self)}


def posture(
    robot: Robot,
    q: ArrayLike,
    joint: int,
    direction: ArrayLike,
    *,
    away: bool = True,
    seed: int = 0,
    certificate: bool = True,
) -> Posture:
    """Find the q_k .. q_n of greatest inertia at joint k, the other joints as given (Eq. 14).

    The maximum flux and the least rebound are attained there as well: the speed of joint k's
    origin does not depend on the joints from k on.

    Args:
        robot: the arm.
        q: (n,) rad within the limits; q_1 .. q_{k-1} are kept.
        joint: k.
        direction: (3,), the hitting direction.
        away: demand h . (chi_{k+1} - chi_k) < 0, by a margin of 1e-6 m.
        seed: of the samples; the optimum does not depend on it.
        certificate: bound the inertia from above by branch and bound.

    Raises:
        InputError: an argument cannot be used.
        InfeasibleError: no posture satisfies the away condition, or joint k cannot move along the
            direction.
    """
    contact = Contact(robot.contact(joint).joint)
    given = robot.within_limits(q)
    moving = np.arange(robot.n) >= contact.joint - 1
    lower, upper = np.where(moving, robot.lower, given), np.where(moving, robot.upper, given)
    hit = Hit(contact, position(robot, given, contact), np.asarray(direction, float), 1.0)
    task = Task(robot, hit, None, away)
    problem = HitProblem(task, MostInertia(), lower=lower, upper=upper)
    sampler = Sampler(task, lower, upper)
    found = search(problem, sampler, seed)
    if not found.value.size:
        if np.isnan(problem.screen(given[None])[0]).all():
            refusal = infeasible.immobile(task, given)
        else:
            pointing = search(
                HitProblem(task, FarthestAway(), lower=lower, upper=upper), sampler, seed
            )
            refusal = infeasible.pointed_at(task, pointing, given[None], prove=False)
        raise InfeasibleError(refusal.reason, {"joint": contact.joint, **refusal.evidence})
    chosen = np.array(found.x[0])
    chosen[contact.joint - 1 :] = robot.nearest_turn(chosen)[contact.joint - 1 :]
    measured = measure(task, chosen)
    evidence = evidence_of(found)
    if certificate:
        beyond = tuple(range(contact.joint, robot.n + 1))
        evidence["certificate"] = certify(task, chosen, beyond).as_dict()
    kept = {name: measured[name] for name in ("q", "inertia", "away", "away_gap")}
    return Posture(contact.joint, evidence=evidence, **kept)
