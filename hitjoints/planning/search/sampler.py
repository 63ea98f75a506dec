"""Configurations with the contact at the object: at random, and variants of known ones."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from hitjoints.quantities import place_joint

if TYPE_CHECKING:
    from hitjoints.planning.task import Task
    from hitjoints.types import Array

SCATTER = 0.5  # rad, noise of a variant


class Sampler:
    """Draws configurations that put the contact at the object, within bounds.

    Args:
        task: what is asked; without a position, every configuration will do.
        lower: (n,) rad, lower bounds.
        upper: (n,) rad, upper bounds; equal ones keep a joint where it is.
    """

    def __init__(self, task: Task, lower: Array, upper: Array) -> None:
        self.task, self.lower, self.upper = task, lower, upper
        bounded = np.isfinite(lower) & np.isfinite(upper)
        # A continuous joint is searched over one turn.
        self.low, self.high = np.where(bounded, lower, -np.pi), np.where(bounded, upper, np.pi)

    def draw(self, count: int, seed: int) -> Array:
        """Return configurations (N, n), N <= count, drawn at random."""
        if self.task.target is None:
            return np.random.default_rng(seed).uniform(self.low, self.high, (count, len(self.low)))
        goals = np.tile(self.task.target, (count, 1))
        placed = place_joint(self.task.robot, self.task.contact, goals, seed)
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
        share = np.where(np.arange(n) < self.task.contact.joint - 1, 0.5, 1.0)
        share = np.where(even, 0.05, share * rng.choice((0.1, 0.4, 0.9), (rows, 1)))
        noise = SCATTER * rng.random((rows, 1)) ** 2 * rng.standard_normal(q.shape)
        moved = np.where(rng.random(q.shape) < share, new, flipped + noise)
        return np.clip(moved, self.lower, self.upper)

    def place(self, q: Array) -> Array:
        """Return the configurations (N, n) moved until the contact is at the object."""
        if self.task.target is None:
            return q
        goals = np.tile(self.task.target, (len(q), 1))
        return np.asarray(place_joint(self.task.robot, self.task.contact, goals, start=q).q)
