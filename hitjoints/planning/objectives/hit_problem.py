"""The planning problems: what is maximised over which configurations, with exact gradients.

Objectives are maximised as logarithms, so that tolerances are relative and every part adds up.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from hitjoints.built import kernel_for
from hitjoints.kernels.formulas.speeds import lateral
from hitjoints.planning.objectives.freedom import freedom, is_blind
from hitjoints.planning.objectives.geometry import Axes, bend
from hitjoints.planning.objectives.straight import straight_velocities
from hitjoints.planning.search.climb import Values
from hitjoints.tolerances import rank_floor

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
        """The point chi_{k+1} the away condition compares with, see `Robot.beyond`."""
        return self.robot.beyond(self.contact)


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
        self.kernel = kernel_for(robot, (hit.contact,), KERNEL)
        # The points of the away condition, of which the contact itself is known already.
        origin = type(hit.contact)(hit.contact.joint)
        self.ends = (hit.beyond,) if hit.contact == origin else (origin, hit.beyond)
        self.axes = Axes(robot)
        self.blind = is_blind(robot, hit.contact)
        across = np.array(lateral(tuple(hit.direction)), dtype=float)
        across /= np.linalg.norm(across, axis=1, keepdims=True)
        where = np.where(np.isfinite(self.lower[: self.n]), self.lower[: self.n], 0.0)
        self.freedom = freedom(robot, hit.contact, hit.position, where, hit.direction, across)
        placed = 0 if hit.position is None else len(self.freedom.seen)
        self.equalities = placed + (len(self.freedom.sideways) if self.straight else 0)

    def start(self, q: Array) -> Array:
        """Return points x for configurations q (N, n)."""
        if not self.straight:
            return q
        return np.concatenate((q, self._straight(self.kernel(q, self.hit.direction))[0]), axis=1)

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
            value = self._straight_flux(q, found)
        return value, np.where(np.isfinite(value), excess, np.inf)

    def evaluate(self, x: Array) -> Values:
        """Evaluate at x (N, m), see `Problem`."""
        q = np.ascontiguousarray(x[:, : self.n])
        hit, width = self.hit, x.shape[1]
        found = self.kernel(q, hit.direction, threads=1)
        columns = np.ascontiguousarray(found["jacobian"][0].transpose(0, 2, 1))
        pull = columns @ self.freedom.forward
        residual: list[Array] = []
        slope: list[Array] = []
        if hit.position is not None:
            missed = found["position"][0] - hit.position
            residual += list((missed @ self.freedom.seen.T).T)
            slope += list((self.freedom.seen @ found["jacobian"][0]).transpose(1, 0, 2))
        if self.straight:
            qd = x[:, self.n :]
            bent = bend(self.axes.spins(q), columns, qd)
            for sideways in self.freedom.sideways:
                row = columns @ sideways
                residual.append((row * qd).sum(axis=1))
                slope.append(np.concatenate((bent @ sideways, row), axis=1))
            bent = bent @ self.freedom.forward
            value, gradient = self._flux_at(found, pull, bent, qd)
        elif self.objective == "flux":
            value, gradient = self._flux(q, found, columns, pull)
        elif self.objective == "away":
            gap, gap_by = self._gap(q, found)
            value, gradient = -gap, -gap_by
        else:
            mobility, by = _mobility(found)
            value, gradient = -np.log(mobility), -by / mobility[:, None]
        if hit.position is not None and self.blind:
            value = np.where(self.freedom.misses(missed), np.nan, value)
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

    def _straight(self, found: dict[str, Array]) -> tuple[Array, Array]:
        """Return the velocities (N, n) of the fastest straight motion, and their speed (N,)."""
        columns = found["jacobian"][0].transpose(0, 2, 1)
        pull = columns @ self.freedom.forward
        across = self.freedom.sideways @ found["jacobian"][0]
        if len(self.freedom.sideways) < 2:
            across = np.concatenate((across, np.zeros((len(across), 2, self.n))), axis=1)[:, :2]
        qd = straight_velocities(pull, across, self.slowest, self.fastest)
        return qd, (pull * qd).sum(axis=1)

    def _straight_flux(self, q: Array, found: dict[str, Array]) -> Array:
        """Return the logarithm of the greatest straight flux (N,), -inf or nan where it is none."""
        hit = self.hit
        if not self.blind:
            kernel = kernel_for(hit.robot, (hit.contact,), ("straight_flux",))
            with np.errstate(divide="ignore"):
                return np.asarray(np.log(kernel(q, hit.direction, hit.mass)["straight_flux"][0]))
        speed = self._straight(found)[1]
        least = rank_floor(found["jacobian"][0]) * np.linalg.norm(self.fastest)
        speed = np.where(speed > least, speed, np.nan)
        return np.asarray(np.log(speed) - np.log1p(hit.mass * found["mobility"][0]))

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
        bent = bend(self.axes.spins(q), columns, qd) @ self.freedom.forward
        value, gradient = self._flux_at(found, pull, bent, qd)
        return value, gradient[:, : self.n]


def _mobility(found: dict[str, Array]) -> tuple[Array, Array]:
    """Return the mobility (N,), nan where it is too small to hit with, and its gradient (N, n)."""
    mobility = found["mobility"][0]
    return np.where(mobility < LEAST_MOBILITY, np.nan, mobility), found["mobility_gradient"][0]
