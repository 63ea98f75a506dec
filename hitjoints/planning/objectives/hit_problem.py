"""The planning problems: what is maximised over which configurations, with exact gradients.

Objectives are maximised as logarithms, so that tolerances are relative and every part adds up.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from hitjoints.built import chain_of
from hitjoints.hitting.drive_limits import drive_limits
from hitjoints.impact.composite import composite_inertia, composite_inertia_gradient
from hitjoints.kernels.formulas.speeds import lateral
from hitjoints.planning.objectives.freedom import freedom, is_blind
from hitjoints.planning.objectives.problem_program import AWAY_MARGIN, Form, program_for
from hitjoints.planning.objectives.sight import Sight
from hitjoints.planning.objectives.stopping_room import StoppingRoom
from hitjoints.planning.objectives.straight import straight_velocities
from hitjoints.planning.search.climb import Values

if TYPE_CHECKING:
    from hitjoints.planning.objectives.objective import Objective
    from hitjoints.planning.task import Task
    from hitjoints.types import Array

FLUX_MARGIN = 1e-9
"""A required flux is exceeded by this share, so that rounding cannot leave it short."""


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
            movers = chain_of(robot).attach(contact.joint, contact.offset)[0]
            self.room = StoppingRoom(drive_limits(robot), robot.lower, robot.upper, movers)
            slowest, fastest = self.room.slowest_fastest
        if self.moving:
            self.lower = np.concatenate((self.lower, slowest))
            self.upper = np.concatenate((self.upper, fastest))
        self.blind = is_blind(robot, task.contact)
        across = np.array(lateral(tuple(task.direction)), dtype=float)
        across /= np.linalg.norm(across, axis=1, keepdims=True)
        where = np.where(np.isfinite(self.lower[: self.n]), self.lower[: self.n], 0.0)
        self.freedom = freedom(robot, task.contact, task.target, where, task.direction, across)
        placed = 0 if task.target is None else len(self.freedom.seen)
        self.equalities = placed + (len(self.freedom.sideways) if self.moving else 0)
        form = Form(
            task.contact,
            task.beyond,
            type(objective),
            moving=self.moving,
            away=task.away and objective.keeps_away,
            reached=flux is not None and not self.deliverable,
            delivered=self.deliverable,
            seen=placed,
            sideways=len(self.freedom.sideways) if self.moving else 0,
            blind=self.blind and task.target is not None,
            locked=self.locked,
        )
        self.program = program_for(robot, form)
        self._shared = np.concatenate(
            (
                task.direction,
                self.freedom.forward,
                np.zeros(3) if task.target is None else task.target,
                self.freedom.seen[:placed].ravel(),
                self.freedom.sideways[: form.sideways].ravel(),
                (task.mass, np.nan, self.freedom.slack**2),
            )
        )

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
            excess = np.maximum(seen.gap + AWAY_MARGIN, 0.0)
        if self.flux is not None:
            reached = seen.log_straight_flux if self.deliverable else seen.log_flux
            excess = excess + np.maximum(np.log(self.flux) + FLUX_MARGIN - reached, 0.0)
        value = self.objective.screen(seen)
        return value, np.where(np.isfinite(value) & np.isfinite(excess), excess, np.inf)

    def run(self, x: Array) -> Array:
        """Return the program's outputs (K, N) at x (N, m)."""
        if self.flux is not None:
            self._shared[-2] = self.flux * (1.0 + FLUX_MARGIN)
        if self.locked:
            mobility, gradient = locked_mobility(self.task, x[:, : self.n])
            x = np.concatenate((x, mobility[:, None], gradient), axis=1)
        return self.program(x, self._shared)

    def evaluate(self, x: Array) -> Values:
        """Evaluate at x (N, m), see `Problem`."""
        value, gradient, residual, slope = self.program.cut(self.run(x))
        if self.objective.logarithm:
            with np.errstate(divide="ignore", invalid="ignore"):
                value = np.log(value)
        if self.program.logged is not None:
            assert self.flux is not None
            with np.errstate(divide="ignore", invalid="ignore"):
                reached = np.log(residual[:, self.program.logged])
            residual[:, self.program.logged] = np.log(self.flux) + FLUX_MARGIN - reached
        return Values(value, gradient, residual, slope)


def locked_mobility(task: Task, q: Array) -> tuple[Array, Array]:
    """Return the inverse of the inertia of locked joints (N,) 1/kg at q (N, n), its gradient."""
    mobility = 1.0 / composite_inertia(task.robot, q, task.contact, task.direction)
    slope = composite_inertia_gradient(task.robot, q, task.contact, task.direction)
    return mobility, -slope * mobility[:, None] ** 2
