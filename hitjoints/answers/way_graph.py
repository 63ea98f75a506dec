"""Ways of an object over its table, hit by hit: a graph of places, searched for the fewest hits.

Places lie on a lattice that the object and its goal belong to. An edge is a hit that some joint
can deliver, by the map of deliverable fluxes; a way of fewest hits is taken, and among those the
one that most likely arrives. A box can be hit on its faces only, so its edges go along the
lattice; an object without a size is hit from any side.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from hitjoints.answers.deliverable_map import deliverable_map
from hitjoints.constants import GRAVITY

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from hitjoints.hit import Hit
    from hitjoints.model.robot import Robot
    from hitjoints.types import Array

SPACING = 0.1
"""m, of the lattice, about."""
BASE = 0.2
"""m, around the arm's base, where no object slides."""
SIDES = 12
"""Directions in which an object without faces is looked at."""
SAFE = 0.95
"""Share of the flux on the map that is counted on."""
STRAIGHT = 1e-6
"""m, across an axis, of an edge that goes along it."""
ROOMY = 1e-6
"""What of a share the nearness to the greatest flux counts: it decides between equals only."""


class Leg(NamedTuple):
    """One hit of a way.

    Attributes:
        start: (3,) m.
        end: (3,) m.
        turned: the face that is hit is a quarter turn from the one that the object is first hit on.
        yaw: rad, how the face's normal is turned against the way, to the left.
    """

    start: Array
    end: Array
    turned: bool
    yaw: float


class WayGraph:
    """The graph of one wish.

    Args:
        robot: the arm.
        hit: from where to where, and what; its goal, friction and restitution are needed.
    """

    def __init__(self, robot: Robot, hit: Hit) -> None:
        self.hit, self.has_faces = hit, hit.size is not None
        turn = hit.yaw if self.has_faces else 0.0
        angle = math.atan2(hit.direction[1], hit.direction[0]) + turn
        self.axes = np.array([_along(angle), _along(angle + math.pi / 2)])
        self.places = _lattice(hit, self.axes, _reach(robot))
        count = 4 if self.has_faces else SIDES
        sides = np.array([_along(angle + 2 * math.pi * k / count) for k in range(count)])
        level = np.column_stack((sides, np.zeros(count)))
        self._map = deliverable_map(robot, hit, hit.contacts(robot), self.places, level)
        self._weights = self._edges(angle)

    def forbid(self, start: int, end: int) -> None:
        """Leave an edge out from now on: it was tried."""
        self._weights[start, end] = 0.0

    def leg(self, start: int, end: int) -> Leg:
        """Return the hit from one place to another."""
        way = self.places[end] - self.places[start]
        if not self.has_faces:
            return Leg(self.places[start], self.places[end], False, 0.0)
        parts = self.axes @ way[:2]
        turned = bool(abs(parts[1]) > abs(parts[0]))
        ahead, left = (parts[1], -parts[0]) if turned else parts
        yaw = -math.atan2(math.copysign(1.0, ahead) * left, abs(ahead))
        yaw = yaw if abs(yaw) > STRAIGHT else 0.0
        return Leg(self.places[start], self.places[end], turned, yaw)

    def best(self, most: int) -> list[int]:
        """Return the places of the best way of at most so many hits, by number; empty for none.

        The object is at place 0, its goal is place 1.
        """
        share = np.zeros(len(self.places))
        share[0] = 1.0
        before: list[Array] = []
        for _ in range(most):
            along = share[:, None] * self._weights
            before.append(along.argmax(axis=0))
            share = along.max(axis=0)
            if share[1] > 0:
                way = [1]
                for come_from in reversed(before):
                    way.append(int(come_from[way[-1]]))
                return way[::-1]
        return []

    def _edges(self, angle: float) -> Array:
        """Return the share that arrives of a hit from each place (P, P) to each; 0 for none."""
        hit = self.hit
        assert hit.friction is not None
        assert hit.restitution is not None
        way = self.places[None, :, :2] - self.places[:, None, :2]
        distance = np.linalg.norm(way, axis=2)
        needed = np.sqrt(2 * hit.friction * GRAVITY * distance) / (1 + hit.restitution)
        flux, inertia = self._seen(np.arctan2(way[..., 1], way[..., 0]) - angle)
        able = (SAFE * flux >= needed[..., None]) & (distance > STRAIGHT)[..., None]
        able &= _keeps_off_base(self.places[:, :2], way, self._wide)[..., None]
        if self.has_faces:
            across = np.abs(np.einsum("pqi,ai->pqa", way, self.axes)).min(axis=2)
            able &= (across <= _aside(hit))[..., None]
        share = np.zeros(able.shape)
        rows = able.nonzero()
        share[rows] = arrival_share(hit, distance[rows[:2]], inertia[rows])
        share[rows] *= 1 - ROOMY * needed[rows[:2]] / flux[rows]
        return np.asarray(share.max(axis=2))

    @property
    def _wide(self) -> float:
        """Half of what the object takes across its way, m."""
        return 0.0 if self.hit.size is None else float(np.max(self.hit.size[:2])) / 2

    def _seen(self, angles: Array) -> tuple[Array, Array]:
        """Return flux and inertia (P, P, C) at the first place in directions (P, P) rad.

        Between two directions of the map the lesser counts.
        """
        count = self._map.flux.shape[1]
        turn = angles / (2 * np.pi / count)
        if self.has_faces:  # a hit a hair beside a normal is one along it
            turn = np.round(turn)
        below = np.floor(turn + 1e-9).astype(int)
        above = np.where(turn - below > 1e-9, below + 1, below) % count
        below %= count
        rows = np.arange(len(self.places))[:, None]
        flux, inertia = self._map
        return (
            np.minimum(flux[rows, below], flux[rows, above]),
            np.minimum(inertia[rows, below], inertia[rows, above]),
        )


def arrival_share(hit: Hit, distance: Array, inertia: Array) -> Array:
    """Return the share of hits that end within the tolerance of where they should, to first order.

    Args:
        hit: what is hit, and its spread.
        distance: (N,) m, that the object is to slide.
        inertia: (N,) kg, of the contact.
    """
    spread = dict.fromkeys(("mass", "restitution", "friction", "yaw", "speed"), 0.0)
    spread |= hit.spread or {}
    restitution, friction = hit.restitution or 0.0, hit.friction or 1.0
    slack = (2 * spread["restitution"] / (1 + restitution)) ** 2
    slack += (spread["friction"] / friction) ** 2 + (2 * spread["speed"]) ** 2
    felt = 2 * spread["mass"] / (inertia + hit.mass)  # 2 m / (inertia + m) of mass / m
    along = distance * np.sqrt(slack + felt**2)
    across = distance * (0.0 if hit.size is None else spread["yaw"])
    tolerance = hit.setting.tolerance
    return np.asarray(_within(tolerance, along) * _within(tolerance, across))


def _within(tolerance: float, deviation: Array) -> Array:
    """Return the share of normal deviates within a tolerance."""
    with np.errstate(divide="ignore"):
        sizes = tolerance / (math.sqrt(2) * deviation)
    return np.array([math.erf(size) for size in sizes])


def _aside(hit: Hit) -> float:
    """Return how far beside its way a box may end (m) that is hit along its face's normal."""
    return min(hit.setting.tolerance, SPACING) / 4


def _along(angle: float) -> Array:
    return np.array([math.cos(angle), math.sin(angle)])


def _reach(robot: Robot) -> float:
    """Return how far from its base an arm gets at most, m."""
    links = [np.linalg.norm(place.translation) for place in robot.model.jointPlacements]
    return float(sum(links))


def _lattice(hit: Hit, axes: Array, reach: float) -> Array:
    """Return places (P, 3) m within reach: the object's, its goal, and those between and around."""
    assert hit.goal is not None
    middle, parts = hit.position[:2], []
    far = reach + float(np.linalg.norm(middle))
    for axis in axes:
        whole = float(axis @ (hit.goal[:2] - middle))
        whole = whole if abs(whole) > _aside(hit) else 0.0
        # A goal that is nearer than the spacing has lines of its own: finer ones would be too many.
        near = abs(whole) < SPACING
        step = SPACING if near else abs(whole) / max(2, math.ceil(abs(whole) / SPACING))
        lines = step * np.arange(-math.ceil(far / step), math.ceil(far / step) + 1)
        parts.append(np.union1d(lines, lines + whole) if near else lines)
    grid = np.stack(np.meshgrid(*parts, indexing="ij"), axis=-1).reshape(-1, 2)
    places = middle + grid @ axes
    out = np.linalg.norm(places, axis=1)
    ends = np.stack((middle, hit.goal[:2]))
    apart = np.linalg.norm(places[:, None] - ends, axis=2).min(axis=1) > STRAIGHT
    kept = places[(out <= reach) & (out >= BASE) & apart]
    level = np.concatenate((ends, kept))
    return np.column_stack((level, np.full(len(level), hit.position[2])))


def _keeps_off_base(places: Array, way: Array, wide: float) -> NDArray[np.bool_]:
    """Tell which ways (P, P, 2) m from places (P, 2) m do not pass too near the arm's base."""
    length = np.maximum((way**2).sum(axis=2), STRAIGHT**2)
    share = np.clip(-(way * places[:, None]).sum(axis=2) / length, 0.0, 1.0)
    nearest = np.linalg.norm(places[:, None] + share[..., None] * way, axis=2)
    return np.asarray(nearest >= BASE + wide)
