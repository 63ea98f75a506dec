"""The inertia to aim for, step by step (Eq. 12-13)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np

from hitjoints.dynamics.inertia import inertia_along
from hitjoints.errors import InfeasibleError, UnknownNameError
from hitjoints.programs.velocity import RHO, WITHIN_REACH, flux_terms, gradient_weights
from hitjoints.programs.warm import WarmProgram

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from hitjoints.hitting.hit import State
    from hitjoints.robot import Contact, Robot

    Array = NDArray[np.float64]

Weighting = Literal["identity", "gradient"]


class DesiredInertia:
    """The inertia one step ahead if only the flux and the field mattered (Eq. 13).

    Args:
        robot, contact: the arm and what it hits with.
        direction: (3,), unit.
        dt: s, the step.
        weighting: W of Eq. 12: "identity", or "gradient" for diag(|grad lambda| / max) + floor.

    Raises:
        UnknownNameError: there is no such weighting.
    """

    def __init__(
        self, robot: Robot, contact: Contact, direction: Array, dt: float, weighting: Weighting
    ) -> None:
        if weighting not in ("identity", "gradient"):
            raise UnknownNameError("weighting", weighting, ("identity", "gradient"))
        self._robot, self._contact, self._direction, self._dt = robot, contact, direction, dt
        self._by_gradient, self._ones = weighting == "gradient", np.ones(robot.n)
        self._program = WarmProgram(robot.n, 1)

    def __call__(
        self,
        q: Array,
        state: State,
        f: Array,
        pull: Array,
        speed: float,
        saturated: bool,
        lower: Array,
        upper: Array,
    ) -> float:
        """Return lambda*, kg; the present inertia if Eq. 12 has no certified answer.

        Args:
            q: (n,) rad. state: there. f: (3,) m/s, the field. pull: (n,) m/rad, J^T h.
            speed: m/s that has the desired flux, or the greatest within the bounds.
            saturated: it is the latter.
            lower, upper: (n,) rad/s.
        """
        weights = gradient_weights(state.gradient) if self._by_gradient else self._ones
        asked = WITHIN_REACH * speed if saturated else speed
        terms = flux_terms(state.J, f, pull, asked, weights, RHO)
        qd = self._program.solve(*terms, lower, upper)
        if qd is None:
            return state.inertia
        try:
            return inertia_along(self._robot, q + self._dt * qd, self._contact, self._direction)
        except InfeasibleError:
            return state.inertia
