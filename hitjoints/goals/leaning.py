"""A box that is hit above or below its centre leans on its table while it is hit.

It would pitch, and the edge over which it does would sink in: the table pushes back there, with
friction against the slip of the edge. All begins from rest, so that what moves keeps its direction
while the impulse grows, and the direction of the slip is found by going round.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from hitjoints.goals.sliding import support_nodes

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from hitjoints.goals.box_hit import Boxes
    from hitjoints.types import Array

ROUNDS = 300
STRIDE = 1.0
"""Of a round, in units of the slip of a point mass."""
SETTLED = 1e-12
"""Change of a slip's direction in a round that is none."""


class Response(NamedTuple):
    """How boxes move after a unit impulse along the face's normal, in the axes of the face.

    Attributes:
        velocity: (N, 2) m/s, of the centre, along the normal and to its left.
        spin: (N,) rad/s, about the vertical.
        pitch: (N,) rad/s, towards the normal.
    """

    velocity: Array
    spin: Array
    pitch: Array


class Wrench(NamedTuple):
    """What an edge's loads do, each for K shapes of them, in the axes of the face.

    Attributes:
        push: (N, K, 2), of the centre.
        turned: (N, K), about the vertical.
        pitched: (N, K), towards the normal.
        rolled: (N, K), about the normal.
    """

    push: Array
    turned: Array
    pitched: Array
    rolled: Array

    def added(self, free: Response, boxes: Boxes, load: Array) -> Response:
        """Return a response with loads (N, K) added to it."""
        return Response(
            free.velocity + np.einsum("nk,nkx->nx", load, self.push) / boxes.mass[:, None],
            free.spin + (load * self.turned).sum(axis=1) / boxes.spin_inertia,
            free.pitch + (load * self.pitched).sum(axis=1) / boxes.pitch_inertia,
        )


def respond(boxes: Boxes) -> Response:
    """Return how boxes answer to a unit impulse (1 N s) at the contact."""
    count, height = len(boxes.mass), boxes.height
    free = Response(
        np.column_stack((1 / boxes.mass, np.zeros(count))),
        -boxes.lever / boxes.spin_inertia,
        height / boxes.pitch_inertia,
    )
    if height == 0:
        return free
    edge = Edge(boxes, np.full(count, np.sign(height)))
    drag = np.zeros((count, len(edge.across), 2))
    drag[..., 0] = 1.0
    moved = free
    for _ in range(ROUNDS):
        moved = edge.hold(free, drag, edge.ahead * free.pitch)
        # Coulomb's law as a projection: along the slip, or less where the edge sticks.
        pulled = drag + STRIDE * boxes.mass[:, None, None] * edge.slip(moved)
        before, drag = drag, pulled / np.maximum(np.linalg.norm(pulled, axis=-1), 1.0)[..., None]
        if np.abs(drag - before).max() < SETTLED:
            break
    return moved


class Edge:
    """The edge over which boxes pitch: its points (J,), loads linear along it.

    Attributes:
        side: (N,), 1 for the edge in front, -1 for the one behind.
        ahead: (N,) m, of the centre.
        down: (N,) m, below it.
        across: (J,) m, to the left.
        shapes: (2, J), of loads: even, and growing to the left.
    """

    def __init__(self, boxes: Boxes, side: Array, lift: ArrayLike = 0.0) -> None:
        """Take the edge of boxes that are lifted about it by an angle (N,) rad."""
        nodes, weights = support_nodes(boxes.support)
        half, up = boxes.size[0] / 2, boxes.size[2] / 2
        self.boxes, self.side = boxes, side
        self.reach = half * np.cos(lift) - up * np.sin(lift)
        self.ahead = side * self.reach
        self.down = np.broadcast_to(up * np.cos(lift) + half * np.sin(lift), side.shape)
        self.across = boxes.size[1] / 2 * nodes
        self.shapes = np.stack((weights, weights * nodes))

    def wrench(self, dragged: Array) -> Wrench:
        """Return what unit loads of each shape do while the edge's points are dragged.

        Args:
            dragged: (N, J, 2), directions against which friction acts, at most of unit length.
        """
        drag = -self.boxes.friction[:, None, None] * dragged
        lift, ahead, down = self.shapes.sum(axis=1), self.ahead[:, None], self.down[:, None]
        push = np.einsum("kj,njx->nkx", self.shapes, drag)
        round_up = ahead * drag[..., 1] - self.across * drag[..., 0]
        return Wrench(
            push,
            np.einsum("kj,nj->nk", self.shapes, round_up),
            -down * push[..., 0] - ahead * lift,
            self.shapes @ self.across + down * push[..., 1],
        )

    def hold(
        self, free: Response, dragged: Array, wanted: Array, twist: ArrayLike = 0.0
    ) -> Response:
        """Return the response of boxes that the table holds up at the edge, without a roll.

        Args:
            free: without the table.
            dragged: as `wrench`.
            wanted: (N,), by how much the edge is to be raised.
            twist: (N,), moment about the normal that the loads are to have.
        """
        boxes, does = self.boxes, self.wrench(dragged)
        mass, about = boxes.mass[:, None], boxes.pitch_inertia[:, None]
        raised = self.shapes.sum(axis=1) / mass - self.ahead[:, None] * does.pitched / about
        sinking = np.stack((raised, does.rolled), axis=1)
        asked = np.column_stack(np.broadcast_arrays(wanted, twist))
        return does.added(free, boxes, np.linalg.solve(sinking, asked[..., None])[..., 0])

    def slip(self, moved: Response) -> Array:
        """Return the velocities (N, J, 2) of the edge's points."""
        along = (moved.velocity[:, 0] - self.down * moved.pitch)[:, None]
        along = along - moved.spin[:, None] * self.across
        aside = moved.velocity[:, 1] + self.ahead * moved.spin
        return np.stack(np.broadcast_arrays(along, aside[:, None]), axis=-1)


def turned(vectors: Array, angle: Array) -> Array:
    """Return vectors (N, 2) turned to the left by angles (N,)."""
    cos, sin = np.cos(angle), np.sin(angle)
    x, y = vectors.T
    return np.column_stack((cos * x - sin * y, sin * x + cos * y))
