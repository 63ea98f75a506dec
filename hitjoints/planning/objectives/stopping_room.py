"""Room for an arm to come from rest and to stop again, as constraints on positions and velocities.

A joint of speed v needs w(v) = (v^2 / a + v a / j) / 2 on either side, see `velocity_box`: the same
limits, as inequalities that are smooth where the box has edges.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from hitjoints.hitting.drive_limits import WITHIN, DriveLimits
from hitjoints.hitting.velocity_box import ROOM, velocity_box

if TYPE_CHECKING:
    from hitjoints.types import Array


class StoppingRoom:
    """The constraints of the joints that move a contact.

    Args:
        limits: of the drives.
        lower: (n,) rad, lower position limits.
        upper: (n,) rad, upper position limits.
        movers: how many joints, from the base, move the contact.
    """

    def __init__(self, limits: DriveLimits, lower: Array, upper: Array, movers: int) -> None:
        self.limits, self.lower, self.upper = limits, lower, upper
        bounded = np.isfinite(lower) & np.isfinite(upper) & (np.arange(len(lower)) < movers)
        fastest = np.maximum(-limits.velocity_lower, limits.velocity_upper)
        # Mostly only the nearer limit matters: in the middle a joint may be as fast as it can.
        narrow = 0.5 * (upper - lower) <= self._way(fastest)
        rows = [(i, side) for i in np.flatnonzero(bounded & narrow) for side in (-1, 1)]
        rows += [(i, 0) for i in np.flatnonzero(bounded & ~narrow)]
        self.joint = np.array([i for i, _ in rows], dtype=int)
        self.side = np.array([side for _, side in rows], dtype=int)

    @property
    def slowest_fastest(self) -> tuple[Array, Array]:
        """Velocity limits, (n,) rad/s each."""
        return WITHIN * self.limits.velocity_lower, WITHIN * self.limits.velocity_upper

    def box(self, q: Array) -> tuple[Array, Array]:
        """Return the velocity boxes at q (N, n), (N, n) rad/s each."""
        return velocity_box(self.limits, q, self.lower, self.upper)

    def constraints(self, q: Array, qd: Array) -> tuple[Array, Array]:
        """Return the excess (N, c) rad over the room there is, and its derivatives (N, c, 2 n)."""
        joint, n = self.joint, q.shape[1]
        behind = q[:, joint] - self.lower[joint]
        ahead = self.upper[joint] - q[:, joint]
        back = np.where(self.side == 0, behind < ahead, self.side < 0)
        excess = self._way(np.abs(qd))[:, joint] - np.where(back, behind, ahead)
        slope = np.zeros((len(q), len(joint), 2 * n))
        rows = np.arange(len(joint))
        slope[:, rows, joint] = np.where(back, -1.0, 1.0)
        slope[:, rows, n + joint] = (np.sign(qd) * self._rate(np.abs(qd)))[:, joint]
        return excess, slope

    def _way(self, speed: Array) -> Array:
        """Return w(v) (N, n) rad for speeds (N, n), or (n,) for (n,)."""
        a, j = self.limits.acceleration_used, self.limits.jerk_used
        return np.asarray((speed**2 / a + speed * a / j) / (2.0 * ROOM))

    def _rate(self, speed: Array) -> Array:
        """Return dw/dv."""
        a, j = self.limits.acceleration_used, self.limits.jerk_used
        return np.asarray((2.0 * speed / a + a / j) / (2.0 * ROOM))
