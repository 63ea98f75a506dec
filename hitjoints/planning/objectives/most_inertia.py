"""The greatest inertia along the direction (Eq. 14), and the least rebound for a flux."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from hitjoints.planning.objectives.objective import Objective

if TYPE_CHECKING:
    from hitjoints.planning.objectives.sight import Sight
    from hitjoints.types import Array


class MostInertia(Objective):
    """Eq. 14."""

    ranked_by = "inertia"

    def screen(self, seen: Sight) -> Array:
        """Return the logarithm of the inertia."""
        return np.asarray(-np.log(seen.mobility))

    def evaluate(self, seen: Sight) -> tuple[Array, Array]:
        """Return the logarithm of the inertia and its gradient."""
        mobility = seen.mobility
        return -np.log(mobility), -seen.mobility_gradient / mobility[:, None]


class LeastRebound(MostInertia):
    """The least Eq. 11 for a flux: the most inertia among configurations that can reach it."""

    needs_flux = True
