"""A box that is hit above or below its centre leans on its table while it is hit.

It would pitch, and the edge over which it does would sink in: the table pushes back there, with
friction against the slip of the edge. All begins from rest, so that what moves keeps its direction
while the impulse grows, and the slip's direction is found by going round.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from hitjoints.goals.sliding import support_nodes

if TYPE_CHECKING:
    from hitjoints.goals.box_hit import Boxes
    from hitjoints.types import Array

ROUNDS = 100
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
    edge = _Edge(boxes)
    slip = np.zeros((count, len(edge.across), 2))
    slip[..., 0] = 1.0
    moved = free
    for _ in range(ROUNDS):
        moved = edge.hold(free, slip)
        before, slip = slip, edge.slip(moved)
        if np.abs(slip - before).max() < SETTLED:
            break
    return moved


class _Edge:
    """The edge over which boxes pitch: its points (J,), loads linear along it.

    Attributes:
        ahead: m, of the centre.
        across: (J,) m, to the left.
        shapes: (2, J), of loads: even, and growing to the left.
    """

    def __init__(self, boxes: Boxes) -> None:
        nodes, weights = support_nodes(boxes.support)
        self.boxes, self.down = boxes, boxes.size[2] / 2
        self.ahead = np.sign(boxes.height) * boxes.size[0] / 2
        self.across = boxes.size[1] / 2 * nodes
        self.shapes = np.stack((weights, weights * nodes))

    def hold(self, free: Response, slip: Array) -> Response:
        """Return the response of boxes whose edge does not sink in.

        Args:
            free: without the table.
            slip: (N, J, 2) unit vectors, directions in which the edge's points slip.
        """
        boxes = self.boxes
        drag = -boxes.friction[:, None, None] * slip
        push = np.einsum("kj,njx->nkx", self.shapes, drag)  # (N, 2, 2), by each load
        lift = self.shapes.sum(axis=1)
        turned = np.einsum("kj,nj->nk", self.shapes,
                           self.ahead * drag[..., 1] - self.across * drag[..., 0])  # fmt: skip
        pitched = -self.down * push[..., 0] - self.ahead * lift
        rolled = self.shapes @ self.across + self.down * push[..., 1]
        mass, about = boxes.mass[:, None], boxes.pitch_inertia[:, None]
        sinking = np.stack(
            (lift / mass - self.ahead * pitched / about, rolled / boxes.roll_inertia[:, None]),
            axis=1,
        )
        wanted = np.column_stack((self.ahead * free.pitch, np.zeros_like(free.pitch)))
        load = np.linalg.solve(sinking, wanted[..., None])[..., 0]
        return Response(
            free.velocity + np.einsum("nk,nkx->nx", load, push) / mass,
            free.spin + (load * turned).sum(axis=1) / boxes.spin_inertia,
            free.pitch + (load * pitched).sum(axis=1) / boxes.pitch_inertia,
        )

    def slip(self, moved: Response) -> Array:
        """Return the directions (N, J, 2) in which the edge's points slip."""
        along = (moved.velocity[:, 0] - self.down * moved.pitch)[:, None]
        along = along - moved.spin[:, None] * self.across
        aside = moved.velocity[:, 1] + self.ahead * moved.spin
        slip = np.stack(np.broadcast_arrays(along, aside[:, None]), axis=-1)
        length = np.linalg.norm(slip, axis=-1, keepdims=True)
        return np.asarray(slip / np.where(length > 0, length, 1.0))
