"""A control step as formulas: kinematics, field, Eq. 12-13 and the law, for guessed bounds."""

from __future__ import annotations

from typing import NamedTuple

from hitjoints.hitting.field import RATE, SIGMA
from hitjoints.hitting.step import STABLE
from hitjoints.kernels.formulas.bounded import (
    Guess,
    along_the_field,
    nearest_velocity,
    with_the_flux,
)
from hitjoints.kernels.formulas.chain import Chain
from hitjoints.kernels.formulas.hit_formulas import Attachment, HitFormulas
from hitjoints.kernels.formulas.links import TracedArm, dot, minus
from hitjoints.kernels.formulas.mass_matrix import Factor, mass_matrix
from hitjoints.kernels.formulas.speeds import product
from hitjoints.kernels.tape.trace import (
    Number,
    Scalar,
    Tape,
    Tracer,
    Vector,
    absolute,
    maximum,
    minimum,
    square_root,
    where_less,
)
from hitjoints.programs.following import PROGRESS
from hitjoints.programs.joint_velocity import FLOOR, RHO, WITHIN_REACH

SERIES = 14
"""Terms of the exponential's series, which is taken of an argument below one."""
SQUARINGS = 10
"""How often it is squared afterwards."""
EXACT = 1e-9
"""m/s by which an answer may miss its equations."""
FAR = 700.0
"""An exponent beyond which the exponential is as good as zero."""


class Setting(NamedTuple):
    """What stays the same from step to step, in the order of the inputs after q and the guesses.

    Attributes:
        target: of the hit and the loop.
        direction: of the hit and the loop.
        mass: of the hit and the loop.
        flux: of the hit and the loop.
        dt: of the hit and the loop.
        constant_speed: 1 if the field keeps its speed beside the line, else 0.
        by_gradient: 1 if the inertia's gradient weighs the joints in Eq. 12, else 0.
        posture_gain: of the null space.
        inertia_gain: of the null space.
        fixed: 1 and an inertia (kg) in place of Eq. 13's, else 0.
        desired: 1 and an inertia (kg) in place of Eq. 13's, else 0.
        posture: (n,).
    """

    target: Vector
    direction: Vector
    mass: Scalar
    flux: Scalar
    dt: Scalar
    constant_speed: Scalar
    by_gradient: Scalar
    posture_gain: Scalar
    inertia_gain: Scalar
    fixed: Scalar
    desired: Scalar
    posture: tuple[Scalar, ...]


def record_step_of(chain: Chain, contact: Attachment) -> Tape:
    """Record a control step.

    Inputs: q (n), the guesses for Eq. 12 (n) and for the law (n + 1), the `Setting`, bounds of the
    joint velocities beside those of the limits (n), (n), and 1 to change one entry of each guess
    only, else 0. Outputs: whether a step can be made so (positive),
    whether this one misses nothing (positive), how much the guesses changed, the next guesses, qd
    (n), s, the contact's position (3), inertia, desired inertia, speed along the direction, flux,
    whether the wish is out of reach (1 or 0), the gradient (n), the answer of Eq. 12 (n).

    Args:
        chain: the arm, with its limits.
        contact: as `Chain.attach` returns it.
    """
    n = chain.size
    tracer = Tracer(3 * n + 1 + 15 + n + 2 * n + 1)
    numbers = tracer.inputs
    q = numbers[:n]
    first: list[Scalar] = list(numbers[n : 2 * n])
    second: list[Scalar] = list(numbers[2 * n : 3 * n + 1])
    given, one_by_one = _setting(numbers[3 * n + 1 : 4 * n + 16]), numbers[-1]
    hit = _hit(chain, contact, q, given)
    J = _columns(hit, n)
    inertia, gradient = hit.finite_inertia(), _gradient(hit)
    lower, upper = _bounds(chain, q, given.dt, numbers[4 * n + 16 : -1])
    reach: Scalar = 0.0
    for g, low, high in zip(hit.g, lower, upper, strict=True):
        reach = reach + maximum(g * low, g * high)
    wanted = (1.0 + given.mass * hit.mobility_value) * given.flux
    speed = minimum(wanted, reach)
    asked = where_less(reach, wanted, WITHIN_REACH * reach, wanted)
    position = hit.arm.position(hit.last, hit.point)
    f = _field(given, position, speed)
    nearest, usable = nearest_velocity(J, f)
    weights, bounds = _weights(gradient, given), (lower, upper)
    desired_step = with_the_flux(
        J, f, given.direction, asked, nearest, weights, bounds, Guess(first, one_by_one)
    )
    ahead = _hit(
        chain,
        contact,
        tuple(a + given.dt * v for a, v in zip(q, desired_step.x, strict=True)),
        given,
    )
    desired = where_less(0.5, given.fixed, given.desired, ahead.finite_inertia())
    steepness = given.dt * (product(gradient, gradient) + 1e-12)
    gain = minimum(given.inertia_gain, STABLE / steepness) * (inertia - desired)
    wish = [
        given.posture_gain * (p - a) - gain * d
        for p, a, d in zip(given.posture, q, gradient, strict=True)
    ]
    law = along_the_field(J, f, wish, bounds, Guess(second, one_by_one), PROGRESS)
    qd, s = law.x[:-1], law.x[-1]
    along = product(hit.g, qd)
    for limited in (hit, ahead):
        usable = minimum(usable, product(limited.g, limited.g) - limited.floor)
    for value, link in zip(q, chain.links, strict=True):
        # A joint on its limit is within it: nan alone and what is beyond is not.
        within = where_less(value, link.lower, -1.0, where_less(link.upper, value, -1.0, 1.0))
        usable = where_less(absolute(value), float("inf"), minimum(usable, within), -1.0)
    return tracer.program(
        [
            usable,
            EXACT - (law.miss + desired_step.miss),
            maximum(law.changed, desired_step.changed),
            *desired_step.sides,
            *law.sides,
            *qd,
            s,
            *position,
            inertia,
            desired,
            along,
            along / (1.0 + given.mass * hit.mobility_value),
            where_less(reach, wanted, 1.0, 0.0),
            *gradient,
            *desired_step.x,
        ]
    )


def _setting(numbers: tuple[Number, ...]) -> Setting:
    t, h = numbers[:3], numbers[3:6]
    mass, flux, dt, constant, by_gradient, posture, inertia, fixed, desired = numbers[6:15]
    return Setting(
        (t[0], t[1], t[2]),
        (h[0], h[1], h[2]),
        mass,
        flux,
        dt,
        constant,
        by_gradient,
        posture,
        inertia,
        fixed,
        desired,
        numbers[15:],
    )


def _hit(chain: Chain, contact: Attachment, q: tuple[Scalar, ...], given: Setting) -> HitFormulas:
    arm = TracedArm(chain, q)
    return HitFormulas(arm, Factor(mass_matrix(arm)), contact, given.direction, given.mass)


def _columns(hit: HitFormulas, n: int) -> list[Vector]:
    flat = hit.jacobian()
    return [(flat[i], flat[n + i], flat[2 * n + i]) for i in range(n)]


def _gradient(hit: HitFormulas) -> list[Scalar]:
    scale = -(hit.finite_inertia() * hit.finite_inertia())
    return [scale * d for d in hit.mobility_gradient()]


def _bounds(
    chain: Chain, q: tuple[Scalar, ...], dt: Scalar, tighter: tuple[Scalar, ...]
) -> tuple[list[Scalar], list[Scalar]]:
    n = chain.size
    lower = [
        maximum(maximum(link.slowest, (link.lower - a) / dt), low)
        for link, a, low in zip(chain.links, q, tighter[:n], strict=True)
    ]
    upper = [
        minimum(minimum(link.fastest, (link.upper - a) / dt), high)
        for link, a, high in zip(chain.links, q, tighter[n:], strict=True)
    ]
    return lower, upper


def _weights(gradient: list[Scalar], given: Setting) -> list[Scalar]:
    largest: Scalar = 0.0
    for d in gradient:
        largest = maximum(largest, absolute(d))
    share = where_less(0.0, largest, 1.0 / where_less(0.0, largest, largest, 1.0), 0.0)
    some = where_less(0.0, largest, FLOOR, 1.0)
    return [
        RHO * where_less(0.5, given.by_gradient, absolute(d) * share + some, 1.0) for d in gradient
    ]


def _field(given: Setting, position: Vector, speed: Scalar) -> Vector:
    h = given.direction
    offset = minus(position, given.target)
    along = dot(h, offset)
    error = minus(offset, (along * h[0], along * h[1], along * h[2]))
    alpha = _fading(square_root(dot(error, error)) * (1.0 / SIGMA))
    forward, back = alpha * speed, (1.0 - alpha) * RATE
    f = minus(
        (forward * h[0], forward * h[1], forward * h[2]),
        (back * error[0], back * error[1], back * error[2]),
    )
    size = square_root(dot(f, f))
    stretch = where_less(0.0, size, speed / where_less(0.0, size, size, 1.0), 1.0)
    stretch = where_less(0.5, given.constant_speed, stretch, 1.0)
    return stretch * f[0], stretch * f[1], stretch * f[2]


def _fading(x: Scalar) -> Scalar:
    """exp(-x) for x >= 0, to 1e-13."""
    part = minimum(x, FAR) * (-1.0 / 2**SQUARINGS)
    value: Scalar = 1.0
    for k in reversed(range(1, SERIES)):
        value = 1.0 + value * part * (1.0 / k)
    for _ in range(SQUARINGS):
        value = value * value
    return value
