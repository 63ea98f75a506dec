"""Inverse dynamics over abstract numbers: Newton and Euler, link by link, in the links' frames."""

from __future__ import annotations

from collections.abc import Sequence

from hitjoints.kernels.formulas.chain import Chain, Triple
from hitjoints.kernels.formulas.links import TracedArm, cross, dot, plus
from hitjoints.kernels.formulas.regroup import Inertia
from hitjoints.kernels.tape.trace import Scalar, Tape, Tracer, Vector

ZERO: Vector = (0.0, 0.0, 0.0)


def torques(
    arm: TracedArm, qd: Sequence[Scalar], qdd: Sequence[Scalar], gravity: Vector
) -> list[Scalar]:
    """Torques (n,) N m that give the arm at q, moving at qd, the accelerations qdd.

    Regrouped bodies serve: what is moved into a parent has the same momentum there, and the same
    weight.

    Args:
        arm: the arm at q.
        qd: (n,) rad/s.
        qdd: (n,) rad/s^2.
        gravity: (3,) m/s^2, world.
    """
    forces: list[tuple[Vector, Vector]] = []
    omega, alpha = ZERO, ZERO
    x, y, z = gravity
    a = arm.in_base((-x, -y, -z))
    for i, (link, speed, rate) in enumerate(zip(arm.links, qd, qdd, strict=True)):
        if i:
            a = plus(a, _of_point(omega, alpha, arm.shifts[i]))
        a, alpha, omega = arm.outward(i, a), arm.outward(i, alpha), arm.outward(i, omega)
        along: Vector = (0.0, 0.0, speed)
        if link.prismatic:
            bx, by, bz = cross(omega, along)
            a = plus(a, (2.0 * bx, 2.0 * by, 2.0 * bz + rate))
        else:
            alpha = plus(alpha, plus(cross(omega, along), (0.0, 0.0, rate)))
            omega = plus(omega, along)
        forces.append(_force(link.inertia, omega, alpha, a))
    result: list[Scalar] = [0.0] * len(forces)
    moment, force = ZERO, ZERO
    for i in reversed(range(len(forces))):
        moment, force = plus(moment, forces[i][0]), plus(force, forces[i][1])
        link = arm.links[i]
        result[i] = (force if link.prismatic else moment)[2] + link.armature * qdd[i]
        if i:
            force = arm.inward(i, force)
            moment = plus(arm.inward(i, moment), cross(arm.shifts[i], force))
    return result


def record_torques(chain: Chain, gravity: Triple) -> Tape:
    """Record `torques`. Inputs: q, qd and qdd (n each); outputs: (n)."""
    n = chain.size
    tracer = Tracer(3 * n)
    q, qd, qdd = (tracer.inputs[i * n : (i + 1) * n] for i in range(3))
    return tracer.program(torques(TracedArm(chain, q), qd, qdd, gravity))


def _of_point(omega: Vector, alpha: Vector, r: Vector) -> Vector:
    """Acceleration of a point at r of a turning body, against its origin."""
    return plus(cross(alpha, r), cross(omega, cross(omega, r)))


def _force(body: Inertia, omega: Vector, alpha: Vector, a: Vector) -> tuple[Vector, Vector]:
    """Moment about the frame's origin, and force, that accelerate one body."""
    xx, yy, zz, xy, xz, yz = body.tensor
    rows = (xx, xy, xz), (xy, yy, yz), (xz, yz, zz)
    spin = (dot(rows[0], omega), dot(rows[1], omega), dot(rows[2], omega))
    change = (dot(rows[0], alpha), dot(rows[1], alpha), dot(rows[2], alpha))
    weight = (body.mass * a[0], body.mass * a[1], body.mass * a[2])
    moment = plus(plus(change, cross(omega, spin)), cross(body.moment, a))
    return moment, plus(weight, _of_point(omega, alpha, body.moment))
