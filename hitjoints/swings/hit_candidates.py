"""Where a swing may strike: configurations, what each delivers, and whether it is clear there."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin

from hitjoints.quantities import place_joint
from hitjoints.swings.clear_way import Obstacle, axes_along
from hitjoints.swings.hit_samples import Samples, draw, folded, joined, measured, spread_out

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from hitjoints.swings.swing_task import SwingTask
    from hitjoints.types import Array

HOLDING = 0.95
"""Share of the torque limits that gravity may take at the impact."""
BEFORE = 0.06
"""m, how far back on its straight way a configuration has to be clear of the object."""
SLOW = 1e-3
"""m/s, least speed that such a way is told of."""
NOT_CLEAR, NOT_BEFORE = "not clear at the impact", "not clear before the impact"
GRAVITY, STANDS = "gravity", "the object is where the arm stands"
BEST, AROUND, APART = 8, 48, 0.5
"""Of the best configurations, these rad from each other, so many each are looked at around them,"""
WORTH = 0.85
"""provided that they deliver this share of the greatest flux;"""
NEARBY = (0.3, 0.1)
"""rad, within so much of them: once for each."""
GAIN = 1e-3
"""Share by which the greatest flux has to grow for looking further."""
LONGEST = 12
"""Rounds of that."""


class HitCandidates:
    """Configurations of one arm for one hit.

    Args:
        task: what the swing is asked.
        seed: of the samples.
        first: (n,) rad, a configuration to have before all others.

    Raises:
        InfeasibleError: the object is out of reach.
    """

    def __init__(self, task: SwingTask, seed: int, first: Array | None = None) -> None:
        self._robot, self._hit, self._limits, self._room, self._start = task
        robot, hit, start = self._robot, self._hit, self._start
        self._rng = np.random.default_rng(seed)
        self._contact = robot.contact(hit.chosen_contact)
        self._axes = axes_along(hit.direction, hit.yaw)
        drawn = draw(robot, hit, start, seed)
        if first is not None:
            drawn = np.concatenate((folded(robot, first[None], start), drawn))
        self.samples: Samples = measured(robot, hit, self._limits, drawn)
        self._seen: dict[int, tuple[Obstacle | None, str]] = {}

    @property
    def greatest(self) -> float:
        """The greatest flux (m/s) of all, clear or not."""
        return float(self.samples.flux.max(initial=0.0))

    def rows(self, flux: float, near: int = 1) -> Iterator[int]:
        """Yield those that deliver a flux (m/s): some near the start, then different ones."""
        chosen = np.flatnonzero(self.samples.flux >= flux)
        return spread_out(self._robot, self._hit, self.samples, chosen, self._start, near)

    def clear(self, row: int) -> tuple[Obstacle | None, str]:
        """Return the object as a configuration hits it, and what is in the way there."""
        if row not in self._seen:
            self._seen[row] = self._look(row)
        return self._seen[row]

    def improve(self) -> float:
        """Look around the best that are clear, and return the greatest flux (m/s) of such."""
        best = self._best(clear=True)
        for near in NEARBY:
            if not best.size:
                return 0.0
            self._look_around(best, near)
            best = self._best(clear=True)
        return float(self.samples.flux[best].max(initial=0.0))

    def find_greatest(self) -> float:
        """Look around the best, clear or not, until there is no more to gain."""
        before = 0.0
        for _ in range(LONGEST):
            if self.greatest <= before * (1.0 + GAIN):
                break
            before = self.greatest
            for near in NEARBY:
                self._look_around(self._best(clear=False), near)
        return self.greatest

    def _best(self, *, clear: bool) -> NDArray[np.intp]:
        """Return the best configurations that are not nearly the same."""
        found: list[int] = []
        q, flux = self.samples.q, self.samples.flux
        for row in np.argsort(-flux, kind="stable"):
            least = WORTH * flux[found[0]] if found else 0.0
            if len(found) == BEST or flux[row] <= least:
                break
            apart = (np.abs(q[found] - q[row]).max(axis=1, initial=0.0) >= APART).all()
            if apart and not (clear and self.clear(int(row))[1]):
                found.append(int(row))
        return np.array(found, dtype=np.intp)

    def _look_around(self, rows: NDArray[np.intp], near: float) -> None:
        centres = np.repeat(self.samples.q[rows], AROUND, axis=0)
        begun = centres + self._rng.uniform(-near, near, centres.shape)
        begun = np.clip(begun, self._robot.lower, self._robot.upper)
        target = np.tile(self._hit.position, (len(begun), 1))
        placed = place_joint(self._robot, self._contact, target, start=begun)
        more = placed.q[placed.solved]
        self.samples = joined(self.samples, measured(self._robot, self._hit, self._limits, more))

    def _look(self, row: int) -> tuple[Obstacle | None, str]:
        robot, room, h = self._robot, self._room, self._hit.direction
        q, qd = self.samples.q[row], self.samples.qd[row]
        gravity = pin.computeGeneralizedGravity(robot.model, robot.data, q)
        if (np.abs(gravity) > HOLDING * self._limits.effort).any():
            return None, GRAVITY
        if room.touches(q, None):
            return None, NOT_CLEAR
        box = room.box(q, self._contact, h, self._axes)
        if room.touches(q, box):
            return box, NOT_CLEAR
        whole = room.whole(box)
        if room.touches(self._start, whole):
            return box, STANDS
        speed = max(float(h @ self.samples.J[row] @ qd), SLOW)
        before = np.clip(q - qd * (BEFORE / speed), robot.lower, robot.upper)
        return box, NOT_BEFORE if room.touches(before, whole) else ""
