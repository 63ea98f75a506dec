"""The whole arm as one free rigid body, as if every joint were locked: "composite".

Empirical, for arms under stiff velocity control: Wang, Dehio and Kheddar (RA-L 2022) found that it
predicts the jumps of a Panda's velocity better than J M^-1 J^T does.
"""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import pinocchio as pin

if TYPE_CHECKING:
    from hitjoints.model.robot import Contact, Robot
    from hitjoints.types import Array


class Bodies(NamedTuple):
    """An arm's constants: joint placements and axes, and each link's mass, centre and inertia."""

    rotation: Array
    translation: Array
    axis: Array
    prismatic: Array
    mass: Array
    centre: Array
    inertia: Array


def composite_inertia(robot: Robot, q: Array, contact: Contact, h: Array) -> Array:
    """Return 1 / (1/m + (r x h)^T I^-1 (r x h)), m, I and r about the arm's centre of mass.

    Args:
        robot: the arm. What is fixed to its base does not count.
        q: (N, n) rad.
        contact: on the arm.
        h: (3,) or (N, 3), unit.

    Returns:
        (N,) kg.
    """
    bodies = _bodies(robot)
    turns, places = _poses(bodies, q)
    centres = places + np.einsum("knij,kj->kni", turns, bodies.centre)
    mass = bodies.mass.sum()
    centre = np.einsum("k,kni->ni", bodies.mass, centres) / mass
    lever = centres - centre
    inertia = np.einsum("knij,kjl,knml->nim", turns, bodies.inertia, turns)
    square = np.einsum("k,kni,kni->n", bodies.mass, lever, lever)
    inertia += square[:, None, None] * np.eye(3)
    inertia -= np.einsum("k,kni,knj->nij", bodies.mass, lever, lever)
    at = contact.joint - 1
    point = places[at] + turns[at] @ np.array(contact.offset)
    twist = np.cross(point - centre, h)
    spin = np.linalg.solve(inertia, twist[:, :, None])[:, :, 0]
    return np.asarray(1.0 / (1.0 / mass + np.einsum("ni,ni->n", twist, spin)))


def _poses(bodies: Bodies, q: Array) -> tuple[Array, Array]:
    """Return the rotations (n, N, 3, 3) and origins (n, N, 3) of the links."""
    rows, n = q.shape
    turns, places = np.empty((n, rows, 3, 3)), np.empty((n, rows, 3))
    turn, place = np.broadcast_to(np.eye(3), (rows, 3, 3)), np.zeros((rows, 3))
    for k in range(n):
        place = place + turn @ bodies.translation[k]
        turn = turn @ bodies.rotation[k]
        if bodies.prismatic[k]:
            place = place + q[:, k, None] * (turn @ bodies.axis[k])
        else:
            turn = turn @ _about(bodies.axis[k], q[:, k])
        turns[k], places[k] = turn, place
    return turns, places


def _about(axis: Array, angle: Array) -> Array:
    """Return the rotations (N, 3, 3) by angles (N,) about an axis (3,)."""
    cross = np.cross(axis, np.eye(3)).T
    s, c = np.sin(angle)[:, None, None], np.cos(angle)[:, None, None]
    return np.asarray(np.eye(3) + s * cross + (1.0 - c) * (cross @ cross))


@lru_cache(maxsize=16)
def _bodies(robot: Robot) -> Bodies:
    from hitjoints.kernels.formulas.chain import joint_axes

    model: pin.Model = robot.model
    axes, prismatic = joint_axes(model)
    links = range(1, model.njoints)
    return Bodies(
        np.array([model.jointPlacements[i].rotation for i in links]),
        np.array([model.jointPlacements[i].translation for i in links]),
        np.array(axes),
        np.array(prismatic),
        np.array([model.inertias[i].mass for i in links]),
        np.array([model.inertias[i].lever for i in links]),
        np.array([model.inertias[i].inertia for i in links]),
    )
