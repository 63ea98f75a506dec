"""What objectives and constraints are made of: the quantities of a hit over abstract numbers.

Second derivatives of positions have a closed form in the joint axes: d J_i / d q_j = w_a x J_b with
a the smaller and b the larger of i and j, w the axis of a revolute joint, zero for a prismatic one.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from hitjoints.kernels.formulas.hit_formulas import HitFormulas
from hitjoints.kernels.formulas.links import TracedArm, cross, dot, minus, plus
from hitjoints.kernels.formulas.mass_matrix import Factor, mass_matrix
from hitjoints.kernels.formulas.speeds import product
from hitjoints.kernels.tape.trace import Scalar, Vector, where_less

if TYPE_CHECKING:
    from hitjoints.kernels import Chain
    from hitjoints.kernels.formulas.hit_formulas import Attachment

LEAST_MOBILITY = 1e-12
"""1/kg: where a contact is harder to move than this it does not hit along the direction."""


@dataclass(frozen=True)
class Given:
    """What is the same for all configurations of a problem.

    Attributes:
        h: the hitting direction.
        forward: its part that the contact moves in.
        target: m, where the contact has to be.
        mass: kg, of the object.
        flux: m/s that the velocities have to have, where that is demanded.
    """

    h: Vector
    forward: Vector
    target: Vector
    mass: Scalar
    flux: Scalar


class TracedHit:
    """One contact at q, moving with qd.

    Args:
        chain: the arm.
        contact: as `Chain.attach` returns it.
        ends: the points chi_k and chi_{k+1} of the away condition, likewise.
        q: (n,) rad.
        qd: (n,) rad/s, of the motion; None where each joint is as fast as it can.
        given: the rest.
        shown: the inverse (1/kg) of another inertia that the arm shows, and its gradient (n).
    """

    def __init__(
        self,
        chain: Chain,
        contact: Attachment,
        ends: tuple[Attachment, Attachment],
        q: tuple[Scalar, ...],
        qd: tuple[Scalar, ...] | None,
        given: Given,
        shown: tuple[Scalar, ...] = (),
    ) -> None:
        self.shown = shown
        self.chain, self.ends, self.given = chain, ends, given
        self.arm = TracedArm(chain, q)
        self.hit = HitFormulas(
            self.arm, Factor(mass_matrix(self.arm)), contact, given.h, given.mass
        )
        flat = self.hit.jacobian()
        n = chain.size
        self.columns: list[Vector] = [(flat[i], flat[n + i], flat[2 * n + i]) for i in range(n)]
        self._qd = qd

    @property
    def any_mobility(self) -> Scalar:
        """h^T J M^-1 J^T h (1/kg), or the inverse of what the arm shows instead."""
        return self.shown[0] if self.shown else self.hit.mobility_value

    @cached_property
    def mobility(self) -> Scalar:
        """The same, no number where the contact is too hard to move to hit with."""
        links = self.hit.mobility_value
        return where_less(links, LEAST_MOBILITY, math.nan, self.any_mobility)

    @cached_property
    def mobility_gradient(self) -> list[Scalar]:
        """Its gradient (n)."""
        return list(self.shown[1:]) or self.hit.mobility_gradient()

    @cached_property
    def missed(self) -> Vector:
        """How far the contact is from the target, m."""
        x, y, z = self.hit.position()
        return minus((x, y, z), self.given.target)

    def row(self, direction: Vector) -> list[Scalar]:
        """J^T a (n) m/rad of a direction in the world."""
        return [dot(direction, column) for column in self.columns]

    @cached_property
    def pull(self) -> list[Scalar]:
        """J^T h without its blind part (n) m/rad."""
        return self.row(self.given.forward)

    @cached_property
    def fastest(self) -> list[Scalar]:
        """The joint velocities (n) rad/s of the greatest speed along the direction (Eq. 9)."""
        return [
            where_less(0.0, pull, link.fastest, link.slowest)
            for pull, link in zip(self.pull, self.chain.links, strict=True)
        ]

    @cached_property
    def qd(self) -> list[Scalar]:
        """The joint velocities (n) rad/s: those that are variables, or else the fastest."""
        return self.fastest if self._qd is None else list(self._qd)

    @cached_property
    def bent(self) -> list[Vector]:
        """D (J qd) / d q_j at fixed qd, (n) of three."""
        return bend(self.arm.axes(), self.columns, self.qd)

    @cached_property
    def flux(self) -> tuple[Scalar, list[Scalar]]:
        """The flux of the velocities (Eq. 10), and the gradient of its logarithm."""
        flux, by_q, by_qd = self._flux_at(self.qd, self.bent)
        return flux, by_q if self._qd is None else [*by_q, *by_qd]

    @cached_property
    def most_flux(self) -> tuple[Scalar, list[Scalar]]:
        """The flux of the fastest velocities, and the gradient (n) of its logarithm.

        The speed sum_i |g_i| qd_i has kinks where a g_i vanishes, but they point down: a climb
        leaves them.
        """
        bent = bend(self.arm.axes(), self.columns, self.fastest)
        return self._flux_at(self.fastest, bent)[:2]

    def _flux_at(
        self, qd: list[Scalar], bent: list[Vector]
    ) -> tuple[Scalar, list[Scalar], list[Scalar]]:
        mass, forward = self.given.mass, self.given.forward
        speed = product(self.pull, qd)
        speed = where_less(0.0, speed, speed, math.nan)
        loss = 1.0 + mass * self.mobility
        share, faster = mass / loss, 1.0 / speed
        by_q = [
            dot(forward, turned) * faster - share * by
            for turned, by in zip(bent, self.mobility_gradient, strict=True)
        ]
        return speed / loss, by_q, [pull * faster for pull in self.pull]

    def short_of(self, flux: Scalar) -> tuple[Scalar, list[Scalar]]:
        """How far the velocities are from a flux, and its gradient.

        In shares of the flux, as the excess of 1 + m mobility over speed / flux: defined for
        velocities that move the contact backwards, too.
        """
        mass, share = self.given.mass, 1.0 / flux
        by_q = [
            mass * by - dot(self.given.forward, bent) * share
            for bent, by in zip(self.bent, self.mobility_gradient, strict=True)
        ]
        short = 1.0 + mass * self.any_mobility - product(self.pull, self.qd) * share
        return short, [*by_q, *(-(pull * share) for pull in self.pull)]

    @cached_property
    def gap(self) -> tuple[Scalar, list[Scalar]]:
        """H . (chi_{k+1} - chi_k) m and its gradient (n)."""
        h, arm = self.given.h, self.arm
        here, there = (arm.position(last - 1, point) for last, point in self.ends)
        views = arm.in_links(h)
        near, far = (
            arm.row(arm.reaches(last - 1, point) if last else [], views)
            for last, point in self.ends
        )
        return dot(h, minus(there, here)), [b - a for a, b in zip(near, far, strict=True)]


def bend(axes: list[Vector], columns: list[Vector], qd: list[Scalar]) -> list[Vector]:
    """Return d (J qd) / d q_j at fixed qd, (n) of three.

    Turning joint j turns what the joints from j on contribute to the velocity; the joints before
    it turn its own column.

    Args:
        axes: (n) in the world, zero of a prismatic joint.
        columns: (n) of the contact's Jacobian.
        qd: (n) rad/s.
    """
    n = len(qd)
    beyond: list[Vector] = [(0.0, 0.0, 0.0)] * (n + 1)
    for j in reversed(range(n)):
        beyond[j] = plus(beyond[j + 1], _times(columns[j], qd[j]))
    before: Vector = (0.0, 0.0, 0.0)
    bent: list[Vector] = []
    for j in range(n):
        bent.append(plus(cross(axes[j], beyond[j]), cross(before, columns[j])))
        before = plus(before, _times(axes[j], qd[j]))
    return bent


def _times(v: Vector, factor: Scalar) -> Vector:
    x, y, z = v
    return factor * x, factor * y, factor * z
