"""One hit from a wish to a verdict: plan, swing, and where the object comes to rest."""

from __future__ import annotations

from dataclasses import dataclass, replace
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

from hitjoints.answers.answer_record import Answer
from hitjoints.answers.deliverable_map import along
from hitjoints.answers.nearest import Nearest, nearest_hit
from hitjoints.counting import counted
from hitjoints.errors import InfeasibleError
from hitjoints.evidence.physics.simulation import simulate
from hitjoints.goals.landing import LEVEL, Landing, landing
from hitjoints.model.robot import Contact
from hitjoints.planning.planner import plan_hit
from hitjoints.swings.make_swing import swing

if TYPE_CHECKING:
    from hitjoints.evidence.physics.simulated_hit import Simulation
    from hitjoints.hit import Hit
    from hitjoints.model.robot import Robot
    from hitjoints.planning.candidates import Candidate
    from hitjoints.planning.plan_record import Plan
    from hitjoints.swings.swing_record import Swing

BY_SHARE = "landing"
"""The objective by which the joint is chosen whose object most surely arrives."""


@dataclass(frozen=True)
class SingleHit:
    """Answers wishes by one hit.

    Attributes:
        robot: the arm.
        simulated: look at the motion in the physics engine; None for if that is installed.
        proved: bound what the planner found.
    """

    robot: Robot
    simulated: bool | None = None
    proved: bool = True

    def answer(self, hit: Hit) -> Answer:
        """Return the answer; of a no without what can be had instead.

        The joints are tried in the order of the flux they can deliver, until one has a motion; with
        the objective "landing" all of them, and the one is taken whose object most surely arrives.
        """
        planned = self.plan(hit)
        reasons = {one.joint: one.reason for one in planned.candidates if not one.feasible}
        found: list[tuple[Candidate, Swing, Landing | None]] = []
        for one in counted(self.able(planned), "motions"):
            chosen = hit.with_contact(Contact(one.joint, one.offset))
            try:
                made = self.swing(chosen, one)
                found.append((one, made, self._landing(chosen, made)))
            except InfeasibleError as error:
                reasons[one.joint] = error.reason
                continue
            if hit.setting.objective != BY_SHARE:
                break
        if not found:
            said = "; ".join(f"joint {joint}: {reason}" for joint, reason in reasons.items())
            return Answer(self.robot, hit, "no", said, planned)
        best, made, rest = max(found, key=lambda each: 0.0 if each[2] is None else each[2].within)
        chosen = hit.with_contact(Contact(best.joint, best.offset))
        verdict: Any = "sendable" if made.sendable else "not sendable"
        planned = replace(planned, best=best)
        told = self._simulation(chosen, made)
        return Answer(
            self.robot, chosen, verdict, made.why, planned, made, rest, simulated=told
        )  # fmt: skip

    def plan(self, hit: Hit) -> Plan:
        """Plan for what a motion from rest to rest can deliver, or by the share that arrives."""
        by_share = hit.setting.objective == BY_SHARE and hit.goal is not None
        objective, demanded = BY_SHARE if by_share else "deliverable", hit.flux is not None
        setting = replace(hit.setting, objective=objective, deliverable=demanded)
        return plan_hit(hit.changed(setting=setting), self.robot, certificate=self.proved)

    def able(self, planned: Plan) -> list[Candidate]:
        """Return the joints that limits allow, those first that deliver most."""
        able = [one for one in planned.candidates if one.feasible]
        return sorted(able, key=lambda one: -(one.deliverable_flux or 0.0))

    def swing(self, hit: Hit, one: Candidate) -> Swing:
        """Return a motion; errors as `swing`."""
        made: Swing = swing(self.robot, hit, q_hit=one.q)
        return made

    def nearest(self, answer: Answer) -> Nearest | None:
        """Return the most that one hit can do where the answer is no; None if nothing."""
        hit = answer.hit
        if hit.flux is None:
            return None
        able = self.able(answer.plan)
        if able:
            return self._slower(hit, able)
        best = self.plan(along(hit, hit.direction)).best
        if best is None or not best.deliverable_flux:
            return None
        return nearest_hit(hit, best.joint, best.inertia, best.deliverable_flux)

    def _slower(self, hit: Hit, able: list[Candidate]) -> Nearest | None:
        """Return the most that a motion delivers where limits allow more; None if none less."""
        found = None
        for one in able:
            chosen = hit.with_contact(Contact(one.joint, one.offset))
            try:
                made = self.swing(along(chosen, hit.direction), one)
            except InfeasibleError:
                continue
            if made.flux < hit.desired_flux and (found is None or made.flux > found.flux):
                found = nearest_hit(hit, one.joint, made.inertia, made.flux)
        return found

    def _landing(self, hit: Hit, made: Swing) -> Landing | None:
        if not _slides(hit):
            return None
        return landing(self.robot, made.q_hit, hit, made.speed, seed=hit.setting.seed)

    def _simulation(self, hit: Hit, made: Swing) -> Simulation | None:
        """Return the motion in the engine; None without the engine, unless it was asked for."""
        if self.simulated is False or (self.simulated is None and find_spec("mujoco") is None):
            return None
        return simulate(made, friction=hit.friction if _slides(hit) else 0.0)


def _slides(hit: Hit) -> bool:
    """Tell whether it is known how the object slides."""
    known = hit.friction is not None and hit.restitution is not None
    return known and abs(hit.direction[2]) <= LEVEL
