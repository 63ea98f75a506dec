"""What screening sees of rows of configurations, each computed when asked for."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from hitjoints.built import kernel_for
from hitjoints.planning.objectives.traced_hit import LEAST_MOBILITY
from hitjoints.tolerances import rank_floor

if TYPE_CHECKING:
    from hitjoints.planning.objectives.hit_problem import HitProblem
    from hitjoints.types import Array


class Sight:
    """Quantities of a problem at N configurations.

    Args:
        problem: whose.
        q: (N, n) rad.
    """

    def __init__(self, problem: HitProblem, q: Array) -> None:
        self.problem, self.q, self.task = problem, q, problem.task
        x = np.concatenate((q, np.zeros_like(q)), axis=1) if problem.moving else q
        self.found = problem.program.seen(problem.run(x))

    @cached_property
    def mobility(self) -> Array:
        """The inverse of the inertia (N,) 1/kg, nan where it is too small to hit with."""
        return np.where(self.found["mobility"] < LEAST_MOBILITY, np.nan, self.found["shown"])

    @property
    def jacobian(self) -> Array:
        """(N, 3, n) m/rad."""
        return self.found["jacobian"]

    @property
    def gap(self) -> Array:
        """H . (chi_{k+1} - chi_k) (N,) m."""
        return self.found["gap"]

    @cached_property
    def pull(self) -> Array:
        """J^T h without its blind part, (N, n) m/rad."""
        return np.asarray(self.jacobian.transpose(0, 2, 1) @ self.problem.freedom.forward)

    @cached_property
    def log_flux(self) -> Array:
        """Logarithm of the maximum flux of Eq. 10, (N,)."""
        with np.errstate(divide="ignore"):
            speed = np.log(self.found["speed"])
        return np.asarray(speed - np.log1p(self.task.mass * self.mobility))

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
        return np.asarray(np.log(speed) - np.log1p(task.mass * self.found["shown"]))
