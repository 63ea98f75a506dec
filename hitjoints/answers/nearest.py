"""What can be had instead, when a wish cannot be granted."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from hitjoints.constants import GRAVITY
from hitjoints.told import Told

if TYPE_CHECKING:
    from hitjoints.hit import Hit
    from hitjoints.types import Array


@dataclass(frozen=True, eq=False, repr=False)
class Nearest(Told):
    """The nearest hit that can be made: the same one, less hard, or on a lighter object.

    Attributes:
        joint: that delivers the most.
        flux: m/s, that it can deliver to this object.
        mass: kg, of the heaviest object to which this joint, in that configuration, delivers the
            flux asked for; None if it does so to none.
        goal: (3,) m, how far towards the goal the object gets; None without a goal.
        distance: m, the way there; None without a goal.
        way: (3,) m each, where the object rests on a way of several hits that by the map of
            deliverable fluxes would take it to the goal; None where no such way is known.
    """

    joint: int
    flux: float
    mass: float | None
    goal: Array | None
    distance: float | None
    way: tuple[Array, ...] | None = None

    @property
    def hits(self) -> int | None:
        """How many hits that way takes."""
        return None if self.way is None else len(self.way) + 1

    @property
    def words(self) -> str:
        """What can be had, in a line."""
        parts = [f"joint {self.joint} can deliver {self.flux:.4g} m/s"]
        if self.goal is not None:
            at = ", ".join(f"{v:.3f}" for v in self.goal)
            parts.append(f"which moves the object {self.distance:.3g} m, to ({at}) m")
        if self.mass is not None:
            parts.append(f"an object of {self.mass:.3g} kg would do")
        if self.way is not None:
            by = ", ".join(f"({place[0]:.3f}, {place[1]:.3f})" for place in self.way)
            parts.append(f"{self.hits} hits may do, by way of {by} m: ask with hits = {self.hits}")
        return "; ".join(parts)

    def as_dict(self) -> dict[str, Any]:
        """Return the attributes by name, as JSON knows them."""
        goal = None if self.goal is None else self.goal.tolist()
        way = None if self.way is None else [place.tolist() for place in self.way]
        return vars(self) | {"goal": goal, "hits": self.hits, "way": way}


def nearest_hit(hit: Hit, joint: int, inertia: float, flux: float) -> Nearest:
    """Return what can be had of a hit.

    Args:
        hit: what was asked.
        joint: that delivers the most.
        inertia: kg, of it.
        flux: m/s, that it delivers to the hit's object.
    """
    speed = flux * (1 + hit.mass / inertia)
    mass = None
    if hit.flux is not None and speed > hit.flux:
        mass = inertia * (speed / hit.flux - 1)
    goal = distance = None
    if hit.goal is not None:
        assert hit.friction is not None
        assert hit.restitution is not None
        distance = ((1 + hit.restitution) * flux) ** 2 / (2 * hit.friction * GRAVITY)
        goal = np.asarray(hit.position + distance * hit.direction)
    return Nearest(joint, flux, mass, goal, distance)
