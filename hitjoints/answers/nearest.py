"""What can be had instead, when a wish cannot be granted."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from hitjoints.constants import GRAVITY

if TYPE_CHECKING:
    from hitjoints.hit import Hit
    from hitjoints.types import Array


@dataclass(frozen=True, eq=False)
class Nearest:
    """The nearest hit that can be made: the same one, less hard, or on a lighter object.

    Attributes:
        joint: that delivers the most.
        flux: m/s, that it can deliver to this object.
        mass: kg, of the heaviest object to which this joint, in that configuration, delivers the
            flux asked for; None if it does so to none.
        goal: (3,) m, how far towards the goal the object gets; None without a goal.
        distance: m, the way there; None without a goal.
    """

    joint: int
    flux: float
    mass: float | None
    goal: Array | None
    distance: float | None

    @property
    def words(self) -> str:
        """What can be had, in a line."""
        parts = [f"joint {self.joint} can deliver {self.flux:.4g} m/s"]
        if self.goal is not None:
            at = ", ".join(f"{v:.3f}" for v in self.goal)
            parts.append(f"which moves the object {self.distance:.3g} m, to ({at}) m")
        if self.mass is not None:
            parts.append(f"an object of {self.mass:.3g} kg would do")
        return "; ".join(parts)

    def as_dict(self) -> dict[str, Any]:
        """Return the attributes by name, as JSON knows them."""
        goal = None if self.goal is None else self.goal.tolist()
        return vars(self) | {"goal": goal}


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
