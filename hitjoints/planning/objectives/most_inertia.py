"""The greatest inertia along the direction (Eq. 14), and what follows from it for a given flux."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from hitjoints.planning.objectives.objective import Objective

if TYPE_CHECKING:
    from hitjoints.kernels.tape.trace import Scalar
    from hitjoints.planning.objectives.sight import Sight
    from hitjoints.planning.objectives.traced_hit import TracedHit
    from hitjoints.types import Array


class MostInertia(Objective):
    """Eq. 14."""

    ranked_by = "inertia"

    def screen(self, seen: Sight) -> Array:
        """Return the logarithm of the inertia."""
        return np.asarray(-np.log(seen.mobility))

    def formula(self, seen: TracedHit) -> tuple[Scalar, list[Scalar]]:
        """Return the inertia and the gradient of its logarithm."""
        inertia = 1.0 / seen.mobility
        return inertia, [-(by * inertia) for by in seen.mobility_gradient]


class LeastRebound(MostInertia):
    """The least Eq. 11 for a flux: the most inertia among configurations that can reach it."""

    needs_flux = True


class MostArrivals(MostInertia):
    """The greatest share of objects that come to rest within a tolerance of the goal.

    Of a joint's configurations that reach the flux, the one with the most inertia: what a mass that
    is not known exactly does to the object's speed goes with m / (inertia + m), and the rest of the
    spread hangs on the object and the flux alone. Between joints the shares themselves count.
    """

    ranked_by = "arrives"
    needs_flux = True
    needs_goal = True
