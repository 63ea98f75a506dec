"""What became of a wish: the joint, the motion, where the object ends, and a verdict."""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace
from typing import TYPE_CHECKING, Any, ClassVar, Literal

from hitjoints.datasets.describe import versions
from hitjoints.plotted import Plotted
from hitjoints.told import Told
from hitjoints.version import __version__

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike

    from hitjoints.answers.nearest import Nearest
    from hitjoints.evidence.physics.simulated_hit import Simulation
    from hitjoints.goals.landing import Landing
    from hitjoints.hit import Hit
    from hitjoints.model.robot import Robot
    from hitjoints.planning.plan_record import Plan
    from hitjoints.swings.swing_record import Swing

Verdict = Literal["sendable", "not sendable", "no"]


@dataclass(frozen=True, eq=False, repr=False)
class Answer(Told, Plotted):
    """What became of a wish.

    Attributes:
        robot: the arm.
        hit: what was asked.
        verdict: "sendable", "not sendable" for a motion a controller would refuse, or "no".
        reason: why it is not sendable, or why not at all.
        plan: every joint that was tried, for the first hit.
        swing: the first motion.
        landing: where the object comes to rest after it; None where friction or restitution is not
            told.
        nearest: what can be had instead of a no.
        simulated: the first motion in the physics engine; None where that was not asked.
        hits: the answers of a sequence, hit by hit, where one may be made of several.
    """

    drawn_by: ClassVar[str] = "answer"

    robot: Robot
    hit: Hit
    verdict: Verdict
    reason: str
    plan: Plan
    swing: Swing | None = None
    landing: Landing | None = None
    nearest: Nearest | None = None
    simulated: Simulation | None = None
    hits: tuple[Answer, ...] | None = None

    @property
    def arrives(self) -> float | None:
        """The share that arrives: within the tolerance of its goal, hit after hit."""
        share = 1.0
        for one in self.hits or (self,):
            if one.landing is None:
                return None
            share *= one.landing.within
        return share

    @property
    def words(self) -> str:
        """The verdict in a line a person can act on."""
        if self.swing is None:
            instead = "" if self.nearest is None else f"; instead: {self.nearest.words}"
            return f"no: {self.reason}{instead}"
        if self.hits is not None and len(self.hits) > 1:
            told = [f"hit {k}: {one.words}" for k, one in enumerate(self.hits, 1)]
            share = "" if self.arrives is None else f"; {100 * self.arrives:.0f} of 100 arrive"
            return f"{len(self.hits)} hits{share}; " + "; ".join(told)
        parts = [f"joint {self.swing.hit.chosen_contact.joint}", f"flux {self.swing.flux:.3g} m/s"]
        if self.landing is not None:
            x, y = self.landing.mean[:2]
            parts.append(
                f"the object stops at ({x:.3f}, {y:.3f}) m, within {self.landing.tolerance:g} m "
                f"of the goal in {100 * self.landing.within:.0f} of 100"
            )
        parts.append(f"torques up to {self.swing.torque_ratio_max:.2f} of the limits")
        return "; ".join([*parts, self.verdict + (f": {self.reason}" if self.reason else "")])

    def lines(self) -> list[tuple[str, object]]:
        """Return what of it counts."""
        names = ("verdict", "reason", "nearest", "joint", "direction", "flux", "object_speed")
        said = self.as_dict()
        told = [(name, said[name]) for name in (*names, "arrives")]
        parts = {"landing": self.landing, "swing": self.swing, "simulated": self.simulated}
        return told + [(name, value and value.words) for name, value in parts.items()]

    def left(self, position: ArrayLike, yaw: float = 0.0) -> Hit:
        """Return what is left to ask for, once the first hit was made.

        Args:
            position: (3,) m, where the object really is now.
            yaw: rad, how it is turned against the direction to the goal, to the left.

        Raises:
            InputError: there is nothing left, such as for a wish without a goal.
        """
        now = self.hit.setting.q0 if self.swing is None else self.swing.joints.q[-1].tolist()
        setting = replace(
            self.hit.setting,
            hits=max(self.hit.setting.hits - 1, 1),
            q0=None if now is None else tuple(now),
        )
        return self.hit.changed(position=position, yaw=yaw, setting=setting)

    def as_dict(self, *files: Sequence[Any]) -> dict[str, Any]:
        """Return the result as JSON knows it.

        Args:
            files: paths of what was written of the motion of each hit.
        """
        swung, best, nearest = self.swing, self.plan.best, self.nearest
        flux = None if swung is None else swung.flux
        speed = None
        if flux is not None and self.hit.restitution is not None:
            speed = (1 + self.hit.restitution) * flux
        written = {"files": [str(path) for path in next(iter(files), ())]}
        hits = None
        if self.hits is not None:
            hits = [one.as_dict(*files[k : k + 1]) for k, one in enumerate(self.hits)]
        return {
            "version": __version__,
            "made_with": versions(),
            "hit": self.hit.as_dict(),
            "verdict": self.verdict,
            "reason": self.reason,
            "nearest": None if nearest is None else nearest.as_dict(),
            "joint": None if swung is None else swung.hit.chosen_contact.joint,
            "direction": (self.hit if swung is None else swung.hit).direction.tolist(),
            "flux": flux,
            "object_speed": speed,
            "landing": None if self.landing is None else self.landing.as_dict(),
            "arrives": self.arrives,
            "plan": None if best is None else best.as_dict(),
            "candidates": [one.as_dict() for one in self.plan.candidates],
            "swing": None if swung is None else swung.as_dict() | written,
            "simulated": None if self.simulated is None else _told(self.simulated),
            "hits": hits,
        }


def _told(simulated: Simulation) -> dict[str, Any]:
    """Return what the engine says, and what was predicted of the same hit."""
    rest = simulated.rest
    return simulated.simulated | {
        "rest": None if rest is None else rest.as_dict(),
        "predicted": asdict(simulated.predicted),
        "errors": simulated.errors,
    }
