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

from hitjoints.errors import InfeasibleError
from hitjoints.goals.coming_down import Afloat, come_down
from hitjoints.goals.leaning import Response, respond, turned

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

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

    @property
    def on_the_face(self) -> NDArray[np.bool_]:
        """(N,) which are hit on the face and do not slide on their edge."""
        steep = self.friction * self.size[2] / self.size[0] > STEEPEST
        return np.asarray((np.abs(self.lever) <= self.size[1] / 2) & ~steep)

    def obstacles(self) -> list[str]:
        """Return why boxes do not simply slide, however hard they are hit."""
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
        return reasons


@dataclass(frozen=True, eq=False)
class Departure:
    """How boxes leave a hit.

    Attributes:
        velocity: (N, 2) m/s, of the centre, along the hitting direction and to its left.
        spin: (N,) rad/s about the vertical.
        impulse: (N,) N s, along the face's normal.
        down: what they do until they lie flat, in the axes of the face.
    """

    velocity: Array
    spin: Array
    impulse: Array
    down: Afloat


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
    moved = Response(*(impulse * part.T for part in boxes.response))
    moved = moved._replace(velocity=moved.velocity.T)
    down, reasons = come_down(boxes, moved), boxes.obstacles()
    if down.tipped.any():
        reasons.append(f"it would tip over: it is hit {abs(boxes.height):.3g} m off its centre")
    if reasons:
        raise InfeasibleError(f"the box would not simply slide: {'; '.join(reasons)}")
    return Departure(turned(moved.velocity, boxes.yaw), moved.spin, impulse, down)
