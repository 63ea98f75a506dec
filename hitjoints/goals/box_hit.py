"""A box on a table, hit off its centre, turned, and above or below its centre of mass.

Without friction between link and box the impulse acts along the normal of the face that is hit.
The box begins to move, to turn about the vertical, and, hit above or below its centre, to pitch:
then the table pushes back at the edge it pitches over, with friction.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from hitjoints.constants import GRAVITY
from hitjoints.errors import InfeasibleError

if TYPE_CHECKING:
    from hitjoints.types import Array

STEEPEST = 0.75
"""Greatest friction x height / length of a box that slides on its face, not on its front edge."""


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
    """

    mass: Array
    size: Array
    yaw: Array
    offset: Array
    height: float
    friction: Array

    @property
    def lever(self) -> Array:
        """Distance (N,) m of the contact from the middle of the face, to the left."""
        half = self.size[0] / 2
        return np.asarray((self.offset + half * np.sin(self.yaw)) / np.cos(self.yaw))

    @property
    def spin_inertia(self) -> Array:
        """About the vertical, (N,) kg m^2."""
        return np.asarray(self.mass * (self.size[0] ** 2 + self.size[1] ** 2) / 12)

    @property
    def pitch_inertia(self) -> Array:
        """About the axis across the face's normal, (N,) kg m^2."""
        return np.asarray(self.mass * (self.size[0] ** 2 + self.size[2] ** 2) / 12)

    def push_back(self) -> Array:
        """Return the table's impulse (N,), vertical, as a share of the hit's.

        Such that the edge over which the box pitches does not sink in.
        """
        z, length, up = self.height, self.size[0], self.size[2]
        slip = np.sign(z) * self.friction * length * up / 4
        turning = self.pitch_inertia
        return np.asarray(
            length / 2 * abs(z) / turning / (1 / self.mass + (length**2 / 4 - slip) / turning)
        )

    def pitch(self) -> Array:
        """Return the pitching speed (N,) rad/s after a unit impulse, towards the hit's height."""
        z, length, up = self.height, self.size[0], self.size[2]
        table = self.push_back()
        drag = np.sign(z) * self.friction * table * up / 2
        return np.asarray((abs(z) - table * length / 2 + drag) / self.pitch_inertia)

    def effective_mass(self) -> Array:
        """Return the mass (N,) kg that the contact feels along the face's normal."""
        advance = (1 - self.friction * self.push_back()) / self.mass
        turn = self.lever**2 / self.spin_inertia
        return np.asarray(1 / (advance + turn + self.pitch() * abs(self.height)))

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
        energy = about_edge * (self.pitch() * impulse) ** 2 / 2
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
        impulse: (N,) N s, along the face's normal.
    """

    velocity: Array
    spin: Array
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
    advance = impulse * (1 - boxes.friction * boxes.push_back()) / boxes.mass
    velocity = advance[:, None] * np.column_stack((np.cos(boxes.yaw), np.sin(boxes.yaw)))
    return Departure(velocity, -impulse * boxes.lever / boxes.spin_inertia, impulse)
