"""A search near known optima: for a wish that has moved a little, in milliseconds.

It climbs from where the last plan was, and from a few samples, in one batch. It is no global
search, and what it finds says so.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from hitjoints.planning.search.climb import climb
from hitjoints.planning.search.climb_starts import starts_of
from hitjoints.planning.search.found import Found
from hitjoints.planning.search.groups import FINE

if TYPE_CHECKING:
    from hitjoints.planning.objectives.hit_problem import HitProblem
    from hitjoints.planning.search.sampler import Sampler
    from hitjoints.types import Array

VARIANTS, SAMPLES = 64, 64
"""Configurations that are variants of each known one, and drawn at random,"""
STARTS = 8
"""of which so many are climbed from beside those known."""


def search_near(problem: HitProblem, sampler: Sampler, seed: int, known: Array) -> Found:
    """Find the optimum near known configurations.

    Args:
        problem: what to maximise.
        sampler: of configurations on the manifold.
        seed: of the samples.
        known: (K, n) rad, configurations that were best for a similar problem.
    """
    at = np.clip(known, sampler.lower, sampler.upper)
    rng = np.random.default_rng(seed)
    varied = sampler.vary(np.repeat(at, VARIANTS, axis=0), rng)
    placed = sampler.place(np.concatenate((at, varied)))
    near = placed[: len(at)]
    drawn = np.concatenate((placed[len(at) :], sampler.draw(SAMPLES, seed)))
    value, excess = problem.screen(drawn)
    chosen = starts_of(problem, drawn, value, excess, STARTS, np.ones(problem.n))
    x, last = climb(problem, problem.start(np.concatenate((near, chosen))), FINE)
    return replace(Found.of(problem, x, last, drawn, value, excess), local=True)
