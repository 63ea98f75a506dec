"""The state at the impact: the arm as it moves, and the box before it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from hitjoints.dynamics.kinematics import jacobian
from hitjoints.goals.box_hit import Boxes
from hitjoints.goals.landing import LEVEL

if TYPE_CHECKING:
    from hitjoints.evidence.physics.setting import EngineSetting
    from hitjoints.model.robot import Contact, Robot
    from hitjoints.types import Array

UPRIGHT = 1e-6
"""Greatest horizontal part of a direction that has no left and right."""


@dataclass(frozen=True, eq=False)
class ImpactState:
    """The state at the impact.

    Attributes:
        contact: the point that hits.
        direction: (3,) unit vector h.
        mass: kg, of the object.
        q: (n,) rad.
        qd: (n,) rad/s.
        point: (3,) m, where the arm touches.
    """

    contact: Contact
    direction: Array
    mass: float
    q: Array
    qd: Array
    point: Array

    def velocity(self, robot: Robot) -> Array:
        """Return the velocity of the contact, (3,) m/s."""
        return np.asarray(jacobian(robot, self.q, self.contact) @ self.qd)

    def speed(self, robot: Robot) -> float:
        """Return the speed of the contact along the direction, m/s."""
        return float(self.direction @ self.velocity(robot))

    @property
    def axes(self) -> Array:
        """(3, 3): the hitting direction, its left, and up, as columns.

        Level directions have a level one, to the last digit.
        """
        h = self.direction.copy()
        if is_level(h):
            h[2] = 0.0
            h /= np.linalg.norm(h)
        across = np.cross((0.0, 0.0, 1.0), h)
        if np.linalg.norm(across) < UPRIGHT:  # straight up or down: any side will do
            across = np.cross((0.0, 1.0, 0.0), h)
        side = across / np.linalg.norm(across)
        return np.column_stack((h, side, np.cross(h, side)))

    def box_axes(self, setting: EngineSetting) -> Array:
        """Return the box's axes (3, 3) as columns: the normal of the face that is hit comes first.

        The first points into the box.
        """
        cos, sin = math.cos(setting.yaw), math.sin(setting.yaw)
        turn = np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])
        return np.asarray(self.axes @ turn)

    def face_point(self, setting: EngineSetting) -> Array:
        """Return where the arm touches the box, (3,) m in the box's axes from its centre."""
        aside = float(self.boxes(setting).lever[0])
        return np.array([-setting.size[0] / 2, aside, setting.height])

    def boxes(self, setting: EngineSetting) -> Boxes:
        """Return the box, one of one, and how it is hit, in the terms of the law."""
        off, yaw, mass = np.array([-setting.off_centre]), np.array([setting.yaw]), self.mass
        friction = np.array([setting.friction])
        return Boxes(
            np.array([mass]), np.array(setting.size), yaw, off, setting.height, friction,
            setting.support,
        )  # fmt: skip

    def box_centre(self, setting: EngineSetting) -> Array:
        """Return where the box stands, (3,) m: its face touches the arm."""
        return np.asarray(self.point - self.box_axes(setting) @ self.face_point(setting))


def is_level(direction: Array) -> bool:
    """Tell whether a direction (3,) is horizontal: a box on a level table can be hit along it."""
    return bool(abs(direction[2]) < LEVEL)
