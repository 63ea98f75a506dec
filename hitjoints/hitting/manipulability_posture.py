"""The configuration of greatest manipulability at a position: q_m of Eq. 7."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from hitjoints.built import kernel_for
from hitjoints.errors import InfeasibleError
from hitjoints.quantities import place_joint

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from hitjoints.model.robot import Contact, Robot
    from hitjoints.types import Array

SAMPLES = 2000
NEARLY = 0.99
"""Share of the greatest manipulability that counts as the greatest."""
NOISE = 1e-12
"""m^3/rad^3 that count as none: of a point that two joints move all postures are equally bad."""


def most_manipulable(
    robot: Robot, contact: Contact | int, position: ArrayLike, near: ArrayLike
) -> Array:
    """Return the configuration of greatest manipulability that puts a contact at a position.

    Mirror images of an arm are equally manipulable: of the samples within 1 % of the best the one
    nearest to `near` is taken. Joints that do not move the contact do not matter and stay there.

    Args:
        robot: the arm.
        contact: joint number or Contact.
        position: (3,) m.
        near: (n,) rad.

    Returns:
        (n,) rad, within the limits.

    Raises:
        InputError: an argument cannot be used.
        InfeasibleError: the position is out of the contact's reach.
    """
    q = robot.one_configuration(near)
    at = tuple(np.asarray(position, dtype=float).tolist())
    return np.array(nearest_best(robot, robot.contact(contact), at, q[None, :])[0])


def nearest_best(
    robot: Robot, contact: Contact, position: tuple[float, float, float], near: Array
) -> Array:
    """Return the same (N, n) for several configurations `near` (N, n) rad, checked arguments.

    Raises:
        InfeasibleError: the position is out of the contact's reach.
    """
    best = _best(robot, contact, position)
    first_idle = contact.joint if any(contact.offset) else contact.joint - 1
    idle = np.clip(near, robot.lower, robot.upper)[:, first_idle:]
    found = np.empty_like(near)
    found[:, first_idle:] = idle
    moving = slice(0, first_idle)
    kept = ((idle - near[:, first_idle:]) ** 2).sum(axis=1)
    for i, q in enumerate(near):
        away = ((best[:, moving] - q[moving]) ** 2).sum(axis=1) + kept[i]
        found[i, moving] = best[np.argmin(np.sqrt(away)), moving]
    return found


@lru_cache(maxsize=64)
def _best(robot: Robot, contact: Contact, position: tuple[float, float, float]) -> Array:
    placed = place_joint(robot, contact, np.tile(position, (SAMPLES, 1)))
    if not placed.solved.any():
        raise InfeasibleError(
            f"the position is out of reach: joint {contact.joint} comes no nearer than "
            f"{placed.error.min():.3g} m",
            {"joint": contact.joint, "nearest": float(placed.error.min())},
        )
    found = placed.q[placed.solved]
    measures = _manipulability(robot, contact, found)
    best = found[measures >= NEARLY * measures.max() - NOISE]
    best.setflags(write=False)
    return np.asarray(best)


def _manipulability(robot: Robot, contact: Contact, q: Array) -> Array:
    """Return sqrt(det(J J^T)) (N,) of configurations (N, n)."""
    any_direction = np.array([1.0, 0.0, 0.0])
    J = kernel_for(robot, (contact,), ("jacobian",))(q, any_direction)["jacobian"][0]
    x, y, z = (J[:, axis] for axis in range(3))
    # The volume that the rows span: each row's part across the ones before it.
    y = y - _along(y, x) * x
    z = z - _along(z, x) * x
    z = z - _along(z, y) * y
    return np.asarray(np.prod([np.sqrt((row * row).sum(axis=1)) for row in (x, y, z)], axis=0))


def _along(a: Array, b: Array) -> Array:
    """Return (N, 1), a . b / b . b of rows (N, n); 0 where b is zero."""
    square = (b * b).sum(axis=1, keepdims=True)
    return np.asarray((a * b).sum(axis=1, keepdims=True) / np.where(square > 0, square, 1.0))
