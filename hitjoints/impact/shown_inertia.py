"""What an arm shows an object in a hit, by the model of its drives that the hit is reckoned with.

Links and rotors are in a mass matrix; by "composite" and "elastic" the arm is what these return.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from hitjoints.dynamics.inertia import inverse_inertia
from hitjoints.impact.composite import composite_inertia, composite_mobility
from hitjoints.impact.elastic import elastic_impact
from hitjoints.quantities import directional_inertia

if TYPE_CHECKING:
    from hitjoints.hit import Hit
    from hitjoints.model.robot import Contact, Robot
    from hitjoints.types import Array

IMMOVABLE = 1e6
"""kg, for an object that is faster than any inertia makes it."""


def shown_inertia(robot: Robot, q: Array, contact: Contact, hit: Hit) -> Array:
    """Return the inertia that counts in Eq. 3 and 4, by the model of drives in the hit's setting.

    An elastic hit is linear in the speed, so that what it shows does not depend on it.

    Args:
        robot: the arm, without its rotors.
        q: (N, n) rad.
        contact: on the arm.
        hit: its direction, mass and model, and its restitution if it has one.

    Returns:
        (N,) kg; not finite, or zero, where the contact cannot move along the direction.
    """
    drives = hit.setting.drives
    if drives.in_mass_matrix:
        return np.asarray(directional_inertia(drives.arm(robot), q, contact, hit.direction))
    if drives.model == "composite":
        return composite_inertia(robot, q, contact, hit.direction[None])
    return np.array([_elastic(robot, row, contact, hit) for row in q])


def shown_mobility(robot: Robot, q: Array, contact: Contact, hit: Hit) -> Array:
    """Return the inverse inertia (3, 3) 1/kg of the contact by that model, at one q (n,).

    By "elastic" it is that of the links, scaled to what is shown along the direction.
    """
    drives = hit.setting.drives
    if drives.model == "composite":
        return composite_mobility(robot, q, contact)
    links = inverse_inertia(drives.arm(robot), q, contact)
    if drives.in_mass_matrix:
        return links
    along = float(hit.direction @ links @ hit.direction)
    return np.asarray(links / (along * _elastic(robot, q, contact, hit)))


def _elastic(robot: Robot, q: Array, contact: Contact, hit: Hit) -> float:
    drives = hit.setting.drives
    restitution = drives.restitution if hit.restitution is None else hit.restitution
    made = elastic_impact(
        robot, q, contact, hit.direction, hit.mass, 1.0, restitution, drives.contact_time,
        drives.stiffness, rotor_inertia=drives.rotor_inertia,
    )  # fmt: skip
    return IMMOVABLE if made.equivalent is None else min(made.equivalent, IMMOVABLE)
