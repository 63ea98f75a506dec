"""Draw an arm in one configuration, with what it hits."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from hitjoints.errors import InputError
from hitjoints.show.drawn_arm import BoxAt, add_ground, arm_picture, chain
from hitjoints.show.sheet import below

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import ArrayLike

    from hitjoints.model.robot import Contact, Robot


def draw_arm(
    axis: Axes,
    robot: Robot,
    q: ArrayLike,
    contact: Contact | int | None,
    direction: ArrayLike | None,
    object_size: ArrayLike | None,
    *,
    ellipsoid: bool = True,
) -> None:
    """Draw it on an axis; see `hitjoints.show.figures.arm`.

    Raises:
        InputError: a box without a contact and a direction.
    """
    configuration = robot.one_configuration(q)
    box, seen = None, [chain(robot, configuration)]
    if object_size is not None:
        if contact is None or direction is None:
            raise InputError("object_size", object_size, "a contact and a direction place the box")
        along = np.asarray(direction, dtype=float)
        hits = robot.contact(contact)
        box = BoxAt.touched(robot, configuration, hits, along, object_size)
        seen.append(box.corners)
    picture, handles = arm_picture(robot, q, contact, direction, box=box, ellipsoid=ellipsoid)
    grid = add_ground(picture, np.vstack(seen))
    picture.draw(axis)
    axis.set_title(f"{robot.name}; {grid}")
    if handles:
        below(axis, 0.5, 2, handles=handles)
