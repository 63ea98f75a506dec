"""What feasibility is learnt from: hits, the greatest flux of each, a configuration that has it."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from hitjoints.errors import InputError
from hitjoints.planning.learning.greatest_flux import flux_of, maximum_flux, random_positions
from hitjoints.planning.learning.similar_hits import features, turned
from hitjoints.quantities import place_joint
from hitjoints.vectors import unit

if TYPE_CHECKING:
    from xarray import Dataset

    from hitjoints.model.robot import Contact, Robot
    from hitjoints.types import Array

LEAST_SCALE = 1e-3
"""Of a feature that hardly varies."""
NEIGHBOURS = 6
"""Similar hits whose configurations are tried to better the one of a hit."""
ROUNDS = 3
"""Of that: what is found spreads."""


class SweptHits(NamedTuple):
    """Hits, T of them.

    Attributes:
        at: (T, 3) m.
        h: (T, 3).
        flux: (T,) m/s, 0 where there is none.
        q: (T, n) rad, of any number where there is none.
    """

    at: Array
    h: Array
    flux: Array
    q: Array


def sampled_hits(
    robot: Robot,
    contact: Contact,
    mass: float,
    counts: tuple[int, int, int],
    rng: np.random.Generator,
    seed: int,
) -> SweptHits:
    """Return random hits and the greatest flux (Eq. 10) that sampling finds for them.

    Args:
        robot: the arm.
        contact: what hits.
        mass: of the object, kg.
        counts: positions, random directions for each, configurations for each.
        rng: of the hits.
        seed: of the configurations.
    """
    neighbours = import_module("sklearn.neighbors").NearestNeighbors
    positions, directions, samples = counts
    at = random_positions(robot, contact, positions, rng)
    h = unit(rng.normal(size=(directions, positions, 3)).reshape(-1, 3))
    flux, q = maximum_flux(robot, contact, mass, at, h, samples, seed)
    at = np.tile(at, (directions, 1))
    hits, azimuth = features(robot, at, h)
    reached = np.flatnonzero(flux > 0)
    if reached.size < 2:
        return SweptHits(at, h, flux, q)
    seen = turned(robot, q[reached], -azimuth[reached], limited=False)
    scale = np.maximum(hits.std(axis=0), LEAST_SCALE)
    count = min(NEIGHBOURS, reached.size - 1)
    similar = neighbours(n_neighbors=count).fit(hits[reached] / scale).kneighbors()[1]
    for column in np.tile(similar, ROUNDS).T:
        start = turned(robot, seen[column], azimuth[reached])
        better = place_joint(robot, contact, at[reached], seed, start=start)
        gained = flux_of(robot, contact, mass, better.q, h[reached])
        won = np.flatnonzero(better.solved & (gained > flux[reached]))
        flux[reached[won]], q[reached[won]] = gained[won], better.q[won]
        seen[won] = turned(robot, better.q[won], -azimuth[reached[won]], limited=False)
    return SweptHits(at, h, flux, q)


def hits_of_map(robot: Robot, contact: Contact, mass: float, swept: Dataset) -> SweptHits:
    """Return the hits of a map over object positions, and the flux it holds for them.

    Args:
        robot: the arm.
        contact: what hits.
        mass: of the object, kg.
        swept: as `sweep_workspace` or `sweep_motion` returns it.

    Raises:
        InputError: it is no such map, or one of another robot, contact or mass.
    """
    attributes = getattr(swept, "attrs", {})
    if not {"joints", "offsets", "mass", "robot_digest", "grid"} <= attributes.keys():
        raise InputError("swept", type(swept).__name__, "a map over object positions")
    contacts = [
        (int(joint), tuple(map(float, offset)))
        for joint, offset in zip(attributes["joints"], attributes["offsets"], strict=True)
    ]
    for name, found, wanted in (
        ("robot", attributes["robot_digest"], robot.digest),
        ("mass", float(attributes["mass"]), float(mass)),
    ):
        if found != wanted:
            raise InputError("swept", found, f"a map with {name} {wanted}")
    if (contact.joint, tuple(contact.offset)) not in contacts:
        raise InputError("swept", contacts, f"a map with joint {contact.joint} {contact.offset}")
    part = swept.isel(joint=contacts.index((contact.joint, tuple(contact.offset))))
    part = part.transpose("direction", "x", "y", "z", ...)
    directions = part.direction_vector.values
    mesh = np.meshgrid(part.x.values, part.y.values, part.z.values, indexing="ij")
    at = np.tile(np.stack([m.ravel() for m in mesh], axis=1), (len(directions), 1))
    h = np.repeat(directions, len(at) // len(directions), axis=0)
    flux = np.nan_to_num(part.flux.values.ravel(), nan=0.0)
    q = np.nan_to_num(part.q.values.reshape(-1, robot.n), nan=0.0)
    return SweptHits(at, h, flux, q)
