"""The way of a sliding box along time, from the steps of its integration."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from hitjoints.types import Array


@dataclass(frozen=True, eq=False)
class SlidePath:
    """How a box slides to rest.

    Attributes:
        times: (K,) s since the hit, ascending from 0.
        displacement: (K, 2) m, of the centre, base frame.
        velocity: (K, 2) m/s.
        turned: (K,) rad, about the vertical.
    """

    times: Array
    displacement: Array
    velocity: Array
    turned: Array

    @property
    def duration(self) -> float:
        """Until it rests, s."""
        return float(self.times[-1])

    def at(self, time: float) -> tuple[Array, float]:
        """Return displacement (2,) m and turn (rad) at a time (s), at rest before and after.

        Between two steps the way is the cubic of their places and velocities: exact for a box that
        slides without turning.
        """
        t = min(max(time, 0.0), self.duration)
        i = int(np.clip(np.searchsorted(self.times, t) - 1, 0, max(len(self.times) - 2, 0)))
        if len(self.times) == 1:
            return self.displacement[0], float(self.turned[0])
        step = self.times[i + 1] - self.times[i]
        s = (t - self.times[i]) / step
        ends = self.displacement[i], self.displacement[i + 1]
        speeds = step * self.velocity[i], step * self.velocity[i + 1]
        place = ends[0] + s * speeds[0] + s**2 * (3 * (ends[1] - ends[0]) - 2 * speeds[0])
        place = place - s**2 * speeds[1]
        place = place + s**3 * (2 * (ends[0] - ends[1]) + speeds[0] + speeds[1])
        return place, float(np.interp(t, self.times, self.turned))
