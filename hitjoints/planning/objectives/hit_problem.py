"""The planning problems: what is maximised over which configurations, with exact gradients.

Objectives are maximised as logarithms, so that tolerances are relative and every part adds up.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from hitjoints.kernels.formulas.speeds import lateral
from hitjoints.planning.objectives.geometry import Axes, bend
from hitjoints.planning.objectives.straight import straight_velocities
from hitjoints.planning.search.climb import Values
from hitjoints.quantities import kernel_for

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from hitjoints.model.robot import Contact, Robot

    Array = NDArray[np.float64]

OBJECTIVES = ("inertia", "flux", "straight-flux", "rebound")

AWAY_MARGIN = 1e-6
"""The away condition is strict; h . (chi_{k+1} - chi_k) <= -1e-6 m is closed, and implies it."""

FLUX_MARGIN = 1e-9
"""A required flux is exceeded by this share, so that rounding cannot leave it short."""

KERNEL = ("mobility", "mobility_gradient", "speed", "position", "jacobian")
"""Outputs of the one kernel a hit needs, but for straight-flux, which screens with a second."""

LEAST_MOBILITY = 1e-12
"""1/kg: where a contact is harder to move than this it does not hit along the direction."""


@dataclass(frozen=True)
class Hit:
    """What is asked.

    Attributes:
        robot: the arm.
        contact: what hits.
        direction: (3,) unit vector.
        mass: of the object, kg.
        position: (3,) m, where the contact has to be; None leaves it free.
        away: demand the away condition of Eq. 14.
    """

    robot: Robot
    contact: Contact
    direction: Array
    mass: float
    position: Array | None
    away: bool

    @property
    def beyond(self) -> Contact:
        """The point chi_{k+1} the away condition compares with: the next joint, or the flange."""
        from hitjoints.model.robot import Contact

        joint = self.contact.joint
        return Contact(joint + 1) if joint < self.robot.n else self.robot.flange


class HitProblem:
    """A hit's objective, constraints and bounds over x = q, or x = (q, qd) when straight.

    Args:
        hit: what is asked.
        objective: "inertia", "flux", "straight-flux", or "away" for the least
            h . (chi_{k+1} - chi_k).
        flux: m/s that must be reached at least (Eq. 10), if any.
        lower, upper: (n,) rad bounds of q; the robot's own when not given.

    A straight speed is the maximum of a linear program whose data depend on q; it has ridges where
    the program's basis changes. Taking the joint velocities as variables beside q makes the
    problem smooth: the ridges become bounds of qd.
    """

    def __init__(
        self,
        hit: Hit,
        objective: str,
        *,
        flux: float | None = None,
        lower: Array | None = None,
        upper: Array | None = None,
    ) -> None:
        self.hit, self.objective, self.flux = hit, objective, flux
        robot = hit.robot
        self.n, self.straight = robot.n, objective == "straight-flux"
        self.lower = robot.lower if lower is None else lower
        self.upper = robot.upper if upper is None else upper
        self.slowest, self.fastest = robot.velocity_lower, robot.velocity_upper
        if self.straight:
            self.lower = np.concatenate((self.lower, self.slowest))
            self.upper = np.concatenate((self.upper, self.fastest))
        self.equalities = (0 if hit.position is None else 3) + (2 if self.straight else 0)
        self.kernel = kernel_for(robot, (hit.contact,), KERNEL)
        # The points of the away condition, of which the contact itself is known already.
        origin = type(hit.contact)(hit.contact.joint)
        self.ends = (hit.beyond,) if hit.contact == origin else (origin, hit.beyond)
        self.axes = Axes(robot)
        self.across = np.array(lateral(tuple(hit.direction)), dtype=float)
        self.across /= np.linalg.norm(self.across, axis=1, keepdims=True)

    def start(self, q: Array) -> Array:
        """Return points x for configurations q (N, n)."""
        if not self.straight:
            return q
        columns = self.kernel(q, self.hit.direction)["jacobian"][0].transpose(0, 2, 1)
        qd = straight_velocities(
            columns @ self.hit.direction,
            self.across @ columns.transpose(0, 2, 1),
            self.slowest,
            self.fastest,
        )
        return np.concatenate((q, qd), axis=1)

    def screen(self, q: Array) -> tuple[Array, Array]:
        """Return values (N,) and excesses (N,) over the inequalities, without derivatives.

        An excess is 0 where the inequalities are met.
        """
        hit, excess = self.hit, np.zeros(len(q))
        found = self.kernel(q, hit.direction)
        mobility = np.where(found["mobility"][0] < LEAST_MOBILITY, np.nan, found["mobility"][0])
        with np.errstate(divide="ignore"):
            flux = np.log(found["speed"][0]) - np.log1p(hit.mass * mobility)
        value = flux if self.objective == "flux" else -np.log(mobility)
        if self.objective == "away":
            value = -self._gap(q, found)[0]
        elif hit.away:
            excess = np.maximum(self._gap(q, found)[0] + AWAY_MARGIN, 0.0)
        if self.flux is not None:
            excess = excess + np.maximum(np.log(self.flux) + FLUX_MARGIN - flux, 0.0)
        if self.straight:
            kernel = kernel_for(hit.robot, (hit.contact,), ("straight_flux",))
            with np.errstate(divide="ignore"):
                value = np.log(kernel(q, hit.direction, hit.mass)["straight_flux"][0])
        return value, np.where(np.isfinite(value), excess, np.inf)

    def evaluate(self, x: Array) -> Values:
        """Evaluate at x (N, m), see `Problem`."""
        q = np.ascontiguousarray(x[:, : self.n])
        hit, width = self.hit, x.shape[1]
        found = self.kernel(q, hit.direction, threads=1)
        columns = np.ascontiguousarray(found["jacobian"][0].transpose(0, 2, 1))
        pull = columns @ hit.direction
        residual: list[Array] = []
        slope: list[Array] = []
        if hit.position is not None:
            residual += list((found["position"][0] - hit.position).T)
            slope += list(found["jacobian"][0].transpose(1, 0, 2))
        if self.straight:
            qd = x[:, self.n :]
            bent = bend(self.axes.spins(q), columns, qd)
            for sideways in self.across:
                row = columns @ sideways
                residual.append((row * qd).sum(axis=1))
                slope.append(np.concatenate((bent @ sideways, row), axis=1))
            value, gradient = self._flux_at(found, pull, bent @ hit.direction, qd)
        elif self.objective == "flux":
            value, gradient = self._flux(q, found, columns, pull)
        elif self.objective == "away":
            gap, gap_by = self._gap(q, found)
            value, gradient = -gap, -gap_by
        else:
            mobility, by = _mobility(found)
            value, gradient = -np.log(mobility), -by / mobility[:, None]
        if hit.away and self.objective != "away":
            gap, gap_by = self._gap(q, found)
            residual.append(gap + AWAY_MARGIN)
            slope.append(gap_by)
        if self.flux is not None:
            flux, flux_by = self._flux(q, found, columns, pull)
            residual.append(np.log(self.flux) + FLUX_MARGIN - flux)
            slope.append(-flux_by)
        filled = np.zeros((len(x), len(slope), width))
        for i, part in enumerate(slope):
            filled[:, i, : part.shape[1]] = part
        residuals = np.stack(residual, axis=1) if residual else np.zeros((len(x), 0))
        return Values(value, gradient, residuals, filled)

    def _gap(self, q: Array, found: dict[str, Array]) -> tuple[Array, Array]:
        """Return h . (chi_{k+1} - chi_k) (N,) m and its gradient (N, n)."""
        h = self.hit.direction
        kernel = kernel_for(self.hit.robot, self.ends, ("position", "jacobian"))
        ends = kernel(q, h, threads=1)
        near = found if len(self.ends) == 1 else ends
        gap = (ends["position"][-1] - near["position"][0]) @ h
        return gap, np.einsum("a,kan->kn", h, ends["jacobian"][-1] - near["jacobian"][0])

    def _flux_at(
        self, found: dict[str, Array], pull: Array, bent: Array, qd: Array
    ) -> tuple[Array, Array]:
        """Return the log of the flux at velocity qd, and its gradient by q and qd."""
        mobility, by = _mobility(found)
        speed = (pull * qd).sum(axis=1)
        speed = np.where(speed > 0, speed, np.nan)
        loss = 1.0 + self.hit.mass * mobility
        by_q = bent / speed[:, None] - (self.hit.mass / loss)[:, None] * by
        return np.log(speed) - np.log(loss), np.concatenate((by_q, pull / speed[:, None]), axis=1)

    def _flux(
        self, q: Array, found: dict[str, Array], columns: Array, pull: Array
    ) -> tuple[Array, Array]:
        """Return the log of the maximum flux and its gradient.

        The speed sum_i |g_i| qd_i has kinks where a g_i vanishes, but they point down: a climb
        leaves them.
        """
        qd = np.where(pull > 0, self.fastest, self.slowest)
        bent = bend(self.axes.spins(q), columns, qd) @ self.hit.direction
        value, gradient = self._flux_at(found, pull, bent, qd)
        return value, gradient[:, : self.n]


def _mobility(found: dict[str, Array]) -> tuple[Array, Array]:
    """Return the mobility (N,), nan where it is too small to hit with, and its gradient (N, n)."""
    mobility = found["mobility"][0]
    return np.where(mobility < LEAST_MOBILITY, np.nan, mobility), found["mobility_gradient"][0]
