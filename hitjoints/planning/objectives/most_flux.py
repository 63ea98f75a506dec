"""The greatest flux: with the speed of Eq. 9, straight along the direction, and deliverable."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hitjoints.planning.objectives.objective import Objective

if TYPE_CHECKING:
    from hitjoints.kernels.tape.trace import Scalar
    from hitjoints.planning.objectives.sight import Sight
    from hitjoints.planning.objectives.traced_hit import TracedHit
    from hitjoints.types import Array


class MostFlux(Objective):
    """Eq. 10 with the speed of Eq. 9, whatever the motion does sideways."""

    ranked_by = "flux"

    def screen(self, seen: Sight) -> Array:
        """Return the logarithm of the flux."""
        return seen.log_flux

    def formula(self, seen: TracedHit) -> tuple[Scalar, list[Scalar]]:
        """Return the flux of the velocities, the fastest or chosen ones, and the gradient of its
        logarithm.
        """
        return seen.flux


class MostStraightFlux(MostFlux):
    """The same for a motion exactly along the direction."""

    ranked_by = "straight_flux"
    moving = True

    def screen(self, seen: Sight) -> Array:
        """Return the logarithm of the greatest straight flux."""
        return seen.log_straight_flux


class MostDeliverable(MostStraightFlux):
    """The straight flux that a motion from rest to rest can deliver within the arm's limits."""

    ranked_by = "deliverable_flux"
    stopping = True
