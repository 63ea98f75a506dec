"""A box that pitched in a hit comes down again, sliding on the edge it pitched over.

Until it has come down the edge alone carries it, with less than its weight, and friction acts
there. Then the other edge strikes the table, which gives nothing back: a flat box lies still, a
tall one rocks on over that edge.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from hitjoints.constants import GRAVITY
from hitjoints.goals.leaning import Edge, Response, Wrench, turned

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from hitjoints.goals.box_hit import Boxes
    from hitjoints.types import Array

    Mask = NDArray[np.bool_]

STEPS = 16
"""In which a box comes down, about."""
FARTHEST = 0.05
"""rad, that a box is lifted in a step."""
MOST_STEPS = 20 * STEPS
ROCKS = 8
"""Times a box rocks; what is left of the motion then is less than can be seen."""
WEAKEST = 0.1
"""Share of gravity over length with which a box is pulled down; by less, and it is about to tip."""
BALANCE = 0.1
"""Share of half its length: a box so near to its balance may stop there, on one corner."""
CREEP = 1e-3
"""m/s, slower than which an edge as good as sticks."""
STILL = 1e-6
"""rad/s, of a box that does not pitch."""


@dataclass(frozen=True, eq=False)
class Afloat:
    """Boxes on an edge, or down again; along the face's normal at the hit, and to its left.

    Attributes:
        moved: velocity (N, 2) m/s, spin and pitch (N,) rad/s.
        way: (N, 2) m.
        yaw: (N,) rad, turned.
        lift: (N,) rad, about the edge.
        side: (N,), of the edge, 1 in front and -1 behind.
        tipped: (N,), those that do not come down, or hardly.
    """

    moved: Response
    way: Array
    yaw: Array
    lift: Array
    side: Array
    tipped: Mask


def come_down(boxes: Boxes, moved: Response) -> Afloat:
    """Follow boxes after a hit until they lie flat on the table.

    Args:
        boxes: that were hit.
        moved: after the hit.
    """
    count = len(boxes.mass)
    none = np.zeros(count)
    side = np.full(count, np.sign(boxes.height) or 1.0)
    now = Afloat(moved, np.zeros((count, 2)), none, none, side, none > 0)
    for _ in range(ROCKS):
        lifts = (now.side * now.moved.pitch > STILL) & ~now.tipped
        if not lifts.any():
            break
        now = _struck(boxes, _fallen(boxes, now, lifts), lifts)
    return now


def _fallen(boxes: Boxes, now: Afloat, which: Mask) -> Afloat:
    """Return boxes as their other edge is about to strike the table.

    Args:
        boxes: all of them.
        now: as they are.
        which: (N,), those that are followed.
    """
    rate = now.side * now.moved.pitch
    pull = np.maximum(-now.side * _rates(boxes, now).moved.pitch, WEAKEST * GRAVITY / boxes.size[0])
    rising = np.where(which, rate, 1.0)
    step = np.where(which, np.minimum(2 * rate / pull / STEPS, FARTHEST / rising), 0.0)
    going = which.copy()
    for _ in range(MOST_STEPS):
        left = np.where(going, np.minimum(step, _landing_time(boxes, now)), 0.0)
        now = _runge_kutta(boxes, now, left)
        tips = going & (Edge(boxes, now.side, now.lift).reach <= BALANCE * boxes.size[0] / 2)
        now = replace(now, tipped=now.tipped | tips)
        going &= (left >= step) & ~tips
        if not going.any():
            break
    tipped = now.tipped | going
    return replace(now, tipped=tipped, lift=np.where(tipped, now.lift, 0.0))


def _landing_time(boxes: Boxes, now: Afloat) -> Array:
    """Return when boxes are down, (N,) s, by their present speed and pull."""
    rate = now.side * now.moved.pitch
    pull = now.side * _rates(boxes, now).moved.pitch
    falling = pull < 0
    root = np.sqrt(np.maximum(rate**2 - 2 * pull * now.lift, 0.0))
    time = np.where(falling, (rate + root) / np.where(falling, -pull, 1.0), np.inf)
    return np.asarray(time)


def _struck(boxes: Boxes, now: Afloat, which: Mask) -> Afloat:
    """Return boxes after the other edge struck the table: flat on it, or rocking on over it."""
    before, rate = _turned(now.moved, -now.yaw), now.side * now.moved.pitch
    near, far = Edge(boxes, now.side), Edge(boxes, -now.side)
    sinking = -rate * near.reach  # of the centre, m/s; the far edge sinks twice as fast
    rocked = far.hold(before, _direction(far.slip(before)), 2 * sinking)
    rocks = which & ~now.tipped & (-now.side * rocked.pitch > STILL) & (rate < 0)
    flat = _flattened(boxes, before, (near, far), sinking)
    lies = which & ~now.tipped & ~rocks
    after = _chosen(rocks, rocked, _chosen(lies, flat, before))
    return replace(now, moved=_turned(after, now.yaw), side=np.where(rocks, -now.side, now.side))


def _flattened(
    boxes: Boxes, before: Response, edges: tuple[Edge, Edge], sinking: Array
) -> Response:
    """Return boxes that both edges stop: as much by each as ends the sinking and the pitch."""
    does = [edge.wrench(_direction(edge.slip(before))) for edge in edges]
    both = Wrench(
        *(np.concatenate([a[:, :1], b[:, :1]], axis=1) for a, b in zip(*does, strict=True))
    )
    stops = np.stack((np.ones_like(both.pitched), both.pitched), axis=1)
    asked = np.column_stack((boxes.mass * sinking, -boxes.pitch_inertia * before.pitch))
    load = np.linalg.solve(stops, asked[..., None])[..., 0]
    return both.added(before, boxes, np.asarray(load))


def _rates(boxes: Boxes, now: Afloat) -> Afloat:
    """Return what changes in a second, on the edge; the axes of the face turn with the box."""
    moved, edge = now.moved, Edge(boxes, now.side, now.lift)
    none = np.zeros_like(moved.spin)
    sin, cos = np.sin(now.side * now.lift), np.cos(now.lift)
    # A box that spins and pitches: Euler's equations, about the axis of its pitch and the normal.
    thin = (boxes.roll_inertia - boxes.spin_inertia) * sin * cos
    still = Response(
        np.zeros_like(moved.velocity), none, thin * moved.spin**2 / boxes.pitch_inertia
    )
    wanted = np.maximum(GRAVITY - edge.down * moved.pitch**2 + edge.ahead * still.pitch, 0.0)
    seen = _turned(moved, -now.yaw)
    twist = (boxes.spin_inertia - boxes.roll_inertia) * (cos**2 - sin**2) - boxes.pitch_inertia
    twist = twist * moved.pitch * moved.spin
    pushed = _turned(edge.hold(still, _direction(edge.slip(seen)), wanted, twist), now.yaw)
    upright = boxes.spin_inertia * cos**2 + boxes.roll_inertia * sin**2
    spin = (pushed.spin * boxes.spin_inertia - 2 * thin * moved.pitch * moved.spin) / upright
    return replace(
        now,
        moved=pushed._replace(spin=spin),
        way=moved.velocity,
        yaw=moved.spin,
        lift=now.side * moved.pitch,
    )


def _direction(slip: Array) -> Array:
    """Return directions of slip (N, J, 2); of what creeps, a share."""
    length = np.linalg.norm(slip, axis=-1, keepdims=True)
    return np.asarray(slip / np.hypot(length, CREEP))


def _runge_kutta(boxes: Boxes, now: Afloat, time: Array) -> Afloat:
    k1 = _rates(boxes, now)
    k2 = _rates(boxes, _gone(now, k1, time / 2))
    k3 = _rates(boxes, _gone(now, k2, time / 2))
    k4 = _rates(boxes, _gone(now, k3, time))
    for rate, weight in ((k1, 1), (k2, 2), (k3, 2), (k4, 1)):
        now = _gone(now, rate, weight * time / 6)
    return now


def _gone(now: Afloat, rate: Afloat, time: Array) -> Afloat:
    """Return boxes after a time (N,) s at a rate."""
    moved = Response(
        now.moved.velocity + time[:, None] * rate.moved.velocity,
        now.moved.spin + time * rate.moved.spin,
        now.moved.pitch + time * rate.moved.pitch,
    )
    return replace(
        now,
        moved=moved,
        way=now.way + time[:, None] * rate.way,
        yaw=now.yaw + time * rate.yaw,
        lift=now.lift + time * rate.lift,
    )


def _chosen(which: Mask, one: Response, other: Response) -> Response:
    """Return of each box the one response or the other."""
    return Response(
        *(np.where(which.reshape(-1, *(1,) * (a.ndim - 1)), a, b)
          for a, b in zip(one, other, strict=True))
    )  # fmt: skip


def _turned(moved: Response, angle: Array) -> Response:
    """Return the same motion in axes that are turned to the right by angles (N,)."""
    return moved._replace(velocity=turned(moved.velocity, angle))
