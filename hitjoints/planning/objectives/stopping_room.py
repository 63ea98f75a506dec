"""Room for an arm to come from rest and to stop again, as constraints on positions and velocities.

A joint of speed v needs w(v) = (v^2 / a + v a / j) / 2 on either side, see `velocity_box`: the same
limits, as inequalities that are smooth where the box has edges.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from hitjoints.hitting.drive_limits import WITHIN, DriveLimits
from hitjoints.hitting.velocity_box import ROOM, velocity_box
from hitjoints.kernels.tape.trace import absolute, minimum, where_less

if TYPE_CHECKING:
    from collections.abc import Sequence

    from hitjoints.kernels.tape.trace import Scalar
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

    def formulas(
        self, q: Sequence[Scalar], qd: Sequence[Scalar]
    ) -> list[tuple[Scalar, list[Scalar]]]:
        """Return each constraint's excess (rad) over the room there is, and its gradient (2 n)."""
        a, j = self.limits.acceleration_used, self.limits.jerk_used
        n, constraints = len(q), []
        for i, side in zip(self.joint.tolist(), self.side.tolist(), strict=True):
            behind, ahead = q[i] - float(self.lower[i]), float(self.upper[i]) - q[i]
            fast, steady = 0.5 / ROOM / float(a[i]), 0.5 / ROOM * float(a[i] / j[i])
            speed = absolute(qd[i])
            rate = 2.0 * fast * speed + steady
            slope: list[Scalar] = [0.0] * (2 * n)
            if side == 0:  # the nearer limit
                room = minimum(behind, ahead)
                slope[i] = where_less(behind, ahead, -1.0, 1.0)
            else:
                room, slope[i] = (behind, -1.0) if side < 0 else (ahead, 1.0)
            slope[n + i] = where_less(0.0, qd[i], rate, where_less(qd[i], 0.0, -rate, 0.0))
            constraints.append((speed * (fast * speed + steady) - room, slope))
        return constraints

    def _way(self, speed: Array) -> Array:
        """Return w(v) (N, n) rad for speeds (N, n), or (n,) for (n,)."""
        a, j = self.limits.acceleration_used, self.limits.jerk_used
        return np.asarray((speed**2 / a + speed * a / j) / (2.0 * ROOM))
