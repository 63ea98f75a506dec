"""The global search: sample, climb from diverse starts, hop from the best, in independent groups.

Each group draws its own samples and never sees the others' results, so that their agreement is
evidence: several searches that end at the same value have probably found the global optimum. The
groups go on hopping, a bounded number of rounds, until all agree twice in turn. Half of them start
from configurations far apart, half from closer ones: where one way of looking misses an optimum,
the other may not, and then they disagree.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from hitjoints.planning.search.climb import climb, feasible
from hitjoints.planning.search.climb_starts import starts_of
from hitjoints.planning.search.found import SAME, Found

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from hitjoints.planning.objectives.hit_problem import HitProblem
    from hitjoints.planning.search.sampler import Sampler
    from hitjoints.types import Array

GROUPS = 4
SAMPLES = 512  # per group
STARTS, STRAIGHT_STARTS = 32, 24  # per group and climb; fewer where qd doubles the variables
ANY = 16  # starts per group that are not chosen by their value
KEPT = 3  # optima per group that hops start from
VARIANTS = 48  # per optimum
ROUNDS = 4  # of hops, at most; until all groups agree twice in turn
POOLED = 2  # rounds of hops after that, from the optima of all groups
AGREE = 5e-5  # relative
PROBES = 64  # samples that tell which joints matter
APART = (1.0, 0.5)  # rad, between starts: groups look wide and close in turn
GLANCE, COARSE, FINE = 3, 4, 40  # steps of a climb


def search(problem: HitProblem, sampler: Sampler, seed: int, hints: Sequence[Array] = ()) -> Found:
    """Find the global optimum of a problem, with evidence.

    Args:
        problem: what to maximise.
        sampler: of configurations on the manifold.
        seed: of everything random; the same seed gives the same answer.
        hints: for each group in turn configurations (H, >= n) known to be admissible, where random
            ones hardly are. No two groups get the same: what all start from they would all find.
    """
    rngs = [np.random.default_rng((seed, group)) for group in range(GROUPS)]
    q = sampler.draw(GROUPS * SAMPLES, seed)
    value, excess = problem.screen(q)
    pools = np.array_split(np.arange(len(q)), GROUPS)
    count = STRAIGHT_STARTS if problem.moving else STARTS
    weight = _weights(problem, q[:PROBES])
    starts = [
        starts_of(problem, q[pool], value[pool], excess[pool], count, weight / _apart(group))
        for group, pool in enumerate(pools)
    ]
    for group, (pool, rng) in enumerate(zip(pools, rngs, strict=True)):
        # An optimum may be narrow, and the samples near it poor: some starts are any at all.
        usable = pool[excess[pool] == 0]
        blind = rng.permutation(usable)[:ANY]
        starts[group] = np.concatenate((starts[group], q[blind]))
    for group, known in enumerate(hints):
        starts[group] = np.concatenate((known[:, : problem.n], starts[group]))
    now = _climb(problem, starts)
    agreed = np.nan
    for _ in range(ROUNDS):
        now = _hop(problem, sampler, now, rngs, KEPT, weight)
        most = float(now.best.max())
        if now.agree and (most == -np.inf or most < agreed + AGREE):
            break
        agreed = most if now.agree else np.nan
    alone = now
    if not now.agree:
        # What the groups found is on record; their best optima together are hopped from on.
        now = _Optima(now.x, now.value, np.zeros_like(now.group))
        for _ in range(POOLED):
            now = _hop(problem, sampler, now, rngs[:1], KEPT * GROUPS, weight)
    kept = _best(now.value, np.arange(len(now.x)), KEPT * GROUPS)
    x, last = climb(problem, problem.start(now.x[kept, : problem.n]), FINE)
    found = Found.of(problem, x, last, q, value, excess)
    return replace(
        found,
        restarts=np.minimum(alone.best[np.isfinite(alone.best)], found.value.max(initial=-np.inf)),
        by_group=tuple(alone.x[_best(alone.value, rows, KEPT), : problem.n] for rows in alone.rows),
    )


def dealt(hints: Array) -> list[Array]:
    """Return hints (H, n) dealt out to the groups, each to one of them."""
    return [hints[group::GROUPS] for group in range(GROUPS)]


@dataclass(frozen=True)
class _Optima:
    """Where the climbs of all groups ended.

    Attributes:
        x: (S, m).
        value: (S,), -inf for a climb that got nowhere.
        group: (S,), which group each belongs to.
    """

    x: Array
    value: Array
    group: NDArray[np.intp]

    @property
    def rows(self) -> list[NDArray[np.intp]]:
        """The rows of each group."""
        return [np.flatnonzero(self.group == g) for g in range(GROUPS)]

    @property
    def best(self) -> Array:
        """Best value of each group."""
        return np.array([self.value[rows].max(initial=-np.inf) for rows in self.rows])

    @property
    def agree(self) -> bool:
        """Tell whether all groups found the same value, or none found any."""
        best = self.best
        same = bool(np.isfinite(best).all()) and bool(best.max() - best.min() < AGREE)
        return same or not np.isfinite(best).any()


def _climb(problem: HitProblem, starts: list[Array]) -> _Optima:
    """Climb from the starts of all groups at once, the better half of each group further."""
    x, last = climb(problem, problem.start(np.concatenate(starts)), GLANCE)
    group = np.repeat(np.arange(len(starts)), [len(s) for s in starts])
    value = np.where(feasible(problem, last), last.value, -np.inf)
    half = [
        _best(value, np.flatnonzero(group == g), -(-len(part) // 2))
        for g, part in enumerate(starts)
    ]
    rows = np.concatenate(half)
    x, last = climb(problem, x[rows], COARSE)
    value = np.where(feasible(problem, last), last.value, -np.inf)
    return _Optima(x, value, group[rows])


def _hop(
    problem: HitProblem,
    sampler: Sampler,
    now: _Optima,
    rngs: list[np.random.Generator],
    kept: int,
    weight: Array,
) -> _Optima:
    """Climb from variants of each group's best optima, which are climbed on as well."""
    q = now.x[:, : problem.n]
    best = [_best(now.value, rows, kept) for rows in now.rows[: len(rngs)]]
    near = [
        sampler.vary(np.repeat(q[rows], VARIANTS, axis=0), rng)
        for rows, rng in zip(best, rngs, strict=True)
    ]
    placed = sampler.place(np.concatenate(near))
    value, excess = problem.screen(placed)
    count = STRAIGHT_STARTS if problem.moving else STARTS
    fresh = (count - KEPT) * (GROUPS // len(rngs))
    starts, end = [], 0
    for group, (rows, variants) in enumerate(zip(best, near, strict=True)):
        part = slice(end, end + len(variants))
        scale = weight / _apart(group)
        chosen = starts_of(problem, placed[part], value[part], excess[part], fresh, scale)
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


def _weights(problem: HitProblem, q: Array) -> Array:
    """Return how much each joint matters, (n,) from 0 to 1: starts along a flat joint are alike."""
    gradient = problem.evaluate(problem.start(q)).gradient[:, : problem.n]
    typical = np.sqrt(np.nansum(gradient**2, axis=0))
    return np.asarray(np.minimum(1.0, typical / max(float(np.median(typical)), 1e-12)))


def _apart(group: int) -> float:
    """Return how far apart (rad) the starts of a group are."""
    return APART[group % len(APART)]
