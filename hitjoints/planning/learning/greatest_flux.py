"""The greatest flux at many positions, by sampling: what feasibility is learnt from."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from hitjoints.built import kernel_for
from hitjoints.quantities import place_joint

if TYPE_CHECKING:
    from hitjoints.model.robot import Contact, Robot
    from hitjoints.types import Array

BEYOND = 1 / 3  # share of the positions drawn from the box round the workspace


def random_positions(robot: Robot, contact: Contact, count: int, rng: np.random.Generator) -> Array:
    """Return positions (N, 3) m: two thirds of random configurations, the rest of the box round."""
    q = rng.uniform(*robot.finite_limits, (count, robot.n))
    kernel = kernel_for(robot, (contact,), ("position",))
    at = np.array(kernel(q, np.array([1.0, 0.0, 0.0]))["position"][0])
    beyond = int(BEYOND * count)
    at[:beyond] = rng.uniform(at.min(axis=0), at.max(axis=0), (beyond, 3))
    return at


def maximum_flux(
    robot: Robot,
    contact: Contact,
    mass: float,
    positions: Array,
    directions: Array,
    samples: int,
    seed: int,
) -> tuple[Array, Array]:
    """Return the greatest flux of sampled configurations, and which has it.

    Args:
        robot: the arm.
        contact: what hits.
        mass: of the object, kg.
        positions: (P, 3) m.
        directions: (D P, 3) unit vectors, the P positions' first directions first.
        samples: configurations per position.
        seed: of those.

    Returns:
        (D P,) m/s, 0 where the position is out of reach; (D P, n) rad.
    """
    placed = place_joint(robot, contact, np.repeat(positions, samples, axis=0), seed)
    rows, each = (len(positions), samples), np.arange(len(positions))
    flux, q = np.empty(len(directions)), np.empty((len(directions), robot.n))
    for first in range(0, len(directions), len(positions)):
        block = slice(first, first + len(positions))
        along = np.repeat(directions[block], samples, axis=0)
        values = np.where(placed.solved, flux_of(robot, contact, mass, placed.q, along), 0.0)
        best = values.reshape(rows).argmax(axis=1)
        flux[block] = values.reshape(rows)[each, best]
        q[block] = placed.q.reshape(*rows, -1)[each, best]
    return flux, q


def flux_of(robot: Robot, contact: Contact, mass: float, q: Array, h: Array) -> Array:
    """Return the maximum flux (N,) m/s at configurations (N, n) along directions (N, 3)."""
    return np.asarray(kernel_for(robot, (contact,), ("flux",))(q, h, mass)["flux"][0])
