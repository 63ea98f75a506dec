"""The inertia to aim for, step by step (Eq. 12-13)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np

from hitjoints.errors import InfeasibleError, UnknownNameError
from hitjoints.programs.joint_velocity import (
    RHO,
    WITHIN_REACH,
    flux_terms,
    gradient_weights,
    most_flux_terms,
    unbounded_flux,
)
from hitjoints.programs.torque_rows import Impulses, with_impulses
from hitjoints.programs.warm import WarmProgram

if TYPE_CHECKING:
    from hitjoints.dynamics.contact_point import ContactPoint, State
    from hitjoints.types import Array

Weighting = Literal["identity", "gradient"]
BACKWARDS = -10.0
"""Share of the desired flux, a bound of how far from it the motors may keep a step."""


class DesiredInertia:
    """The inertia one step ahead if only the flux and the field mattered (Eq. 13).

    Args:
        point: what the arm hits with.
        direction: (3,), unit.
        dt: s, the step.
        weighting: W of Eq. 12: "identity", or "gradient" for diag(|grad lambda| / max) + floor.

    Raises:
        UnknownNameError: there is no such weighting.
    """

    def __init__(
        self, point: ContactPoint, direction: Array, dt: float, weighting: Weighting
    ) -> None:
        if weighting not in ("identity", "gradient"):
            raise UnknownNameError("weighting", weighting, ("identity", "gradient"))
        self._point, self._direction, self._dt = point, direction, dt
        self._by_gradient, self._ones = weighting == "gradient", np.ones(point.robot.n)
        self._program = WarmProgram(point.robot.n, 1)
        self._limited: WarmProgram | None = None  # qd, t, p

    def __call__(  # noqa: PLR0913
        self,
        q: Array,
        state: State,
        f: Array,
        pull: Array,
        speed: float,
        saturated: bool,
        lower: Array,
        upper: Array,
        impulses: Impulses | None = None,
    ) -> float:
        """Return lambda*, kg; the present inertia if Eq. 12 has no certified answer.

        Args:
            q: (n,) rad.
            state: there.
            f: (3,) m/s, the field.
            pull: (n,) m/rad, J^T h.
            speed: m/s that has the desired flux, or the greatest within the bounds.
            saturated: it is the latter.
            lower: (n,) rad/s.
            upper: (n,) rad/s.
            impulses: what the motors can do, if that, or the change of velocities, is limited: then
                the flux row asks for as much of the flux as can be had within the step.
        """
        weights = gradient_weights(state.gradient) if self._by_gradient else self._ones
        asked = WITHIN_REACH * speed if saturated else speed
        if impulses is None:
            x = unbounded_flux(state.J, f, self._direction, asked, weights, RHO)
            if x is None or not ((x >= lower) & (x <= upper)).all():
                terms = flux_terms(state.J, f, pull, asked, weights, RHO)
                x = self._program.solve(*terms, lower, upper)
        else:
            terms = most_flux_terms(state.J, f, pull, asked, weights, RHO)
            low = np.concatenate((lower, [BACKWARDS], -impulses.limit))
            high = np.concatenate((upper, [1.0], impulses.limit))
            terms = with_impulses(terms, impulses)
            if self._limited is None:
                self._limited = WarmProgram(low.size, terms.b.size)
            x = self._limited.solve(*terms, low, high)
        if x is None:
            return state.inertia
        following = q + self._dt * x[: q.size]
        try:
            return self._point.inertia(following, self._direction)
        except InfeasibleError:
            return state.inertia
