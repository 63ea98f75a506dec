"""The planning problems: what is maximised over which configurations, with exact gradients.

Objectives are maximised as logarithms, so that tolerances are relative and every part adds up.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from hitjoints.built import kernel_for
from hitjoints.hitting.drive_limits import drive_limits
from hitjoints.kernels import Chain
from hitjoints.kernels.formulas.speeds import lateral
from hitjoints.planning.objectives.freedom import freedom, is_blind
from hitjoints.planning.objectives.geometry import Axes
from hitjoints.planning.objectives.sight import Sight
from hitjoints.planning.objectives.stopping_room import StoppingRoom
from hitjoints.planning.objectives.straight import straight_velocities
from hitjoints.planning.search.climb import Values

if TYPE_CHECKING:
    from hitjoints.planning.objectives.objective import Objective
    from hitjoints.planning.task import Task
    from hitjoints.types import Array

AWAY_MARGIN = 1e-6
"""The away condition is strict; h . (chi_{k+1} - chi_k) <= -1e-6 m is closed, and implies it."""

FLUX_MARGIN = 1e-9
"""A required flux is exceeded by this share, so that rounding cannot leave it short."""

KERNEL = ("mobility", "mobility_gradient", "speed", "position", "jacobian")
"""Outputs of the one kernel a hit needs, but for straight-flux, which screens with a second."""


class HitProblem:
    """A task's objective, constraints and bounds over x = q, or x = (q, qd) when moving.

    Args:
        task: what is asked.
        objective: what is maximised.
        flux: m/s that must be reached at least, if any.
        deliverable: that flux is one that a motion from rest to rest delivers; else Eq. 10's.
        lower: (n,) rad, lower bounds of q; the robot's own when not given.
        upper: (n,) rad, upper bounds of q, likewise.

    A straight speed is the maximum of a linear program whose data depend on q; it has ridges where
    the program's basis changes. Taking the joint velocities as variables beside q makes the
    problem smooth: the ridges become bounds of qd. The velocities that an arm can stop from depend
    on q; they become inequalities.
    """

    def __init__(
        self,
        task: Task,
        objective: Objective,
        *,
        flux: float | None = None,
        deliverable: bool = False,
        lower: Array | None = None,
        upper: Array | None = None,
    ) -> None:
        self.task, self.objective, self.flux = task, objective, flux
        self.deliverable = flux is not None and deliverable
        self.locked = task.hit.setting.drives.model == "composite"
        robot = task.robot
        self.n = robot.n
        self.moving = objective.moving or self.deliverable
        self.lower = robot.lower if lower is None else lower
        self.upper = robot.upper if upper is None else upper
        self.room: StoppingRoom | None = None
        slowest, fastest = robot.velocity_lower, robot.velocity_upper
        if objective.stopping or self.deliverable:
            contact = task.contact
            movers = Chain.from_model(robot.model).attach(contact.joint, contact.offset)[0]
            self.room = StoppingRoom(drive_limits(robot), robot.lower, robot.upper, movers)
            slowest, fastest = self.room.slowest_fastest
        if self.moving:
            self.lower = np.concatenate((self.lower, slowest))
            self.upper = np.concatenate((self.upper, fastest))
        self.kernel = kernel_for(robot, (task.contact,), KERNEL)
        # The points of the away condition, of which the contact itself is known already.
        origin = type(task.contact)(task.contact.joint)
        self.ends = (task.beyond,) if task.contact == origin else (origin, task.beyond)
        self.axes = Axes(robot)
        self.blind = is_blind(robot, task.contact)
        across = np.array(lateral(tuple(task.direction)), dtype=float)
        across /= np.linalg.norm(across, axis=1, keepdims=True)
        where = np.where(np.isfinite(self.lower[: self.n]), self.lower[: self.n], 0.0)
        self.freedom = freedom(robot, task.contact, task.target, where, task.direction, across)
        placed = 0 if task.target is None else len(self.freedom.seen)
        self.equalities = placed + (len(self.freedom.sideways) if self.moving else 0)

    def start(self, q: Array) -> Array:
        """Return points x for configurations q (N, n)."""
        return np.concatenate((q, Sight(self, q).straight[0]), axis=1) if self.moving else q

    def straight(self, seen: Sight) -> tuple[Array, Array]:
        """Return velocities (N, n) of the fastest straight motions, and their speeds (N,)."""
        robot, across = self.task.robot, self.freedom.sideways @ seen.jacobian
        if len(self.freedom.sideways) < 2:
            across = np.concatenate((across, np.zeros((len(across), 2, self.n))), axis=1)[:, :2]
        limits = robot.velocity_lower, robot.velocity_upper
        box = limits if self.room is None else self.room.box(seen.q)
        qd = straight_velocities(seen.pull, across, *box)
        return qd, (seen.pull * qd).sum(axis=1)

    def screen(self, q: Array) -> tuple[Array, Array]:
        """Return values (N,) and excesses (N,) over the inequalities, without derivatives.

        An excess is 0 where the inequalities are met.
        """
        seen, excess = Sight(self, q), np.zeros(len(q))
        if self.task.away and self.objective.keeps_away:
            excess = np.maximum(seen.gap[0] + AWAY_MARGIN, 0.0)
        if self.flux is not None:
            reached = seen.log_straight_flux if self.deliverable else seen.log_flux
            excess = excess + np.maximum(np.log(self.flux) + FLUX_MARGIN - reached, 0.0)
        value = self.objective.screen(seen)
        return value, np.where(np.isfinite(value) & np.isfinite(excess), excess, np.inf)

    def evaluate(self, x: Array) -> Values:
        """Evaluate at x (N, m), see `Problem`."""
        q = np.ascontiguousarray(x[:, : self.n])
        qd = x[:, self.n :] if self.moving else None
        seen = Sight(self, q, qd, threads=1)
        value, gradient = self.objective.evaluate(seen)
        residual: list[Array] = []
        slope: list[Array] = []
        if self.task.target is not None:
            residual += list((seen.missed @ self.freedom.seen.T).T)
            slope += list((self.freedom.seen @ seen.jacobian).transpose(1, 0, 2))
            if self.blind:
                value = np.where(self.freedom.misses(seen.missed), np.nan, value)
        if qd is not None:
            for sideways in self.freedom.sideways:
                row = seen.columns @ sideways
                residual.append((row * qd).sum(axis=1))
                slope.append(np.concatenate((seen.bent @ sideways, row), axis=1))
        if self.task.away and self.objective.keeps_away:
            gap, gap_by = seen.gap
            residual.append(gap + AWAY_MARGIN)
            slope.append(gap_by)
        if self.flux is not None:
            if self.deliverable:
                short, by = seen.short_of(self.flux * (1.0 + FLUX_MARGIN))
            else:
                reached, rising = seen.flux()
                short, by = np.log(self.flux) + FLUX_MARGIN - reached, -rising
            residual.append(short)
            slope.append(by)
        if self.room is not None and qd is not None:
            over, over_by = self.room.constraints(q, qd)
            residual += list(over.T)
            slope += list(over_by.transpose(1, 0, 2))
        filled = np.zeros((len(x), len(slope), x.shape[1]))
        for i, part in enumerate(slope):
            filled[:, i, : part.shape[1]] = part
        if gradient.shape[1] < x.shape[1]:  # an objective of q alone
            gradient = np.hstack((gradient, np.zeros((len(x), x.shape[1] - gradient.shape[1]))))
        residuals = np.stack(residual, axis=1) if residual else np.zeros((len(x), 0))
        return Values(value, gradient, residuals, filled)
