"""The fastest joint velocities straight along a direction, with what certifies them, as formulas.

The dual has its answer in closed form, see `least_support`. It tells at which bound every joint
sits whose reduced speed does not vanish; the others balance the lateral motion of these.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from hitjoints.kernels.formulas.links import dot
from hitjoints.kernels.formulas.speeds import (
    Box,
    lateral,
    least_support,
    principal,
    product,
    support,
)
from hitjoints.kernels.tape.trace import (
    Scalar,
    Vector,
    absolute,
    maximum,
    minimum,
    square_root,
    where_less,
)
from hitjoints.tolerances import RANK, STILL

LEVEL = 1e-9
"""Reduced speeds below this share of the greatest pull vanish."""
RELATIVE, TINY = 1e-13, 1e-18
"""Damping, the second in (m/rad)^2, where fewer than two joints balance."""
PASSES = 6
"""Of balancing: a joint that meets its bound leaves the others to it."""
ROUNDOFF = 1e-14
"""Lateral speed, relative to the largest row's or to 1 m/s, that products of numbers leave."""
LEAST, MOST = 1e-290, 1e290
"""Squares of lengths that are safe to divide by."""


class StraightMotion(NamedTuple):
    """Fastest velocities, and how far they are from optimal.

    Attributes:
        usable: positive if every number is finite, the direction has a length, and the box is not
            empty.
        speed: m/s along the direction.
        qd: (n) rad/s, within the box.
        primal: lateral speed, relative to what the joints could make of it.
        gap: between primal and dual, relative to the greatest pull over the box. The multipliers
            of the bounds are the reduced speeds, so that nothing is missing in the dual.
    """

    usable: Scalar
    speed: Scalar
    qd: list[Scalar]
    primal: Scalar
    gap: Scalar


def straight_motion(columns: list[Vector], direction: Vector, box: Box) -> StraightMotion:
    """Return the fastest motion along a direction without lateral speed.

    Args:
        columns: (n) of the Jacobian, m/rad.
        direction: of any length.
        box: limits of the joint velocities, (n) pairs.
    """
    square = dot(direction, direction)
    sane = where_less(LEAST, square, where_less(square, MOST, 1.0, 0.0), 0.0)
    scale = 1.0 / square_root(where_less(0.0, sane, square, 1.0))
    h = scale * direction[0], scale * direction[1], scale * direction[2]
    a, b = lateral(h)
    g, first, second = ([dot(v, column) for column in columns] for v in (h, a, b))
    size: Scalar = 0.0
    for column in columns:
        size = size + dot(column, column)
    floor = maximum(RANK**2 * size, STILL**2)
    across = principal(first, second, floor * dot(a, a))
    _, x, y = least_support(g, across, box)
    reduced = [p + (x * u + y * v) for p, u, v in zip(g, *across, strict=True)]
    qd = _balanced(g, reduced, across, box)
    speed = product(g, qd)
    reach = [maximum(absolute(low), absolute(high)) for low, high in box]
    rows = [product([absolute(u) for u in row], reach) for row in across]
    roundoff = ROUNDOFF * maximum(1.0, maximum(rows[0], rows[1]))
    primal: Scalar = 0.0
    for row, most in zip(across, rows, strict=True):
        left = absolute(product(row, qd)) - roundoff
        primal = maximum(primal, left / where_less(0.0, most, most, 1.0))
    pull = product([absolute(u) for u in g], reach)
    gap = absolute(support(reduced, box) - speed) / where_less(0.0, pull, pull, 1.0)
    usable = _usable(sane, columns, box)
    return StraightMotion(usable, speed, qd, primal, gap)


def straight_motion_of(given: tuple[Scalar, ...]) -> list[Scalar]:
    """Return `StraightMotion` as one list, for n joints.

    Args:
        given: (5 n + 3) the Jacobian row by row, the direction, the lower limits, the upper.
    """
    n = (len(given) - 3) // 5
    columns: list[Vector] = [(given[i], given[n + i], given[2 * n + i]) for i in range(n)]
    x, y, z = given[3 * n : 3 * n + 3]
    lower, upper = given[3 * n + 3 : 4 * n + 3], given[4 * n + 3 :]
    motion = straight_motion(columns, (x, y, z), list(zip(lower, upper, strict=True)))
    return [motion.usable, motion.speed, *motion.qd, motion.primal, motion.gap]


def _balanced(
    g: list[Scalar],
    reduced: list[Scalar],
    across: tuple[list[Scalar], list[Scalar]],
    box: Box,
) -> list[Scalar]:
    """Return velocities at the bounds that the reduced speeds ask for, the lateral motion undone
    by the joints whose reduced speeds vanish.
    """
    a, b = across
    size: Scalar = 0.0
    for value in g:
        size = maximum(size, absolute(value))
    level = LEVEL * size
    free = [where_less(level, absolute(r), 0.0, 1.0) for r in reduced]
    still = [minimum(maximum(0.0, low), high) for low, high in box]
    qd = [
        where_less(0.5, f, s, where_less(0.0, r, high, low))
        for f, s, r, (low, high) in zip(free, still, reduced, box, strict=True)
    ]
    for _ in range(PASSES):
        u, v = ([f * w for f, w in zip(free, row, strict=True)] for row in (a, b))
        uu, uv, vv = product(u, a), product(u, b), product(v, b)
        damping = RELATIVE * (uu + vv) + TINY
        uu, vv = uu + damping, vv + damping
        p, q = product(a, qd), product(b, qd)
        det = uu * vv - uv * uv
        x, y = (vv * p - uv * q) / det, (uu * q - uv * p) / det
        moved = [w - (x * s + y * t) for w, s, t in zip(qd, u, v, strict=True)]
        free = [
            where_less(low, w, where_less(w, high, f, 0.0), 0.0)
            for f, w, (low, high) in zip(free, moved, box, strict=True)
        ]
        qd = [minimum(maximum(w, low), high) for w, (low, high) in zip(moved, box, strict=True)]
    return qd


def _usable(sane: Scalar, columns: list[Vector], box: Box) -> Scalar:
    """Positive if no number spoils the others: a sum with one that is not finite is not, either."""
    total: Scalar = 0.0
    for column in columns:
        for value in column:
            total = total + absolute(value)
    usable = sane
    for low, high in box:
        total = total + absolute(low) + absolute(high)
        usable = where_less(high, low, 0.0, usable)
    return where_less(total, math.inf, usable, 0.0)
