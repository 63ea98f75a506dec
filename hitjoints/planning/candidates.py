"""What a plan says about one joint: the best configuration, or why there is none."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields
from typing import TYPE_CHECKING, Any, ClassVar, Literal

import numpy as np

from hitjoints.dynamics.inertia import inertia_along
from hitjoints.dynamics.kinematics import position
from hitjoints.errors import SolverError
from hitjoints.hitting.deliverable import deliverable_speed
from hitjoints.impact.collision import hitting_flux
from hitjoints.impact.composite import composite_inertia
from hitjoints.quantities import hitting_speed
from hitjoints.told import Told

if TYPE_CHECKING:
    from hitjoints.planning.search.found import Found
    from hitjoints.planning.task import Task
    from hitjoints.types import Array

NEAREST_POSITION = 1e-6  # m, what a plan promises


@dataclass(frozen=True, eq=False, repr=False)
class Candidate(Told):
    """A hitting joint that can do it, with everything about the hit.

    Attributes:
        joint: 1-based.
        feasible: True.
        reason: why it is best, or why another is better.
        q: (n,) rad within the limits.
        position_error: m, from the object.
        inertia: kg.
        speed: m/s, Eq. 9.
        straight_speed: m/s, of a motion straight along the direction.
        flux: m/s, Eq. 10 with the speed of Eq. 9.
        straight_flux: m/s, the same with the straight speed.
        deliverable_flux: m/s, the straight flux of a motion from rest to rest within the limits.
        deliverable_reason: why that is not known.
        away: h . (chi_{k+1} - chi_k) < 0 (Eq. 14).
        away_gap: m, that number.
        clearance: least distances (m) at q and on the straight approach, see `Clearance`.
        offset: (3,) m, of the contact in the joint's frame.
        links_inertia: kg, that of the links alone, where `inertia` is what elastic joints show at
            the best configuration of the links; else None.
        arrives: share of the objects that rest within the tolerance of the goal, where the plan
            was made by that.
        evidence: samples, admissible, local_optima, restarts, spread, agreeing, local,
            certificate.
    """

    joint: int
    feasible: Literal[True] = field(default=True, init=False)
    reason: str
    q: Array
    position_error: float | None
    inertia: float
    speed: float
    straight_speed: float
    flux: float
    straight_flux: float
    deliverable_flux: float | None
    deliverable_reason: str | None
    away: bool
    away_gap: float
    clearance: dict[str, Any] | None = None
    offset: tuple[float, float, float] = (0.0, 0.0, 0.0)
    links_inertia: float | None = None
    arrives: float | None = None
    evidence: dict[str, Any] = field(default_factory=dict, repr=False)

    @property
    def words(self) -> str:
        """What it can do, in a line."""
        return f"joint {self.joint}: {self.inertia:.4g} kg, {self.speed:.4g} m/s; {self.reason}"

    def as_dict(self) -> dict[str, Any]:
        """Return the attributes by name, arrays as lists."""
        return {item.name: plain(getattr(self, item.name)) for item in fields(self)}


@dataclass(frozen=True, eq=False, repr=False)
class Refusal(Told):
    """A hitting joint that cannot do it, with the reason. Quantities of a hit are None.

    Attributes:
        joint: 1-based.
        feasible: False.
        reason: why it cannot.
        position_error: m, the closest found, if that is what is in the way.
        offset: (3,) m, of the contact in the joint's frame.
        evidence: certified, and `nearest`, the nearest feasible value and where it is attained.
    """

    q: ClassVar[None] = None
    inertia: ClassVar[None] = None
    speed: ClassVar[None] = None
    straight_speed: ClassVar[None] = None
    flux: ClassVar[None] = None
    straight_flux: ClassVar[None] = None
    deliverable_flux: ClassVar[None] = None
    deliverable_reason: ClassVar[None] = None
    away: ClassVar[None] = None
    away_gap: ClassVar[None] = None
    clearance: ClassVar[None] = None
    links_inertia: ClassVar[None] = None
    arrives: ClassVar[None] = None

    joint: int
    feasible: Literal[False] = field(default=False, init=False)
    reason: str
    position_error: float | None = None
    offset: tuple[float, float, float] = (0.0, 0.0, 0.0)
    evidence: dict[str, Any] = field(default_factory=dict, repr=False)

    @property
    def words(self) -> str:
        """Why it cannot, in a line."""
        return f"joint {self.joint}: {self.reason}"

    def as_dict(self) -> dict[str, Any]:
        """Return the attributes by the names of a candidate's."""
        return {item.name: plain(getattr(self, item.name)) for item in fields(Candidate)}


Verdict = Candidate | Refusal


def plain(value: Any) -> Any:
    """Return a value as JSON knows it: arrays as lists, what is not finite as None."""
    if isinstance(value, dict):
        return {str(key): plain(item) for key, item in value.items()}
    listed = value.tolist() if hasattr(value, "tolist") else value
    if isinstance(listed, (list, tuple)):
        return [plain(item) for item in listed]
    return None if isinstance(listed, float) and not math.isfinite(listed) else listed


def away_gap(task: Task, q: Array) -> float:
    """Return h . (chi_{k+1} - chi_k), m."""
    origin = type(task.contact)(task.contact.joint)
    ends = position(task.robot, q, task.beyond) - position(task.robot, q, origin)
    return float(task.direction @ ends)


def measure(task: Task, q: Array) -> dict[str, Any]:
    """Return the quantities of a hit at one configuration, by Pinocchio and the certified programs.

    Raises:
        SolverError: the configuration does not do what was asked.
    """
    robot, h = task.robot, task.direction
    inertia = inertia_along(robot, q, task.contact, h)
    if task.hit.setting.drives.model == "composite":
        inertia = float(composite_inertia(robot, q[None], task.contact, h[None])[0])
    speed, straight = (hitting_speed(robot, q, task.contact, h, straight=s) for s in (False, True))
    straight = max(straight, 0.0)
    deliverable, unknown = None, None
    if robot.acceleration is None:
        unknown = f"the acceleration limits of {robot.name} are not known"
    else:
        fastest = deliverable_speed(robot, q, task.contact, h)
        deliverable = hitting_flux(inertia, task.mass, fastest)
    gap = away_gap(task, q)
    error = None
    if task.target is not None:
        error = float(np.linalg.norm(position(robot, q, task.contact) - task.target))
    outside = (q < robot.lower) | (q > robot.upper)
    if outside.any() or (error or 0.0) > NEAREST_POSITION or (task.away and gap >= 0):
        name = f"joint {task.contact.joint}"
        raise SolverError(f"{name}: the planned configuration is not admissible")
    return {
        "q": q,
        "position_error": error,
        "inertia": inertia,
        "speed": speed,
        "straight_speed": straight,
        "flux": hitting_flux(inertia, task.mass, speed),
        "straight_flux": hitting_flux(inertia, task.mass, straight),
        "deliverable_flux": deliverable,
        "deliverable_reason": unknown,
        "away": gap < 0,
        "away_gap": gap,
    }


def evidence_of(found: Found) -> dict[str, Any]:
    """Return how sure a search is."""
    best = np.exp(found.restarts)
    most = float(np.exp(found.value[0])) if found.value.size else 0.0
    return {
        "samples": found.samples,
        "admissible": found.admissible,
        "local_optima": found.local_optima,
        "restarts": best,
        "spread": found.spread if best.size else None,
        "agreeing": int((best >= most * (1 - 1e-4)).sum()),
        "local": found.local,
        "certificate": None,
    }
