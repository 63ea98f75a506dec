"""The directions a contact moves in at an object, and those it never moves in.

Some contacts have a Jacobian of rank two or one in every configuration: an elbow moves on a sphere
about the shoulder. A description with rounded angles makes that nearly so, with a last singular
value of 1e-7 m/rad where the others are 0.3. Taken for real, it would tie the contact to single
points of its self-motion, and the fastest straight motion to a crawl. Such directions are blind
here: the contact does not move along them, and counts as placed when it misses by less along them
than a plan promises.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from hitjoints.dynamics.kinematics import jacobian
from hitjoints.quantities import place_joint
from hitjoints.tolerances import rank_floor

if TYPE_CHECKING:
    from hitjoints.model.robot import Contact, Robot
    from hitjoints.types import Array

SLACK = 5e-7
"""m along a blind direction that a contact may miss the object by: half of what a plan promises."""

PROBES = 64


@dataclass(frozen=True)
class Freedom:
    """Where a contact can move, from one object; the same in all configurations that reach it.

    Attributes:
        seen: (r, 3) orthonormal, the directions it moves in.
        forward: (3,) the hitting direction without its blind part.
        sideways: (c, 3) orthonormal, the directions across the hit that it moves in.
        slack: m that it may miss the object by along what is not seen.
    """

    seen: Array
    forward: Array
    sideways: Array
    slack: float

    def misses(self, distance: Array) -> Array:
        """Tell which distances (N, 3) m are too long where the contact cannot do anything."""
        blind = distance - distance @ self.seen.T @ self.seen
        return np.asarray((blind**2).sum(axis=1) > self.slack**2)


def free(h: Array, across: Array) -> Freedom:
    """Return the freedom of a contact that moves in all directions.

    Args:
        h: (3,) unit vector.
        across: (2, 3) orthonormal to it.
    """
    return Freedom(np.eye(3), h, across, np.inf)


def freedom(
    robot: Robot, contact: Contact, position: Array | None, q: Array, h: Array, across: Array
) -> Freedom:
    """Return the freedom of a contact at an object.

    Args:
        robot: the arm.
        contact: what hits.
        position: (3,) m; None for where q puts the contact.
        q: (n,) rad.
        h: (3,) unit vector.
        across: (2, 3) orthonormal to it.
    """
    if not is_blind(robot, contact):
        return free(h, across)
    if position is not None:
        q = place_joint(robot, contact, np.tile(position, (PROBES, 1))).q
    jacobians = np.array([jacobian(robot, row, contact) for row in np.atleast_2d(q)])
    axes, size, _ = np.linalg.svd(jacobians, full_matrices=False)
    rank = (size > rank_floor(jacobians)[:, None]).sum(axis=1)
    # The clearest of the configurations tells: near singular ones the directions are blurred.
    most = int(rank.max())
    clear = np.argmax(np.where(rank == most, size[:, most - 1], 0.0)) if most else 0
    seen = axes[clear, :, :most].T
    turn, size, _ = np.linalg.svd(across @ seen.T @ seen @ jacobians[clear], full_matrices=False)
    kept = turn.T[size > rank_floor(jacobians[clear])]
    sideways = kept @ across @ seen.T @ seen
    return Freedom(seen, h @ seen.T @ seen, sideways, SLACK)


@lru_cache(maxsize=64)
def is_blind(robot: Robot, contact: Contact) -> bool:
    """Tell whether the contact's Jacobian has a rank below three in all configurations."""
    low, high = robot.finite_limits
    q = np.random.default_rng(0).uniform(low, high, (PROBES, robot.n))
    jacobians = np.array([jacobian(robot, row, contact) for row in q])
    size = np.linalg.svd(jacobians, compute_uv=False)
    return size.shape[1] < 3 or bool((size[:, 2] <= rank_floor(jacobians)).all())


def blind_slack(robot: Robot, contact: Contact) -> float:
    """Return by how much (m) a contact may miss the object along blind directions."""
    return SLACK if is_blind(robot, contact) else 0.0
