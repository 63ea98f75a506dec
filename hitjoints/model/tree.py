"""What a description says of an arm: links and joints in a tree, before anything is chosen."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element

    from numpy.typing import NDArray

MOVING = ("revolute", "continuous", "prismatic")


@dataclass(frozen=True)
class Body:
    """A link: its inertia as it is written, and its shapes."""

    name: str
    mass: float = 0.0
    com: NDArray[np.float64] = field(default_factory=lambda: np.zeros(3))
    """(3,) m, in the link frame."""
    rpy: NDArray[np.float64] = field(default_factory=lambda: np.zeros(3))
    """(3,) rad, of the axes that the tensor is along."""
    moments: NDArray[np.float64] = field(default_factory=lambda: np.zeros(6))
    """(6,) kg m^2: xx, yy, zz, xy, xz, yz about the centre of mass."""
    has_inertial: bool = False
    shapes: tuple[Element, ...] = field(default=(), repr=False)
    """The <visual> and <collision> elements, as they stand."""

    @property
    def inertia(self) -> NDArray[np.float64]:
        """(3, 3) kg m^2, about the centre of mass, along the link frame's axes."""
        xx, yy, zz, xy, xz, yz = self.moments
        turn = rotation(self.rpy)
        return np.asarray(turn @ np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]) @ turn.T)


@dataclass(frozen=True)
class Connection:
    """A joint: what it connects, where, and how far it moves."""

    name: str
    kind: str
    """revolute, continuous, prismatic, fixed, or whatever else is written."""
    parent: str
    child: str
    xyz: NDArray[np.float64]
    """(3,) m, of the child's frame in the parent's, at zero."""
    rpy: NDArray[np.float64]
    """(3,) rad, roll, pitch and yaw about the parent's axes."""
    axis: NDArray[np.float64]
    """(3,) in the child's frame, not zero, of any length."""
    lower: float = 0.0
    upper: float = 0.0
    velocity: float = 0.0
    effort: float = 0.0
    has_limit: bool = False
    mimic: str = ""
    """The joint it follows, at `mimic_factor` times its position plus `mimic_offset`."""
    mimic_factor: float = 1.0
    mimic_offset: float = 0.0
    armature: float = 0.0
    """kg m^2 (kg), reflected rotor inertia; a URDF has none."""
    home: float | None = None
    """rad or m, where the description puts it at rest; None when it does not say."""

    @property
    def moves(self) -> bool:
        """Whether it is anything but fixed."""
        return self.kind != "fixed"

    def clipped(self, value: float) -> float:
        """Return the position within the limits that is nearest to a value, rad or m."""
        if self.kind == "continuous" or not self.has_limit:
            return value
        return min(max(value, self.lower), self.upper)


@dataclass(frozen=True)
class Tree:
    """A description: every link is reached from the root by one way."""

    name: str
    root: str
    bodies: dict[str, Body]
    joints: dict[str, Connection]
    materials: tuple[Element, ...] = field(default=(), repr=False)

    def above(self, link: str) -> list[Connection]:
        """Return the joints from the root to a link, in this order."""
        carrier = {joint.child: joint for joint in self.joints.values()}
        way: list[Connection] = []
        while (joint := carrier.get(link)) is not None:
            way.append(joint)
            link = joint.parent
        return way[::-1]

    def below(self, link: str) -> list[str]:
        """Return a link and all that hang on it."""
        children: dict[str, list[str]] = {}
        for joint in self.joints.values():
            children.setdefault(joint.parent, []).append(joint.child)
        reached = [link]
        for name in reached:
            reached += children.get(name, [])
        return reached

    def rooted(self, base: str) -> Tree:
        """Return the part that hangs on a link, with that link as its root."""
        kept = set(self.below(base))
        return Tree(
            self.name,
            base,
            {name: body for name, body in self.bodies.items() if name in kept},
            {n: j for n, j in self.joints.items() if j.parent in kept},
            self.materials,
        )


def rotation(rpy: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the rotation matrix (3, 3) of roll, pitch and yaw (3,) rad about the fixed axes."""
    (cr, cp, cy), (sr, sp, sy) = np.cos(rpy), np.sin(rpy)
    roll = np.array([[1, 0, 0], [0, cr, -sr], [0, sr, cr]])
    pitch = np.array([[cp, 0, sp], [0, 1, 0], [-sp, 0, cp]])
    yaw = np.array([[cy, -sy, 0], [sy, cy, 0], [0, 0, 1]])
    return np.asarray(yaw @ pitch @ roll)


def roll_pitch_yaw(turn: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the angles (3,) rad of a rotation matrix (3, 3), exact at pitches of +-pi/2 too."""
    yaw = np.arctan2(turn[1, 0], turn[0, 0])
    # Taking the yaw off first lets each angle mend the round-off of the one before.
    rest = rotation(np.array([0.0, 0.0, -yaw])) @ turn
    pitch = np.arctan2(-rest[2, 0], rest[0, 0])
    return np.array([np.arctan2(-rest[1, 2], rest[1, 1]), pitch, yaw])


def turn_about(axis: NDArray[np.float64], angle: float) -> NDArray[np.float64]:
    """Return the rotation matrix (3, 3) about an axis (3,) of any length by an angle (rad)."""
    x, y, z = axis / np.linalg.norm(axis)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.asarray(np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross)
