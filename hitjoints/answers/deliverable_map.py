"""What an arm can deliver to an object, at many places and in many directions: one batch."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from hitjoints.built import kernel_for
from hitjoints.hitting.drive_limits import drive_limits
from hitjoints.model.robot import Contact
from hitjoints.quantities import place_joint
from hitjoints.swings.hit_samples import measured

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from hitjoints.hit import Hit
    from hitjoints.model.robot import Robot
    from hitjoints.types import Array

SAMPLES = 40
"""Configurations of a contact at a place."""


class Deliverable(NamedTuple):
    """The most that the samples deliver at P places, in D directions, with C contacts.

    Attributes:
        flux: (P, D, C) m/s, straight, from rest to rest; 0 where there is none.
        inertia: (P, D, C) kg, of the configuration that delivers it.
    """

    flux: Array
    inertia: Array


def deliverable_map(
    robot: Robot,
    hit: Hit,
    contacts: Sequence[Contact],
    places: Array,
    directions: Array,
    *,
    samples: int = SAMPLES,
) -> Deliverable:
    """Return the greatest flux that each contact delivers at places, in directions.

    A lower bound, by samples of the configurations that hold the contact there.

    Args:
        robot: the arm; its acceleration limits have to be known.
        hit: what is hit, and how: the object's mass, the away condition, the drives, the seed.
        contacts: what may hit.
        places: (P, 3) m.
        directions: (D, 3), unit.
        samples: of each contact at each place.
    """
    limits, shape = drive_limits(robot), (len(places), len(directions), len(contacts))
    flux, inertia = np.zeros(shape), np.zeros(shape)
    for c, contact in enumerate(contacts):
        placed = place_joint(robot, contact, np.repeat(places, samples, axis=0), hit.setting.seed)
        q = np.ascontiguousarray(placed.q[placed.solved])
        at = np.repeat(np.arange(len(places)), samples)[placed.solved]
        if not len(q):
            continue
        ends = Contact(contact.joint), robot.beyond(contact)
        where = kernel_for(robot, ends, ("position",))(q, directions[0])["position"]
        ahead = np.asarray(where[1] - where[0])
        for d, h in enumerate(directions):
            found = measured(robot, along(hit, h).with_contact(contact), limits, q)
            behind = ahead @ h < 0
            most = np.where(behind, found.flux, 0.0) if hit.setting.away else found.flux
            order = np.argsort(most, kind="stable")  # of rows at one place, the last one stays
            flux[at[order], d, c] = most[order]
            inertia[at[order], d, c] = found.inertia[order]
    return Deliverable(flux, inertia)


def along(hit: Hit, direction: ArrayLike) -> Hit:
    """Return the same hit along a direction (3,), however hard."""
    return hit.changed(goal=None, object_speed=None, flux=None, direction=direction)
