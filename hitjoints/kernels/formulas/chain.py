"""A serial arm as plain numbers, arranged so that its dynamics cost few operations.

Every joint axis is made the local z axis: R_i = R_{i-1} Rx(alpha_i) Rz(q_i + offset_i) and
p_i = p_{i-1} + R_{i-1} t_i (+ z_i q_i for a prismatic joint). Not Denavit-Hartenberg, whose common
normals run off to infinity for nearly parallel axes; instead each origin slides along its own axis
to the foot of the previous origin, which makes the joints of a spherical wrist share one point.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import pinocchio as pin

from hitjoints.errors import InputError, ModelError
from hitjoints.kernels.formulas.regroup import Inertia, regroup

MAX_JOINTS = 16
NOISE = 1e-15  # rounding left over from products of rotations, relative to the largest entry
UNBOUNDED = 1e300  # Pinocchio writes "no limit" as the largest double

Triple = tuple[float, float, float]
Array = np.ndarray[Any, np.dtype[np.float64]]


@dataclass(frozen=True)
class ChainLink:
    """One joint and the body it carries.

    Args:
        prismatic: slides along z instead of turning about it.
        tilt: (cos, sin) of the constant turn alpha about x that precedes the joint.
        offset: constant turn about z (rad), added to q.
        translation: origin in the previous link's frame (m); zero for the first.
        inertia: regrouped inertial parameters in this frame.
        armature: rotor inertia on the diagonal of M (kg m^2, or kg for a prismatic joint).
        lower: position limits (rad or m), infinite if there is none.
        upper: position limits (rad or m), infinite if there is none.
        slowest: velocity limits (rad/s or m/s), infinite if there is none.
        fastest: velocity limits (rad/s or m/s), infinite if there is none.
    """

    prismatic: bool
    tilt: tuple[float, float]
    offset: float
    translation: Triple
    inertia: Inertia
    armature: float
    lower: float
    upper: float
    slowest: float
    fastest: float


@dataclass(frozen=True)
class Chain:
    """A fixed-base serial arm in normalised frames.

    Args:
        base_rotation: rows of the rotation from the first link's resting frame to the world.
        base_position: origin of the first link at q = 0 in the world (m).
        links: the joints, from the base.
        joint_rotations: rows of the rotation from each normalised frame to the model's joint frame.
        joint_slides: how far each joint's own origin lies along the normalised z axis (m).
    """

    base_rotation: tuple[Triple, Triple, Triple]
    base_position: Triple
    links: tuple[ChainLink, ...]
    joint_rotations: tuple[tuple[Triple, Triple, Triple], ...]
    joint_slides: tuple[float, ...]

    @classmethod
    def from_model(cls, model: pin.Model) -> Chain:
        """Read a Pinocchio model.

        Args:
            model: fixed base, a single branch, 1 to 16 revolute or prismatic joints with nq = 1.

        Raises:
            ModelError: the model is not such a chain.
        """
        axes, prismatic = joint_axes(model)
        n = len(axes)
        placements = [model.jointPlacements[i + 1] for i in range(n)]
        frames = [_frame_of_axis(axis) for axis in axes]
        base = placements[0].rotation @ frames[0]
        tilts, offsets = np.zeros(n), np.zeros(n)
        shifts = [placements[0].translation.copy()]
        for i in range(1, n):
            turn = frames[i - 1].T @ placements[i].rotation @ frames[i]
            before, tilts[i], offsets[i] = _split_zxz(_clean(turn))
            frames[i - 1] = _clean(frames[i - 1] @ _about_z(before))
            offsets[i - 1] += before
            shifts.append(frames[i - 1].T @ placements[i].translation)
        slides = _slide(tilts, shifts)
        bodies = [
            Inertia.from_pinocchio(model.inertias[i + 1], frames[i], slides[i]) for i in range(n)
        ]
        tilted = [turn_of(angle) for angle in tilts]
        moved = [(0.0, 0.0, 0.0), *(_triple(_clean(shift)) for shift in shifts[1:])]
        turns = [
            _about_x(tilts[i]) @ (_about_z(offsets[i]) if prismatic[i] else np.eye(3))
            for i in range(n)
        ]
        regrouped = regroup(bodies, prismatic, turns, moved)
        slowest, fastest = velocity_limits(model)
        links = tuple(
            ChainLink(
                prismatic[i],
                tilted[i],
                float(offsets[i]),
                moved[i],
                regrouped[i],
                float(model.armature[i]),
                _bound(model.lowerPositionLimit[i]),
                _bound(model.upperPositionLimit[i]),
                float(slowest[i]),
                float(fastest[i]),
            )
            for i in range(n)
        )
        origin = placements[0].translation - slides[0] * base[:, 2]
        rotations = tuple(_rows(_clean(frame)) for frame in frames)
        return cls(
            _rows(_clean(base)), _triple(origin), links, rotations, tuple(map(float, slides))
        )

    @property
    def size(self) -> int:
        """Number of joints."""
        return len(self.links)

    @property
    def has_speed_limits(self) -> bool:
        """Every joint has a finite velocity limit, both ways."""
        return all(math.isfinite(v) for link in self.links for v in (link.slowest, link.fastest))

    def attach(self, joint: int, offset: Triple) -> tuple[int, Triple]:
        """Where a contact sits: the last joint that moves it, and its place in that link's frame.

        Args:
            joint: 1-based joint whose link carries the contact.
            offset: contact point in the model's joint frame (m).

        Returns:
            1-based link (0: fixed to the base) and the point (m) in its frame. A point on a
            revolute joint's axis belongs to the link before.

        Raises:
            InputError: no such joint, or the offset is not finite.
        """
        if not 1 <= joint <= self.size:
            raise InputError("joint", joint, f"choose one of 1 to {self.size}")
        if len(offset) != 3 or not all(map(math.isfinite, offset)):
            raise InputError("offset", offset, "three finite numbers (m) are expected")
        rotation = np.array(self.joint_rotations[joint - 1])
        point = rotation.T @ np.array(offset) + np.array((0.0, 0.0, self.joint_slides[joint - 1]))
        while joint and not self.links[joint - 1].prismatic and point[0] == point[1] == 0.0:
            link = self.links[joint - 1]
            c, s = link.tilt
            point = _clean(np.array((0.0, -s * point[2], c * point[2])) + link.translation)
            joint -= 1
        return joint, _triple(point)


def joint_axes(model: pin.Model) -> tuple[list[Array], list[bool]]:
    """Return the axis of every joint in its frame, and which of them are prismatic.

    Raises:
        ModelError: not a single chain of 1 to 16 revolute or prismatic joints.
    """
    n = model.njoints - 1
    if not 1 <= n <= MAX_JOINTS:
        raise ModelError(model.name, f"{n} joints; kernels take 1 to {MAX_JOINTS}")
    if list(model.parents)[1:] != list(range(n)):
        raise ModelError(model.name, "the joints do not form a single serial chain")
    if any(joint.nq != 1 or joint.nv != 1 for joint in list(model.joints)[1:]):
        raise ModelError(model.name, "a joint has more than one coordinate")
    data = model.createData()
    pin.computeJointJacobians(model, data, np.zeros(n))
    axes: list[Array] = []
    prismatic: list[bool] = []
    for i in range(n):
        jac = pin.getJointJacobian(model, data, i + 1, pin.LOCAL)
        column = np.asarray(jac).reshape(6, n)[:, i]  # one joint's comes as a vector
        slides, turns = np.linalg.norm(column[:3]), np.linalg.norm(column[3:])
        if not (abs(slides + turns - 1.0) < 1e-9 and min(slides, turns) == 0.0):
            name = model.names[i + 1]
            raise ModelError(model.name, f"joint {name} is neither revolute nor prismatic")
        prismatic.append(bool(slides > 0.0))
        axes.append(column[:3] if slides > 0.0 else column[3:])
    return axes, prismatic


def velocity_limits(model: pin.Model) -> tuple[Array, Array]:
    """Slowest and fastest joint velocities, (n,) each (rad/s or m/s).

    Pinocchio 4 has separate lower limits, but its URDF reader fills them with the positive limit:
    only a lower limit that is not positive is one, otherwise the limit is symmetric.
    """
    fastest = np.array([_bound(v) for v in model.velocityLimit])
    lower = np.asarray(getattr(model, "lowerVelocityLimit", fastest))
    slowest = np.where(lower <= 0.0, [_bound(v) for v in lower], -fastest)
    return slowest, fastest


def turn_of(angle: float) -> tuple[float, float]:
    """(cos, sin) of a constant angle (rad), exact at quarter turns."""
    c, s = _clean(np.array((math.cos(angle), math.sin(angle))))
    return float(c), float(s)


def _frame_of_axis(axis: Array) -> Array:
    helper = np.eye(3)[(int(np.argmax(np.abs(axis))) + 1) % 3]
    x = helper - (helper @ axis) * axis
    x /= np.linalg.norm(x)
    return np.column_stack((x, np.cross(axis, x), axis))


def _split_zxz(rotation: Array) -> tuple[float, float, float]:
    """Angles (before, tilt, after) with rotation = Rz(before) Rx(tilt) Rz(after), |before| <=
    pi/2.
    """
    x, y = rotation[0, 2], -rotation[1, 2]
    sign = -1.0 if y < 0.0 else 1.0
    before = math.atan2(sign * x, sign * y) if x or y else 0.0
    rest = _about_z(before).T @ rotation
    tilt = math.atan2(-rest[1, 2], rest[2, 2])
    after = math.atan2(-rest[0, 1], rest[0, 0])
    return before, tilt, after


def _slide(tilts: Array, shifts: list[Array]) -> Array:
    """Slide the origins along their axes, in place; returns the slides (m)."""
    slides = np.zeros(len(shifts))
    if len(shifts) > 1:
        slides[0] = -shifts[1][2]
    for i in range(1, len(shifts)):
        shifts[i][2] += slides[i - 1]
        c, s = turn_of(tilts[i])
        axis = np.array((0.0, -s, c))
        slides[i] = shifts[i] @ axis
        shifts[i] -= slides[i] * axis
    return slides


def _about_z(angle: float) -> Array:
    c, s = turn_of(angle)
    return np.array(((c, -s, 0.0), (s, c, 0.0), (0.0, 0.0, 1.0)))


def _about_x(angle: float) -> Array:
    c, s = turn_of(angle)
    return np.array(((1.0, 0.0, 0.0), (0.0, c, -s), (0.0, s, c)))


def _clean(values: Array) -> Array:
    """Zero what rounding left, so that constants fold."""
    small = np.abs(values) <= NOISE * np.abs(values).max(initial=0.0)
    units = np.abs(np.abs(values) - 1.0) <= NOISE
    return np.where(small, 0.0, np.where(units, np.sign(values), values))


def _bound(value: float) -> float:
    return math.copysign(math.inf, value) if abs(value) > UNBOUNDED else float(value)


def _triple(values: Array) -> Triple:
    return float(values[0]), float(values[1]), float(values[2])


def _rows(matrix: Array) -> tuple[Triple, Triple, Triple]:
    return _triple(matrix[0]), _triple(matrix[1]), _triple(matrix[2])
