"""A box on a table, hit off its centre, turned, and above or below its centre of mass.

Without friction between link and box the impulse acts along the normal of the face that is hit.
The box begins to move, to turn about the vertical, and, hit above or below its centre, to pitch:
then the table pushes back at the edge it pitches over, with friction.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from hitjoints.constants import GRAVITY
from hitjoints.errors import InfeasibleError
from hitjoints.goals.leaning import Response, respond

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from hitjoints.goals.sliding import Support
    from hitjoints.types import Array

STEEPEST = 0.75
"""Greatest friction x height / length of a box that slides on its face, not on its front edge."""


def lever(offset: ArrayLike, yaw: ArrayLike, length: float) -> Array:
    """Return the distance (N,) m of a contact from the middle of the face, to the left.

    Args:
        offset: (N,) m, how far to the left of the box's centre the line of the hit passes.
        yaw: (N,) rad, of the face's normal against the hitting direction, to the left.
        length: m, of the box along that normal.
    """
    return np.asarray((np.asarray(offset) + length / 2 * np.sin(yaw)) / np.cos(yaw))


@dataclass(frozen=True, eq=False)
class Boxes:
    """Boxes of even density, and how they are hit; every number may be one, or one for each of N.

    Attributes:
        mass: (N,) kg.
        size: (3,) m, edges along the face's normal, across it and upwards.
        yaw: (N,) rad, of the face's normal against the hitting direction, to the left.
        offset: (N,) m, how far to the left of the box's centre the line of the hit passes.
        height: m, of the contact above the centre of mass.
        friction: (N,) mu on the table.
        support: what carries the boxes.
    """

    mass: Array
    size: Array
    yaw: Array
    offset: Array
    height: float
    friction: Array
    support: Support = "face"

    @property
    def lever(self) -> Array:
        """Distance (N,) m of the contact from the middle of the face, to the left."""
        return lever(self.offset, self.yaw, self.size[0])

    @property
    def spin_inertia(self) -> Array:
        """About the vertical, (N,) kg m^2."""
        return np.asarray(self.mass * (self.size[0] ** 2 + self.size[1] ** 2) / 12)

    @property
    def roll_inertia(self) -> Array:
        """About the face's normal, (N,) kg m^2."""
        return np.asarray(self.mass * (self.size[1] ** 2 + self.size[2] ** 2) / 12)

    @property
    def pitch_inertia(self) -> Array:
        """About the axis across the face's normal, (N,) kg m^2."""
        return np.asarray(self.mass * (self.size[0] ** 2 + self.size[2] ** 2) / 12)

    @cached_property
    def response(self) -> Response:
        """How the boxes answer to a unit impulse."""
        return respond(self)

    def effective_mass(self) -> Array:
        """Return the mass (N,) kg that the contact feels along the face's normal."""
        moved = self.response
        return np.asarray(
            1 / (moved.velocity[:, 0] - moved.spin * self.lever + moved.pitch * self.height)
        )

    def sidewards(self) -> Array:
        """Return how much of what the table gives sideways in the hit it has given at the end (N,).

        The edge that slips sideways bears all the weight until the box has come down, and less than
        all: it is lifted by what it got in the hit. The shock of coming down is at the other edge.
        """
        half, up = self.size[0] / 2, np.sign(self.height) * self.size[2] / 2
        return np.asarray(2 * self.pitch_inertia / (self.mass * half * (half - self.friction * up)))

    def obstacles(self, impulse: Array) -> list[str]:
        """Return why boxes hit with impulses (N,) N s do not simply slide."""
        reasons = []
        lever, face = float(np.abs(self.lever).max()), self.size[1] / 2
        if lever > face:
            reasons.append(
                f"the hit misses the face: {lever:.3g} m from its middle, half {face:.3g} m"
            )
        if self.friction.max() * self.size[2] / self.size[0] > STEEPEST:
            reasons.append(
                f"it would slide on its edge: friction x height / length is above {STEEPEST:g}"
            )
        half, up = self.size[0] / 2, self.size[2] / 2
        about_edge = self.pitch_inertia + self.mass * (half**2 + up**2)
        energy = about_edge * (self.response.pitch * impulse) ** 2 / 2
        lift = np.hypot(half, up) - up
        if (energy > self.mass * GRAVITY * lift).any():
            reasons.append(f"it would tip over: it is hit {abs(self.height):.3g} m off its centre")
        return reasons


@dataclass(frozen=True, eq=False)
class Departure:
    """How boxes leave a hit.

    Attributes:
        velocity: (N, 2) m/s, of the centre, along the hitting direction and to its left.
        spin: (N,) rad/s about the vertical.
        sliding: (N, 2) m/s, and
        turning: (N,) rad/s, with which a box that had not pitched would come to the same rest:
            while one pitches its weight on the table, and so friction, is less by what the table
            gave it in the hit, so that in the end the table has only carried its weight.
        impulse: (N,) N s, along the face's normal.
    """

    velocity: Array
    spin: Array
    sliding: Array
    turning: Array
    impulse: Array


def hit_boxes(boxes: Boxes, inertia: Array, speed: Array, restitution: Array) -> Departure:
    """Hit boxes at rest.

    Args:
        boxes: and how they are hit.
        inertia: (N,) kg, directional, along the normal of the face.
        speed: (N,) m/s, of the contact along the hitting direction.
        restitution: (N,) eps.

    Raises:
        InfeasibleError: a box would be missed, tip, or slide on its edge.
    """
    closing = speed * np.cos(boxes.yaw)
    impulse = (1 + restitution) * closing / (1 / inertia + 1 / boxes.effective_mass())
    reasons = boxes.obstacles(impulse)
    if reasons:
        raise InfeasibleError(f"the box would not simply slide: {'; '.join(reasons)}")
    moved = impulse[:, None] * boxes.response.velocity
    slides = np.column_stack((impulse / boxes.mass, boxes.sidewards() * moved[:, 1]))
    velocity, sliding = (_turned(v, boxes.yaw) for v in (moved, slides))
    spin = impulse * boxes.response.spin
    turning = -impulse * boxes.lever / boxes.spin_inertia
    return Departure(velocity, spin, sliding, turning, impulse)


def _turned(vectors: Array, angle: Array) -> Array:
    """Return vectors (N, 2) turned to the left by angles (N,)."""
    cos, sin = np.cos(angle), np.sin(angle)
    x, y = vectors.T
    return np.column_stack((cos * x - sin * y, sin * x + cos * y))
