"""The configuration of greatest manipulability at a position: q_m of Eq. 7."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from hitjoints.dynamics.kinematics import manipulability
from hitjoints.errors import InfeasibleError
from hitjoints.quantities import place_joint

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from hitjoints.model.robot import Contact, Robot
    from hitjoints.types import Array

SAMPLES = 2000
NEARLY = 0.99
"""Share of the greatest manipulability that counts as the greatest."""


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
    contact, q = robot.contact(contact), robot.one_configuration(near)
    best = _best(robot, contact, tuple(np.asarray(position, dtype=float).tolist()))
    first_idle = contact.joint if any(contact.offset) else contact.joint - 1
    best = best.copy()
    best[:, first_idle:] = np.clip(q, robot.lower, robot.upper)[first_idle:]
    return np.array(best[np.argmin(np.linalg.norm(best - q, axis=1))])


@lru_cache(maxsize=64)
def _best(robot: Robot, contact: Contact, position: tuple[float, ...]) -> Array:
    placed = place_joint(robot, contact, np.tile(position, (SAMPLES, 1)))
    if not placed.solved.any():
        raise InfeasibleError(
            f"the position is out of reach: joint {contact.joint} comes no nearer than "
            f"{placed.error.min():.3g} m",
            {"joint": contact.joint, "nearest": float(placed.error.min())},
        )
    found = placed.q[placed.solved]
    measures = np.array([manipulability(robot, q, contact) for q in found])
    best = found[measures >= NEARLY * measures.max()]
    best.setflags(write=False)
    return np.asarray(best)
