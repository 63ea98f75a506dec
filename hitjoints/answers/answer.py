"""From a wish to a verdict: plan, swing, and where the object comes to rest."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Literal

from hitjoints.answers.nearest import Nearest, nearest_hit
from hitjoints.errors import InfeasibleError, InputError
from hitjoints.goals.landing import LEVEL, TOLERANCE, Landing, landing
from hitjoints.model.robot import Contact
from hitjoints.planning.planner import plan_hit
from hitjoints.swings.make_swing import MARGIN, swing
from hitjoints.version import __version__

if TYPE_CHECKING:
    from collections.abc import Sequence

    from hitjoints.hit import Hit
    from hitjoints.model.robot import Robot
    from hitjoints.planning.candidates import Candidate
    from hitjoints.planning.plan_record import Plan
    from hitjoints.swings.swing_record import Swing

Verdict = Literal["sendable", "not sendable", "no"]


@dataclass(frozen=True, eq=False)
class Answer:
    """What became of a wish.

    Attributes:
        robot: the arm.
        hit: what was asked, with the contact that was chosen.
        verdict: "sendable", "not sendable" for a motion a controller would refuse, or "no".
        reason: why it is not sendable, or why not at all.
        plan: every joint that was tried.
        swing: the motion.
        landing: where the object comes to rest; None where friction or restitution is not told.
        nearest: what can be had instead of a no.
    """

    robot: Robot
    hit: Hit
    verdict: Verdict
    reason: str
    plan: Plan
    swing: Swing | None = None
    landing: Landing | None = None
    nearest: Nearest | None = None

    @property
    def words(self) -> str:
        """The verdict in a line a person can act on."""
        if self.swing is None:
            instead = "" if self.nearest is None else f"; instead: {self.nearest.words}"
            return f"no: {self.reason}{instead}"
        parts = [f"joint {self.swing.hit.chosen_contact.joint}", f"flux {self.swing.flux:.3g} m/s"]
        if self.landing is not None:
            x, y = self.landing.mean[:2]
            parts.append(
                f"the object stops at ({x:.3f}, {y:.3f}) m, within {self.landing.tolerance:g} m "
                f"of the goal in {100 * self.landing.within:.0f} of 100"
            )
        parts.append(f"torques up to {self.swing.torque_ratio_max:.2f} of the limits")
        return "; ".join([*parts, self.verdict + (f": {self.reason}" if self.reason else "")])

    def as_dict(self) -> dict[str, Any]:
        """Return the result as JSON knows it."""
        swung, best = self.swing, self.plan.best
        flux = None if swung is None else swung.flux
        speed = None
        if flux is not None and self.hit.restitution is not None:
            speed = (1 + self.hit.restitution) * flux
        return {
            "version": __version__,
            "hit": self.hit.as_dict(),
            "verdict": self.verdict,
            "reason": self.reason,
            "nearest": None if self.nearest is None else self.nearest.as_dict(),
            "joint": None if swung is None else swung.hit.chosen_contact.joint,
            "direction": self.hit.direction.tolist(),
            "flux": flux,
            "object_speed": speed,
            "landing": None if self.landing is None else self.landing.as_dict(),
            "plan": None if best is None else best.as_dict(),
            "candidates": [one.as_dict() for one in self.plan.candidates],
            "swing": None if swung is None else swung.as_dict(),
        }


def answer(hit: Hit, robot: Robot | None = None, *, tolerance: float = TOLERANCE) -> Answer:
    """Take a wish to its verdict: the joint, a motion that can be sent, where the object ends.

    The joints are tried in the order of the flux they can deliver from rest to rest, until one has
    a motion.

    Args:
        hit: what is wanted; its setting says with which arm and how.
        robot: the arm, if it is loaded already.
        tolerance: m, around the goal.

    Raises:
        InputError: an argument cannot be used, or the arm's acceleration limits are not known.
    """
    arm = _arm(hit) if robot is None else robot
    planned = _planned(arm, hit)
    able = [one for one in planned.candidates if one.feasible]
    reasons = [f"joint {one.joint}: {one.reason}" for one in planned.candidates if not one.feasible]
    for one in sorted(able, key=lambda one: -(one.deliverable_flux or 0.0)):
        chosen = hit.with_contact(Contact(one.joint, one.offset))
        try:
            made = _swing(arm, chosen, one)
        except InfeasibleError as error:
            reasons.append(f"joint {one.joint}: {error.reason}")
            continue
        verdict: Verdict = "sendable" if made.sendable else "not sendable"
        rest = _landing(arm, chosen, made, tolerance)
        return Answer(arm, chosen, verdict, made.why, replace(planned, best=one), made, rest)
    nearest = _slower(arm, hit, able) if able else _nearest(arm, hit)
    return Answer(arm, hit, "no", "; ".join(reasons), planned, nearest=nearest)


def _arm(hit: Hit) -> Robot:
    if hit.setting.robot is None:
        raise InputError("robot", None, "the hit does not say with which arm")
    return hit.setting.robot.load()


def _planned(arm: Robot, hit: Hit) -> Plan:
    """Plan for what a motion from rest to rest can deliver."""
    setting = replace(hit.setting, objective="deliverable", deliverable=hit.flux is not None)
    return plan_hit(hit.changed(setting=setting), arm)


def _swing(arm: Robot, hit: Hit, one: Candidate) -> Swing:
    setting = hit.setting
    return swing(
        arm,
        hit,
        q0=setting.q0,
        q_hit=one.q,
        table_height=setting.table_height,
        margin=MARGIN if setting.margin is None else setting.margin,
        seed=setting.seed,
        **({} if setting.dt is None else {"dt": setting.dt}),
    )


def _nearest(arm: Robot, hit: Hit) -> Nearest | None:
    """Return the most that can be had; None if the object cannot be hit at all."""
    if hit.flux is None:
        return None
    best = _planned(arm, _anyhow(hit)).best
    if best is None or not best.deliverable_flux:
        return None
    return nearest_hit(hit, best.joint, best.inertia, best.deliverable_flux)


def _slower(arm: Robot, hit: Hit, able: Sequence[Candidate]) -> Nearest | None:
    """Return the most that a motion delivers, where limits would allow more; None if none less."""
    if hit.flux is None:
        return None
    found = None
    for one in able:
        try:
            made = _swing(arm, _anyhow(hit).with_contact(Contact(one.joint, one.offset)), one)
        except InfeasibleError:
            continue
        if made.flux < hit.flux and (found is None or made.flux > found.flux):
            found = nearest_hit(hit, one.joint, made.inertia, made.flux)
    return found


def _anyhow(hit: Hit) -> Hit:
    """Return the same hit along its direction, however hard."""
    return hit.changed(goal=None, object_speed=None, flux=None, direction=hit.direction)


def _landing(arm: Robot, hit: Hit, made: Swing, tolerance: float) -> Landing | None:
    if hit.friction is None or hit.restitution is None or abs(hit.direction[2]) > LEVEL:
        return None
    return landing(arm, made.q_hit, hit, made.speed, tolerance=tolerance, seed=hit.setting.seed)
