"""The planning problems: what is maximised over which configurations, with exact gradients.

Objectives are maximised as logarithms, so that tolerances are relative and every part adds up.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from hitjoints.kernels.speeds import lateral
from hitjoints.planning.geometry import Geometry, Poses
from hitjoints.planning.polish import Values
from hitjoints.planning.straight import straight_velocities
from hitjoints.quantities import kernel_for

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from hitjoints.robot import Contact, Robot

    Array = NDArray[np.float64]

OBJECTIVES = ("inertia", "flux", "straight-flux", "rebound")

AWAY_MARGIN = 1e-6
"""The away condition is strict; h . (chi_{k+1} - chi_k) <= -1e-6 m is closed, and implies it."""

FLUX_MARGIN = 1e-9
"""A required flux is exceeded by this share, so that rounding cannot leave it short."""

KERNEL = ("mobility", "mobility_gradient", "speed")
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
        from hitjoints.robot import Contact

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
        self.geometry = Geometry(robot)
        self.lower = robot.lower if lower is None else lower
        self.upper = robot.upper if upper is None else upper
        self.slowest, self.fastest = robot.velocity_lower, robot.velocity_upper
        if self.straight:
            self.lower = np.concatenate((self.lower, self.slowest))
            self.upper = np.concatenate((self.upper, self.fastest))
        self.equalities = (0 if hit.position is None else 3) + (2 if self.straight else 0)
        self.kernel = kernel_for(robot, (hit.contact,), KERNEL)
        self.across = np.array(lateral(tuple(hit.direction)), dtype=float)
        self.across /= np.linalg.norm(self.across, axis=1, keepdims=True)
        self.origin = type(hit.contact)(hit.contact.joint)

    def start(self, q: Array) -> Array:
        """Return points x for configurations q (N, n)."""
        if not self.straight:
            return q
        poses = self.geometry.poses(q)
        columns = self.geometry.point(poses, self.hit.contact)[1]
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
        poses = self.geometry.poses(q) if hit.away or self.objective == "away" else None
        found = self.kernel(q, hit.direction)
        mobility = np.where(found["mobility"][0] < LEAST_MOBILITY, np.nan, found["mobility"][0])
        with np.errstate(divide="ignore"):
            flux = np.log(found["speed"][0]) - np.log1p(hit.mass * mobility)
        value = flux if self.objective == "flux" else -np.log(mobility)
        if poses is not None:
            gap = self._gap(poses)[0]
            if self.objective == "away":
                value = -gap
            else:
                excess = np.maximum(gap + AWAY_MARGIN, 0.0)
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
        poses = self.geometry.poses(q)
        position, columns = self.geometry.point(poses, self.hit.contact)
        pull = columns @ self.hit.direction
        residual: list[Array] = []
        slope: list[Array] = []
        if self.hit.position is not None:
            residual += list((position - self.hit.position).T)
            slope += list(columns.transpose(2, 0, 1))
        if self.straight:
            qd = x[:, self.n :]
            bent = self.geometry.bend(poses, columns, qd)
            for sideways in self.across:
                row = columns @ sideways
                residual.append((row * qd).sum(axis=1))
                slope.append(np.concatenate((bent @ sideways, row), axis=1))
        needs_away = self.hit.away or self.objective == "away"
        gap, gap_by = self._gap(poses) if needs_away else (pull[:, 0], pull)
        if self.objective == "away":
            value, gradient = -gap, -gap_by
        else:
            value, gradient = self._objective(x, q, poses, columns, pull)
            if self.hit.away:
                residual.append(gap + AWAY_MARGIN)
                slope.append(gap_by)
            if self.flux is not None:
                flux, flux_by = self._flux(q, poses, columns, pull)
                residual.append(np.log(self.flux) + FLUX_MARGIN - flux)
                slope.append(-flux_by)
        width = x.shape[1]
        if not residual:
            return Values(value, gradient, np.zeros((len(x), 0)), np.zeros((len(x), 0, width)))
        filled = np.zeros((len(x), len(slope), width))
        for i, part in enumerate(slope):
            filled[:, i, : part.shape[1]] = part
        return Values(value, gradient, np.stack(residual, axis=1), filled)

    def _gap(self, poses: Poses) -> tuple[Array, Array]:
        return self.geometry.gap(poses, self.origin, self.hit.beyond, self.hit.direction)

    def _mobility(self, q: Array) -> tuple[Array, Array]:
        found = self.kernel(q, self.hit.direction, threads=1)
        mobility, gradient = found["mobility"][0], found["mobility_gradient"][0]
        immobile = mobility < LEAST_MOBILITY
        if immobile.any():
            mobility = np.where(immobile, np.nan, mobility)
        return mobility, np.ascontiguousarray(gradient)

    def _objective(
        self, x: Array, q: Array, poses: Poses, columns: Array, pull: Array
    ) -> tuple[Array, Array]:
        if self.objective == "flux":
            return self._flux(q, poses, columns, pull)
        mobility, by = self._mobility(q)
        if not self.straight:
            return -np.log(mobility), -by / mobility[:, None]
        qd = x[:, self.n :]
        speed = (pull * qd).sum(axis=1)
        bent = self.geometry.bend(poses, columns, qd) @ self.hit.direction
        loss = 1.0 + self.hit.mass * mobility
        gradient = np.empty_like(x)
        speed = np.where(speed > 0, speed, np.nan)
        gradient[:, self.n :] = pull / speed[:, None]
        gradient[:, : self.n] = bent / speed[:, None]
        gradient[:, : self.n] -= (self.hit.mass / loss)[:, None] * by
        return np.log(speed) - np.log(loss), gradient

    def _flux(self, q: Array, poses: Poses, columns: Array, pull: Array) -> tuple[Array, Array]:
        """Return the log of the maximum flux and its gradient.

        The speed sum_i |g_i| qd_i has kinks where a g_i vanishes, but they point down: a climb
        leaves them.
        """
        mobility, by = self._mobility(q)
        qd = np.where(pull > 0, self.fastest, self.slowest)
        speed = (pull * qd).sum(axis=1)
        speed = np.where(speed > 0, speed, np.nan)
        bent = self.geometry.bend(poses, columns, qd) @ self.hit.direction
        loss = 1.0 + self.hit.mass * mobility
        value = np.log(speed) - np.log(loss)
        return value, bent / speed[:, None] - (self.hit.mass / loss)[:, None] * by
