"""The quantities of a hit, written once over abstract numbers."""

from __future__ import annotations

import math

from hitjoints.impact.flux import flux
from hitjoints.kernels.formulas.chain import Chain, Triple
from hitjoints.kernels.formulas.links import TracedArm, dot
from hitjoints.kernels.formulas.mass_matrix import Factor, mobility_gradient, variation
from hitjoints.kernels.formulas.speeds import (
    Box,
    lateral,
    principal,
    product,
    straight_support,
    support,
)
from hitjoints.kernels.tape.trace import Scalar, Tape, Tracer, Vector, maximum, where_less
from hitjoints.tolerances import MOBILITY_FLOOR, RANK, STILL

Attachment = tuple[int, Triple]


class HitFormulas:
    """One contact hitting along h: every quantity as formulas, in the units of the outputs.

    Args:
        arm: the arm at q.
        factor: U D U^T of its mass matrix.
        contact: last joint that moves the contact (1-based, 0: none) and the place in its link's
            frame.
        h: unit direction (world).
        mass: object's mass (kg).
    """

    def __init__(
        self, arm: TracedArm, factor: Factor, contact: Attachment, h: Vector, mass: Scalar
    ) -> None:
        self.arm, self.h, self.mass = arm, h, mass
        last, self.point = contact
        self.last = last - 1
        self.directions = arm.in_links(h)
        self.reaches = arm.reaches(self.last, self.point) if last else []
        self.g = arm.row(self.reaches, self.directions)
        self.y = factor.reduce(self.g)
        self.factor = factor
        self.mobility_value = factor.mobility(self.y)
        self.box: Box = [(link.slowest, link.fastest) for link in arm.links]
        self.floor = maximum(RANK**2 * arm.size(self.reaches), STILL**2)

    def if_feasible(self, value: Scalar, otherwise: float) -> Scalar:
        """The value, or its limit when the contact cannot move along h (`rank_floor`)."""
        return where_less(self.floor, product(self.g, self.g), value, otherwise)

    def mobility(self) -> list[Scalar]:
        """h^T J M^-1 J^T h (1/kg)."""
        return [self.mobility_value]

    def response(self) -> list[Scalar]:
        """Joint speeds after a unit impulse along h, M^-1 J^T h, (n,) (rad/s per N s)."""
        return self.factor.velocity(self.y)

    def mobility_gradient(self) -> list[Scalar]:
        """Its derivative with respect to q, (n,) (1/(kg rad))."""
        return mobility_gradient(self.arm, self.reaches, self.directions, self.response())

    def finite_inertia(self) -> Scalar:
        """1 / mobility, capped so that it stays finite."""
        return 1.0 / maximum(self.mobility_value, MOBILITY_FLOOR)

    def inertia(self) -> list[Scalar]:
        """Directional inertia 1 / (h^T J M^-1 J^T h) (kg), infinite when infeasible."""
        return [self.if_feasible(self.finite_inertia(), math.inf)]

    def gradient(self) -> list[Scalar]:
        """Its derivative with respect to q, (n,) (kg/rad), nan when infeasible."""
        scale = -(self.finite_inertia() * self.finite_inertia())
        return [self.if_feasible(scale * d, math.nan) for d in self.mobility_gradient()]

    def speed(self) -> list[Scalar]:
        """Largest speed along h in the joint speed limits (m/s), Eq. 9."""
        return [self.if_feasible(support(self.g, self.box), 0.0)]

    def straight_speed(self) -> list[Scalar]:
        """The same for motion exactly along h (m/s)."""
        a, b = lateral(self.h)
        rows = [self.arm.row(self.reaches, self.arm.in_links(v)) for v in (a, b)]
        across = principal(rows[0], rows[1], self.floor * dot(a, a))
        fastest = straight_support(self.g, across, self.box)
        return [self.if_feasible(fastest, 0.0)]

    def flux(self) -> list[Scalar]:
        """Largest hitting flux lambda / (lambda + m) v (m/s), Eq. 10 as corrected."""
        return [flux(self.mobility_value, self.mass, self.speed()[0])]

    def straight_flux(self) -> list[Scalar]:
        """The same for motion exactly along h (m/s)."""
        return [flux(self.mobility_value, self.mass, self.straight_speed()[0])]

    def position(self) -> list[Scalar]:
        """World position of the contact, (3,) (m)."""
        return list(self.arm.position(self.last, self.point))

    def jacobian(self) -> list[Scalar]:
        """World-aligned translational Jacobian of the contact, (3, n) row by row (m/rad)."""
        arm = self.arm
        columns = [arm.in_world(arm.inward(0, c)) for c in arm.columns(self.reaches)]
        columns += [(0.0, 0.0, 0.0)] * (len(arm.links) - len(columns))
        return [column[axis] for axis in range(3) for column in columns]


def record_variation(chain: Chain, contact: Attachment) -> Tape:
    """Record `variation` for a given u.

    Inputs: q (n), direction (3), u (n); outputs: the value, its derivative (n).
    """
    n = chain.size
    tracer = Tracer(2 * n + 3)
    h = tracer.inputs[n], tracer.inputs[n + 1], tracer.inputs[n + 2]
    arm = TracedArm(chain, tracer.inputs[:n])
    u: list[Scalar] = list(tracer.inputs[n + 3 :])
    last, point = contact
    directions, reaches = arm.in_links(h), arm.reaches(last - 1, point) if last else []
    return tracer.program(variation(arm, reaches, directions, u))
