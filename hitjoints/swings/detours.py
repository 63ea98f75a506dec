"""Ways around what is in the way: two trees of configurations that grow towards each other.

RRT-Connect: one tree grows a step towards a random configuration, the other as far as it can
towards what that reached, and then they change roles. Where they meet there is a way, which is cut
short afterwards.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from hitjoints.swings.clear_way import Obstacle, Room
    from hitjoints.types import Array

GROWING = 400
"""Steps of the trees until they are given up."""
STEP = 0.5
"""rad, of a tree: the greatest change of a joint."""
CUTS = 40
"""Attempts at cutting a way short."""
FINE = 0.01
"""rad, that a joint moves between rows whose clearance may be looked at."""


def clear_between(room: Room, box: Obstacle | None, start: Array, end: Array) -> bool:
    """Tell whether the straight line from start (n,) to end (n,) rad touches nothing."""
    steps = int(np.ceil(np.abs(end - start).max() / FINE)) + 1
    rows = start + np.linspace(0.0, 1.0, steps + 1)[:, None] * (end - start)
    return room.check(rows, box).row is None


def detour(
    room: Room,
    box: Obstacle | None,
    ends: tuple[Array, Array],
    limits: tuple[Array, Array],
    rng: np.random.Generator,
) -> list[Array] | None:
    """Return the corners of a way that touches nothing, its ends included; None if none is found.

    Args:
        room: what is around.
        box: the object, if it is to be avoided.
        ends: (n,) rad, the first and the last configuration, both clear.
        limits: (n,) rad, lowest and highest positions.
        rng: of what is drawn.
    """
    trees = [_Tree(end) for end in ends]
    for i in range(GROWING):
        one, other = trees[i % 2], trees[1 - i % 2]
        reached = one.grow(room, box, rng.uniform(*limits))
        if reached is None:
            continue
        goal = one.nodes[reached]
        meeting = other.grow(room, box, goal)
        while meeting is not None and np.abs(other.nodes[meeting] - goal).max() > 0:
            meeting = other.grow(room, box, goal, meeting)
        if meeting is not None:
            forth, back = one.way_to(reached), other.way_to(meeting)[:-1]
            way = [*forth, *reversed(back)]
            return _cut_short(room, box, way if i % 2 == 0 else way[::-1], rng)
    return None


class _Tree:
    """Configurations that are reached from a root by ways that touch nothing."""

    def __init__(self, root: Array) -> None:
        self.nodes, self._before = [root], [-1]

    def grow(
        self, room: Room, box: Obstacle | None, goal: Array, last: int | None = None
    ) -> int | None:
        """Return a new node a step towards a goal, from the nearest or the one given; or None."""
        nearest = last
        if nearest is None:
            nearest = int(np.argmin(((np.array(self.nodes) - goal) ** 2).sum(axis=1)))
        begin = self.nodes[nearest]
        far = float(np.abs(goal - begin).max())
        end = goal if far <= STEP else begin + (goal - begin) * (STEP / far)
        if room.touches(end, box) or not clear_between(room, box, begin, end):
            return None
        self.nodes.append(end)
        self._before.append(nearest)
        return len(self.nodes) - 1

    def way_to(self, node: int) -> list[Array]:
        """Return the corners from the root to a node."""
        way = []
        while node >= 0:
            way.append(self.nodes[node])
            node = self._before[node]
        return way[::-1]


def _cut_short(
    room: Room, box: Obstacle | None, way: list[Array], rng: np.random.Generator
) -> list[Array]:
    for _ in range(CUTS):
        if len(way) < 3:
            break
        i, j = sorted(rng.choice(len(way), 2, replace=False))
        if j - i > 1 and clear_between(room, box, way[i], way[j]):
            del way[i + 1 : j]
    return way
