"""Plans for an arm with drives: by the inertia that it shows in a hit, not that of its links.

With rotors coupled rigidly everything is exact, search and bounds included: their arm is planned
for. Locked joints and elastic ones have no kernels: the best configurations by the links alone are
ranked again by what they show.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from hitjoints.errors import UnknownNameError
from hitjoints.impact.elastic import elastic_impact
from hitjoints.impact.inertia_models import impact_inertia
from hitjoints.impact.rotor import with_rotors

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from hitjoints.model.robot import Robot
    from hitjoints.planning.candidates import Candidate
    from hitjoints.planning.task import Task

IMMOVABLE = 1e6
"""kg, for an object that is faster than any inertia makes it."""
MODELS = ("rigid", "rotor", "composite", "elastic")


@dataclass(frozen=True)
class Drives:
    """The model of the arm's drives that a plan reckons with.

    Args:
        model: "rigid", "rotor", "composite" or "elastic", see `impact_inertia` and
            `elastic_impact`.
        contact_time: s, elastic: of the rigid pair.
        restitution: elastic: from 0 to 1.
        stiffness: N m/rad, elastic: of the joints; None: the robot's, or 1e4.
        rotor_inertia: kg m^2, reflected; None: the robot's.

    Raises:
        UnknownNameError: no such model.
    """

    model: str = "rigid"
    contact_time: float = 0.01
    restitution: float = 0.5
    stiffness: ArrayLike | None = None
    rotor_inertia: ArrayLike | None = None

    def __post_init__(self) -> None:
        if self.model not in MODELS:
            raise UnknownNameError("impact", self.model, MODELS)

    @property
    def ranks_again(self) -> bool:
        """Whether candidates are ranked by what they show, being the best of the links alone."""
        return self.model in ("composite", "elastic")

    def arm(self, robot: Robot) -> Robot:
        """Return the arm to plan for.

        Raises:
            ModelError: the rotor inertia is not known.
        """
        return with_rotors(robot, self.rotor_inertia) if self.model == "rotor" else robot

    def shown(self, task: Task, one: Candidate) -> Candidate:
        """Return a feasible candidate with the inertia that it shows, and its fluxes by that."""
        inertia = self._inertia(task, one)
        alone = one.inertia / (one.inertia + task.mass)
        share = inertia / (inertia + task.mass)
        fluxes: dict[str, Any] = {
            name: None if value is None else value / alone * share
            for name in ("flux", "straight_flux", "deliverable_flux")
            for value in [getattr(one, name)]
        }
        return replace(one, inertia=inertia, links_inertia=one.inertia, **fluxes)

    def _inertia(self, task: Task, one: Candidate) -> float:
        robot, q, contact, h = task.robot, one.q, task.contact, task.direction
        if self.model == "composite":
            return float(impact_inertia(robot, q, contact, h, "composite"))
        hit = elastic_impact(
            robot, q, contact, h, task.mass, one.straight_speed or one.speed,
            self.restitution, self.contact_time, self.stiffness, rotor_inertia=self.rotor_inertia,
        )  # fmt: skip
        return IMMOVABLE if hit.equivalent is None else min(hit.equivalent, IMMOVABLE)
