"""Inertial parameters with fewest non-zeros (Gautier 1990, Khalil 1994), the mass matrix
unchanged.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pinocchio as pin

NEGLIGIBLE = 1e-15  # relative to the largest entry of the same tensor

Array = np.ndarray[Any, np.dtype[np.float64]]


@dataclass(frozen=True)
class Inertia:
    """Ten inertial parameters of a body about its frame's origin.

    Regrouped ones describe no single body: a zero mass beside a first moment is usual.

    Args:
        mass: kg.
        moment: mass times centre of mass (kg m).
        tensor: xx, yy, zz, xy, xz, yz of the rotational inertia about the origin (kg m^2).
    """

    mass: float
    moment: tuple[float, float, float]
    tensor: tuple[float, float, float, float, float, float]

    @classmethod
    def from_pinocchio(cls, inertia: pin.Inertia, frame: Array, slide: float) -> Inertia:
        """Express a Pinocchio inertia in the frame rotated by `frame`, its origin `slide` back
        along z.
        """
        centre = frame.T @ inertia.lever + np.array((0.0, 0.0, slide))
        tensor = frame.T @ inertia.inertia @ frame + inertia.mass * _about(centre, centre)
        return cls.of_matrix(inertia.mass, inertia.mass * centre, tensor)

    @classmethod
    def of_matrix(cls, mass: float, moment: Array, tensor: Array) -> Inertia:
        """Take the parameters from arrays (3,) and (3, 3), rounding noise removed."""
        six = np.array([tensor[i, j] for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))])
        x, y, z = map(float, _clean(moment))
        xx, yy, zz, xy, xz, yz = map(float, _clean(six))
        return cls(float(mass), (x, y, z), (xx, yy, zz, xy, xz, yz))

    @property
    def matrix(self) -> Array:
        """The rotational inertia, (3, 3) kg m^2."""
        xx, yy, zz, xy, xz, yz = self.tensor
        return np.array(((xx, xy, xz), (xy, yy, yz), (xz, yz, zz)))


def regroup(
    bodies: Sequence[Inertia],
    prismatic: Sequence[bool],
    turns: Sequence[Array],
    translations: Sequence[tuple[float, float, float]],
) -> list[Inertia]:
    """Move into each parent what the joint's own motion cannot tell from it.

    A turn about z leaves alone mass, moment along z and diag(J, J, 0); a slide leaves alone the
    whole rotational inertia. Attached to the parent these parts have the same kinetic energy in
    every motion.

    Args:
        bodies: inertias about the frames' origins, from the base.
        prismatic: per joint.
        turns: (3, 3) constant part of each joint's rotation, to the previous frame's axes.
        translations: each origin in the previous frame (m).
    """
    kept = list(bodies)
    for i in reversed(range(len(kept))):
        body = kept[i]
        xx, yy, zz, xy, xz, yz = body.tensor
        if prismatic[i]:
            mass, along, tensor = 0.0, np.zeros(3), body.matrix
            kept[i] = Inertia(body.mass, body.moment, (0.0,) * 6)
        else:
            mass, along = body.mass, np.array((0.0, 0.0, body.moment[2]))
            tensor = np.diag((yy, yy, 0.0))
            kept[i] = Inertia(
                0.0, (body.moment[0], body.moment[1], 0.0), (xx - yy, 0.0, zz, xy, xz, yz)
            )
        if i:
            turn = turns[i]
            kept[i - 1] = _join(
                kept[i - 1], mass, turn @ along, turn @ tensor @ turn.T, np.array(translations[i])
            )
    return kept


def _join(base: Inertia, mass: float, moment: Array, tensor: Array, at: Array) -> Inertia:
    """Add a body, given about the point `at` in axes parallel to the base's."""
    shifted = tensor + _about(at, moment) + _about(moment, at) + mass * _about(at, at)
    return Inertia.of_matrix(
        base.mass + mass, np.array(base.moment) + moment + mass * at, base.matrix + shifted
    )


def _about(a: Array, b: Array) -> Array:
    """The matrix (a . b) 1 - a b^T: -[a]x [b]x transposed."""
    return np.asarray((a @ b) * np.eye(3) - np.outer(a, b))


def _clean(values: Array) -> Array:
    return np.where(np.abs(values) <= NEGLIGIBLE * np.abs(values).max(initial=0.0), 0.0, values)
