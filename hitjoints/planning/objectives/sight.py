"""What objectives and constraints see of rows of configurations, each computed when asked for."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from hitjoints.built import kernel_for
from hitjoints.impact.composite import composite_inertia, composite_inertia_gradient
from hitjoints.planning.objectives.geometry import bend
from hitjoints.tolerances import rank_floor

if TYPE_CHECKING:
    from hitjoints.planning.objectives.hit_problem import HitProblem
    from hitjoints.types import Array

LEAST_MOBILITY = 1e-12
"""1/kg: where a contact is harder to move than this it does not hit along the direction."""


class Sight:
    """Quantities of a problem at N configurations.

    Args:
        problem: whose.
        q: (N, n) rad.
        qd: (N, n) rad/s, of the straight motion where joint velocities are variables.
        threads: of the batch kernel.
    """

    def __init__(
        self, problem: HitProblem, q: Array, qd: Array | None = None, threads: int | None = None
    ) -> None:
        self.problem, self.q = problem, q
        self.qd = np.zeros_like(q) if qd is None else qd
        self.task, self.freedom = problem.task, problem.freedom
        self.found = problem.kernel(q, self.task.direction, threads=threads)

    @cached_property
    def mobility(self) -> Array:
        """The inverse of the inertia (N,) 1/kg, nan where it is too small to hit with."""
        links = self.found["mobility"][0]
        return np.where(links < LEAST_MOBILITY, np.nan, self._any_mobility)

    @cached_property
    def mobility_gradient(self) -> Array:
        """Its gradient (N, n)."""
        if not self.problem.locked:
            return np.asarray(self.found["mobility_gradient"][0])
        task = self.task
        slope = composite_inertia_gradient(task.robot, self.q, task.contact, task.direction)
        return np.asarray(-slope * self._any_mobility[:, None] ** 2)

    @cached_property
    def _any_mobility(self) -> Array:
        """h^T J M^-1 J^T h (N,) 1/kg, or that of the locked arm; also where it is too small."""
        if not self.problem.locked:
            return np.asarray(self.found["mobility"][0])
        task = self.task
        return 1.0 / composite_inertia(task.robot, self.q, task.contact, task.direction)

    @property
    def missed(self) -> Array:
        """How far the contact is from the target, (N, 3) m."""
        return np.asarray(self.found["position"][0] - self.task.target)

    @property
    def jacobian(self) -> Array:
        """(N, 3, n) m/rad."""
        return np.asarray(self.found["jacobian"][0])

    @cached_property
    def columns(self) -> Array:
        """(N, n, 3) m/rad, the Jacobian's columns."""
        return np.ascontiguousarray(self.jacobian.transpose(0, 2, 1))

    @cached_property
    def pull(self) -> Array:
        """J^T h without its blind part, (N, n) m/rad."""
        return np.asarray(self.columns @ self.freedom.forward)

    @cached_property
    def bent(self) -> Array:
        """D (J qd) / d q_j (N, n, 3) at the velocities that are variables."""
        return self._bend(self.qd)

    @cached_property
    def gap(self) -> tuple[Array, Array]:
        """H . (chi_{k+1} - chi_k) (N,) m and its gradient (N, n)."""
        h, ends = self.task.direction, self.problem.ends
        kernel = kernel_for(self.task.robot, ends, ("position", "jacobian"))
        seen = kernel(self.q, h, threads=1)
        near = self.found if len(ends) == 1 else seen
        gap = (seen["position"][-1] - near["position"][0]) @ h
        return gap, np.einsum("a,kan->kn", h, seen["jacobian"][-1] - near["jacobian"][0])

    @cached_property
    def log_flux(self) -> Array:
        """Logarithm of the maximum flux of Eq. 10, (N,)."""
        with np.errstate(divide="ignore"):
            speed = np.log(self.found["speed"][0])
        return np.asarray(speed - np.log1p(self.task.mass * self.mobility))

    def flux(self) -> tuple[Array, Array]:
        """Return the logarithm of the maximum flux of Eq. 10 and its gradient (N, n).

        The speed sum_i |g_i| qd_i has kinks where a g_i vanishes, but they point down: a climb
        leaves them.
        """
        robot = self.task.robot
        qd = np.where(self.pull > 0, robot.velocity_upper, robot.velocity_lower)
        value, gradient = self._flux_at(qd, self._bend(qd))
        return value, gradient[:, : qd.shape[1]]

    @cached_property
    def moving_flux(self) -> tuple[Array, Array]:
        """Logarithm (N,) of the flux of the velocities that are variables, gradient (N, 2 n)."""
        return self._flux_at(self.qd, self.bent)

    def short_of(self, flux: float) -> tuple[Array, Array]:
        """Return how far the velocities that are variables are from a flux, and its gradient.

        In shares of the flux, as the excess (N,) of 1 + m mobility over speed / flux: defined for
        velocities that move the contact backwards, too.
        """
        mass, by = self.task.mass, self.mobility_gradient
        speed = (self.pull * self.qd).sum(axis=1)
        by_q = mass * by - self.bent @ self.freedom.forward / flux
        short = 1.0 + mass * self._any_mobility - speed / flux
        return short, np.concatenate((by_q, -self.pull / flux), axis=1)

    @cached_property
    def straight(self) -> tuple[Array, Array]:
        """Velocities (N, n) of the fastest straight motion within the box, and their speed (N,)."""
        return self.problem.straight(self)

    @cached_property
    def log_straight_flux(self) -> Array:
        """Logarithm of the greatest straight flux (N,), -inf or nan where there is none."""
        task, problem = self.task, self.problem
        if not (problem.blind or problem.room or problem.locked):
            kernel = kernel_for(task.robot, (task.contact,), ("straight_flux",))
            with np.errstate(divide="ignore"):
                flux = kernel(self.q, task.direction, task.mass)["straight_flux"][0]
                return np.asarray(np.log(flux))
        least = rank_floor(self.jacobian) * np.linalg.norm(task.robot.velocity_upper)
        speed = np.where(self.straight[1] > least, self.straight[1], np.nan)
        return np.asarray(np.log(speed) - np.log1p(task.mass * self._any_mobility))

    def _bend(self, qd: Array) -> Array:
        return bend(self.problem.axes.spins(self.q), self.columns, qd)

    def _flux_at(self, qd: Array, bent: Array) -> tuple[Array, Array]:
        """Return the logarithm of the flux at velocities qd, and its gradient by q and qd."""
        mass, by = self.task.mass, self.mobility_gradient
        speed = (self.pull * qd).sum(axis=1)
        speed = np.where(speed > 0, speed, np.nan)
        loss = 1.0 + mass * self.mobility
        by_q = bent @ self.freedom.forward / speed[:, None] - (mass / loss)[:, None] * by
        gradient = np.concatenate((by_q, self.pull / speed[:, None]), axis=1)
        return np.log(speed) - np.log(loss), gradient
