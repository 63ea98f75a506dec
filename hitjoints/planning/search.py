"""The global search: sample, climb from diverse starts, hop from the best, in independent groups.

Each group draws its own samples and never sees the others' results, so that their agreement is
evidence: several searches that end at the same value have probably found the global optimum, and
the groups go on hopping, a bounded number of rounds, while they do not agree.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from hitjoints.planning.polish import climb, feasible
from hitjoints.quantities import place_joint

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from hitjoints.planning.objectives import Hit, HitProblem

    Array = NDArray[np.float64]

GROUPS = 4
SAMPLES = 512  # per group
STARTS = 10  # per group, in the first climb and in every hop
KEPT = 3  # optima per group that hops start from
VARIANTS = 48  # per optimum
ROUNDS = (1, 3)  # of hops: always, and at most while the groups disagree
AGREE = 5e-5  # relative
SAME = 1e-6  # relative
APART = 0.3  # rad, between starts
SCATTER = 0.5  # rad, of a hop
PENALTY = 3.0  # of an excess, against the logarithm of the objective
COARSE, FINE = 6, 40  # steps of a climb


@dataclass(frozen=True)
class Found:
    """What a search found.

    Attributes:
        x: (S, m) local optima, best first; empty if nothing satisfies the constraints.
        value: (S,) their objective.
        samples, admissible: configurations drawn, and how many met every constraint.
        screened: (A, n) the admissible samples, best first.
        local_optima: how many optima of different value were found.
        restarts: best value of each group that found one.
    """

    x: Array
    value: Array
    samples: int
    admissible: int
    screened: Array
    local_optima: int
    restarts: Array

    @classmethod
    def nothing(cls) -> Found:
        """Return the result of a search that was not worth starting."""
        none = np.zeros((0, 0))
        return cls(none, np.zeros(0), 0, 0, none, 0, np.zeros(0))

    @property
    def spread(self) -> float:
        """Relative difference between the best values of the groups (values are logarithms)."""
        return float(1.0 - np.exp(self.restarts.min() - self.restarts.max()))


class Sampler:
    """Draws configurations that put the contact at the object, within bounds.

    Args:
        hit: what is asked; without a position, every configuration will do.
        lower, upper: (n,) rad bounds; equal ones keep a joint where it is.
    """

    def __init__(self, hit: Hit, lower: Array, upper: Array) -> None:
        self.hit, self.lower, self.upper = hit, lower, upper
        bounded = np.isfinite(lower) & np.isfinite(upper)
        # A continuous joint is searched over one turn.
        self.low, self.high = np.where(bounded, lower, -np.pi), np.where(bounded, upper, np.pi)

    def draw(self, count: int, seed: int) -> Array:
        """Return configurations (N, n), N <= count, drawn at random."""
        if self.hit.position is None:
            return np.random.default_rng(seed).uniform(self.low, self.high, (count, len(self.low)))
        goals = np.tile(self.hit.position, (count, 1))
        placed = place_joint(self.hit.robot, self.hit.contact, goals, seed)
        return np.asarray(placed.q)

    def vary(self, q: Array, rng: np.random.Generator) -> Array:
        """Return variants of configurations (N, n), within the bounds but off the object.

        Half of them are flips: joint j mirrored and its neighbours turned by half a turn, which
        leaves the links of an arm with intersecting axes where they are, and the inertia nearly
        what it was; the other half have joints drawn anew. Both are scattered.
        """
        rows, n = q.shape
        middle = 0.5 * (self.low + self.high)
        even = np.arange(rows)[:, None] % 2 == 0
        flips = np.zeros((rows, n + 2), dtype=int)
        flips[:, 2 : n + 1] = even & (rng.random((rows, n - 1)) < 0.4)
        turns = (flips[:, :-2] + flips[:, 2:]) % 2
        flipped = np.where(flips[:, 1:-1] == 1, -q, q)
        flipped += np.pi * turns * np.where(flipped > middle, -1.0, 1.0)
        new = rng.uniform(self.low, self.high, q.shape)
        share = np.where(np.arange(n) < self.hit.contact.joint - 1, 0.5, 1.0)
        share = np.where(even, 0.05, share * rng.choice((0.1, 0.4, 0.9), (rows, 1)))
        noise = SCATTER * rng.random((rows, 1)) ** 2 * rng.standard_normal(q.shape)
        moved = np.where(rng.random(q.shape) < share, new, flipped + noise)
        return np.clip(moved, self.lower, self.upper)

    def place(self, q: Array) -> Array:
        """Return the configurations (N, n) moved until the contact is at the object."""
        if self.hit.position is None:
            return q
        goals = np.tile(self.hit.position, (len(q), 1))
        return np.asarray(place_joint(self.hit.robot, self.hit.contact, goals, start=q).q)


def search(problem: HitProblem, sampler: Sampler, seed: int, hints: Array | None = None) -> Found:
    """Find the global optimum of a problem, with evidence.

    Args:
        problem: what to maximise.
        sampler: of configurations on the manifold.
        seed: of everything random; the same seed gives the same answer.
        hints: (H, >= n) configurations known to be admissible, where random ones hardly are;
            every group starts from them too.
    """
    rngs = [np.random.default_rng((seed, group)) for group in range(GROUPS)]
    q = sampler.draw(GROUPS * SAMPLES, seed)
    value, excess = problem.screen(q)
    pools = np.array_split(np.arange(len(q)), GROUPS)
    starts = [_starts(problem, q[pool], value[pool], excess[pool], STARTS) for pool in pools]
    if hints is not None:
        starts = [np.concatenate((hints[:, : problem.n], part)) for part in starts]
    now = _climb(problem, starts)
    for turn in range(ROUNDS[1]):
        if turn >= ROUNDS[0] and now.agree:
            break
        now = _hop(problem, sampler, now, rngs, KEPT)
    restarts = now.best
    if not now.agree:
        # What the groups found is on record; their best optima together are hopped from once more.
        pooled = _Optima(now.x, now.value, np.zeros_like(now.group))
        now = _hop(problem, sampler, pooled, rngs[:1], KEPT * GROUPS)
    kept = _best(now.value, np.arange(len(now.x)), KEPT * GROUPS)
    x, last = climb(problem, problem.start(now.x[kept, : problem.n]), FINE)
    ok = np.flatnonzero(feasible(problem, last))
    order = ok[np.argsort(-last.value[ok], kind="stable")]
    x, reached = x[order], last.value[order]
    admissible = np.flatnonzero(excess == 0)
    ranked = admissible[np.argsort(-value[admissible], kind="stable")]
    return Found(
        x,
        reached,
        len(q),
        len(admissible),
        q[ranked],
        int((np.diff(reached) < -SAME).sum()) + 1 if reached.size else 0,
        np.minimum(restarts[np.isfinite(restarts)], reached.max(initial=-np.inf)),
    )


@dataclass(frozen=True)
class _Optima:
    """Where the climbs of all groups ended.

    Attributes:
        x: (S, m). value: (S,), -inf for a climb that got nowhere. group: (S,).
    """

    x: Array
    value: Array
    group: NDArray[np.intp]

    @property
    def best(self) -> Array:
        """Best value of each group."""
        return np.array([self.value[self.group == g].max(initial=-np.inf) for g in range(GROUPS)])

    @property
    def agree(self) -> bool:
        """Tell whether all groups found the same value, or none found any."""
        best = self.best
        same = bool(np.isfinite(best).all()) and bool(best.max() - best.min() < AGREE)
        return same or not np.isfinite(best).any()


def _climb(problem: HitProblem, starts: list[Array]) -> _Optima:
    """Climb from the starts of all groups at once."""
    x, last = climb(problem, problem.start(np.concatenate(starts)), COARSE)
    value = np.where(feasible(problem, last), last.value, -np.inf)
    return _Optima(x, value, np.repeat(np.arange(len(starts)), [len(s) for s in starts]))


def _hop(
    problem: HitProblem,
    sampler: Sampler,
    now: _Optima,
    rngs: list[np.random.Generator],
    kept: int,
) -> _Optima:
    """Climb from variants of each group's best optima, which are climbed on as well."""
    q = now.x[:, : problem.n]
    best = [_best(now.value, np.flatnonzero(now.group == g), kept) for g in range(len(rngs))]
    near = [
        sampler.vary(np.repeat(q[rows], VARIANTS, axis=0), rng)
        for rows, rng in zip(best, rngs, strict=True)
    ]
    placed = sampler.place(np.concatenate(near))
    value, excess = problem.screen(placed)
    fresh = (STARTS - KEPT) * (GROUPS // len(rngs))
    starts, end = [], 0
    for rows, variants in zip(best, near, strict=True):
        part = slice(end, end + len(variants))
        chosen = _starts(problem, placed[part], value[part], excess[part], fresh)
        starts.append(np.concatenate((q[rows], chosen)))
        end = part.stop
    more = _climb(problem, starts)
    old = np.concatenate(best)
    return _Optima(
        np.concatenate((now.x[old], more.x)),
        np.concatenate((now.value[old], more.value)),
        np.concatenate((now.group[old], more.group)),
    )


def _best(value: Array, rows: NDArray[np.intp], count: int) -> NDArray[np.intp]:
    """Choose the rows of greatest value, each value once: copies of an optimum teach nothing."""
    rows = rows[np.isfinite(value[rows])]
    rows = rows[np.argsort(-value[rows], kind="stable")]
    fresh = np.concatenate(([True], np.diff(value[rows]) < -SAME))[: len(rows)]
    return np.asarray(rows[fresh][:count])


def _starts(problem: HitProblem, q: Array, value: Array, excess: Array, count: int) -> Array:
    """Choose what to climb from: the best admissible rows, or else those nearest to it.

    A demanded flux leaves small islands that samples miss; climbs that have to be pulled onto them
    from good values find more.
    """
    chosen = _diverse(q, value, excess, count)
    if problem.flux is not None:
        short = np.where(np.isfinite(excess), PENALTY * excess, np.inf)
        bold = _diverse(q, value - short, np.where(np.isfinite(excess), 0.0, np.inf), count)
        chosen = np.union1d(chosen, bold)
    return np.asarray(q[chosen])


def _diverse(q: Array, value: Array, excess: Array, count: int) -> NDArray[np.intp]:
    """Choose rows (<= count) of high value, apart from each other, the admissible ones first."""
    usable = np.isfinite(excess) & np.isfinite(value)
    order = np.lexsort((-value, excess))
    order = order[usable[order]]
    chosen: list[int] = []
    while order.size and len(chosen) < count:
        chosen.append(int(order[0]))
        order = order[((q[order] - q[order[0]]) ** 2).sum(axis=1) > APART**2]
    return np.array(chosen, dtype=int)
