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
    return _locked(robot, q).felt(contact, h)[0]


def composite_mobility(robot: Robot, q: Array, contact: Contact) -> Array:
    """Return the inverse inertia (3, 3) 1/kg of the locked arm at a contact, for one q (n,) rad."""
    body = _locked(robot, q[None])
    lever = np.cross((body.point(contact) - body.centre)[0], np.eye(3))  # rows r x e_i
    return np.asarray(np.eye(3) / body.mass + lever @ np.linalg.solve(body.inertia[0], lever.T))


def composite_inertia_gradient(robot: Robot, q: Array, contact: Contact, h: Array) -> Array:
    """Return the exact gradient of `composite_inertia` by the joint positions.

    A joint carries the links beyond it: what it turns or shifts moves their centres, turns their
    inertias, and shifts the common centre by their share of the mass.

    Args:
        robot: as `composite_inertia`.
        q: as `composite_inertia`.
        contact: as `composite_inertia`.
        h: as `composite_inertia`.

    Returns:
        (N, n) kg/rad.
    """
    body, bodies = _locked(robot, q), _bodies(robot)
    point, (value, spin) = body.point(contact), body.felt(contact, h)
    gradient = np.empty(q.shape)
    lever = body.centres - body.centre
    for k in range(q.shape[1]):
        axis = body.turns[k] @ bodies.axis[k]

        def velocity(of: Array, k: int = k, axis: Array = axis) -> Array:
            """Return how points (..., N, 3) beyond joint k move with it."""
            if bodies.prismatic[k]:
                return np.broadcast_to(axis, of.shape)
            return np.cross(axis, of - body.places[k])

        carried = bodies.mass[k:, None, None] * velocity(body.centres[k:])
        drift = carried.sum(axis=0) / body.mass
        moved = velocity(point) if contact.joint > k else np.zeros_like(point)
        twisted = np.cross(moved - drift, h)
        # About the common centre the first moments vanish: the drift leaves the inertia alone.
        twofold = 2.0 * np.einsum("kni,kni->n", lever[k:], carried)[:, None, None] * np.eye(3)
        outer = np.einsum("kni,knj->nij", lever[k:], carried)
        change = twofold - outer - outer.transpose(0, 2, 1)
        if not bodies.prismatic[k]:
            own = body.own[k:].sum(axis=0)
            turned = np.cross(axis[:, None, :], own.transpose(0, 2, 1)).transpose(0, 2, 1)
            change += turned + turned.transpose(0, 2, 1)
        slope = 2.0 * np.einsum("ni,ni->n", twisted, spin)
        slope -= np.einsum("ni,nij,nj->n", spin, change, spin)
        gradient[:, k] = -(value**2) * slope
    return gradient


class Locked(NamedTuple):
    """The arm as one body over rows of configurations, and what it is made of.

    Attributes:
        mass: kg.
        centre: (N, 3) m, of mass.
        inertia: (N, 3, 3) kg m^2 about it.
        turns: (n, N, 3, 3), rotations of the links.
        places: (n, N, 3) m, origins of the links.
        centres: (n, N, 3) m, centres of the links.
        own: (n, N, 3, 3) kg m^2, inertias of the links about their own centres.
    """

    mass: float
    centre: Array
    inertia: Array
    turns: Array
    places: Array
    centres: Array
    own: Array

    def point(self, contact: Contact) -> Array:
        """Return where a contact is, (N, 3) m."""
        at = contact.joint - 1
        return np.asarray(self.places[at] + self.turns[at] @ np.array(contact.offset))

    def felt(self, contact: Contact, h: Array) -> tuple[Array, Array]:
        """Return the inertia (N,) kg at a contact, and how a unit impulse turns the arm (N, 3)."""
        twist = np.cross(self.point(contact) - self.centre, h)
        spin: Array = np.asarray(np.linalg.solve(self.inertia, twist[:, :, None])[:, :, 0])
        return np.asarray(1.0 / (1.0 / self.mass + np.einsum("ni,ni->n", twist, spin))), spin


def _locked(robot: Robot, q: Array) -> Locked:
    bodies = _bodies(robot)
    turns, places = _poses(bodies, q)
    centres = places + np.einsum("knij,kj->kni", turns, bodies.centre)
    mass = float(bodies.mass.sum())
    centre = np.einsum("k,kni->ni", bodies.mass, centres) / mass
    lever = centres - centre
    own = np.einsum("knij,kjl,knml->knim", turns, bodies.inertia, turns)
    inertia = own.sum(axis=0)
    square = np.einsum("k,kni,kni->n", bodies.mass, lever, lever)
    inertia += square[:, None, None] * np.eye(3)
    inertia -= np.einsum("k,kni,knj->nij", bodies.mass, lever, lever)
    return Locked(mass, centre, inertia, turns, places, centres, own)


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
