"""What a search for the best configuration found, with its evidence."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from hitjoints.planning.search.climb import feasible

if TYPE_CHECKING:
    from hitjoints.planning.objectives.hit_problem import HitProblem
    from hitjoints.planning.search.climb import Values
    from hitjoints.types import Array

SAME = 1e-6
"""Values that differ by less, relatively, are of one optimum."""


@dataclass(frozen=True)
class Found:
    """What a search found.

    Attributes:
        x: (S, m) local optima, best first; empty if nothing satisfies the constraints.
        value: (S,) their objective.
        samples: configurations drawn.
        admissible: how many of them met every constraint.
        screened: (A, n) the admissible samples, best first.
        local_optima: how many optima of different value were found.
        restarts: best value that each group found by itself, of those that found one.
        by_group: what each group found by itself, (S, n) configurations, best first: where the
            groups of a further search may start from without losing their independence.
        local: only places near known ones were searched, and a few more.
    """

    x: Array
    value: Array
    samples: int
    admissible: int
    screened: Array
    local_optima: int
    restarts: Array
    by_group: tuple[Array, ...] = ()
    local: bool = False

    @classmethod
    def nothing(cls) -> Found:
        """Return the result of a search that was not worth starting."""
        none = np.zeros((0, 0))
        return cls(none, np.zeros(0), 0, 0, none, 0, np.zeros(0))

    @classmethod
    def of(
        cls, problem: HitProblem, x: Array, last: Values, q: Array, value: Array, excess: Array
    ) -> Found:
        """Return what climbs ended at, the best first, with each as a restart.

        Args:
            problem: that was climbed.
            x: (S, m) where the climbs ended.
            last: the values there.
            q: (N, n) rad, the samples.
            value: (N,) what they screened at.
            excess: (N,) likewise.
        """
        ok = np.flatnonzero(feasible(problem, last))
        order = ok[np.argsort(-last.value[ok], kind="stable")]
        reached = last.value[order]
        admissible = np.flatnonzero(excess == 0)
        ranked = admissible[np.argsort(-value[admissible], kind="stable")]
        return cls(
            x[order],
            reached,
            len(q),
            len(admissible),
            q[ranked],
            int((np.diff(reached) < -SAME).sum()) + 1 if reached.size else 0,
            reached,
        )

    @property
    def spread(self) -> float:
        """Relative difference between the best values of the groups (values are logarithms)."""
        return float(1.0 - np.exp(self.restarts.min() - self.restarts.max()))
