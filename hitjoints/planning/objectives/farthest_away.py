"""How far the links behind the contact can point away from the object."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hitjoints.planning.objectives.objective import Objective

if TYPE_CHECKING:
    from hitjoints.kernels.tape.trace import Scalar
    from hitjoints.planning.objectives.sight import Sight
    from hitjoints.planning.objectives.traced_hit import TracedHit
    from hitjoints.types import Array


class FarthestAway(Objective):
    """The least h . (chi_{k+1} - chi_k): tells whether the away condition can be met."""

    ranked_by = "away_gap"
    logarithm = False
    keeps_away = False

    def screen(self, seen: Sight) -> Array:
        """Return minus the gap, m."""
        return -seen.gap

    def formula(self, seen: TracedHit) -> tuple[Scalar, list[Scalar]]:
        """Return minus the gap, m, and its gradient."""
        gap, by = seen.gap
        return -gap, [-slope for slope in by]
