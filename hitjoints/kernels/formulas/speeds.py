"""Fastest motion of a contact within the joint speed limits, over abstract numbers."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

from hitjoints.kernels.formulas.links import cross
from hitjoints.kernels.tape.trace import (
    Scalar,
    Vector,
    absolute,
    maximum,
    minimum,
    square_root,
    where_less,
)

PARALLEL = 1e-9
"""Sine of the angle below which two joints' lateral velocities count as parallel."""

Box = Sequence[tuple[Scalar, Scalar]]


def support(g: list[Scalar], box: Box) -> Scalar:
    """Largest g . qd over the box (Eq. 9): every joint at the bound its sign asks for."""
    total: Scalar = 0.0
    for value, (low, high) in zip(g, box, strict=True):
        if isinstance(low, float) and low == -high:
            total = total + absolute(value) * high
        else:
            total = total + maximum(value * high, value * low)
    return total


def lateral(h: Vector) -> tuple[Vector, Vector]:
    """Two vectors that span the plane across h and are not small."""
    steep = absolute(h[2])
    a = (
        where_less(steep, 0.8, -h[1], 0.0),
        where_less(steep, 0.8, h[0], -h[2]),
        where_less(steep, 0.8, 0.0, h[1]),
    )
    return a, cross(h, a)


def principal(a: list[Scalar], b: list[Scalar], floor: Scalar) -> tuple[list[Scalar], list[Scalar]]:
    """Turn two rows into orthonormal ones with the same null space, the larger first.

    A row that is no longer than a floor is zero: rounding alone would make it a constraint.

    Args:
        a: (n,) each.
        b: (n,) each.
        floor: square of the floor.
    """
    aa, bb, ab = product(a, a), product(b, b), product(a, b)
    root = square_root((aa - bb) * (aa - bb) + 4.0 * ab * ab)
    # The principal axis of [[aa, ab], [ab, bb]], by the one of two formulas that does not cancel.
    x = where_less(aa, bb, 2.0 * ab, aa - bb + root)
    y = where_less(aa, bb, bb - aa + root, 2.0 * ab)
    x = where_less(0.0, root, x, 1.0)
    length = 1.0 / square_root(x * x + y * y)
    x, y = x * length, y * length
    pairs = list(zip(a, b, strict=True))
    return (
        _unit([x * u + y * v for u, v in pairs], floor),
        _unit([x * v - y * u for u, v in pairs], floor),
    )


def product(a: list[Scalar], b: list[Scalar]) -> Scalar:
    """Dot product of rows (n,)."""
    total: Scalar = 0.0
    for u, v in zip(a, b, strict=True):
        total = total + u * v
    return total


def _unit(row: list[Scalar], floor: Scalar) -> list[Scalar]:
    square = product(row, row)
    scale = where_less(
        floor, square, 1.0 / square_root(where_less(floor, square, square, 1.0)), 0.0
    )
    return [scale * value for value in row]


def straight_support(
    g: list[Scalar], across: tuple[list[Scalar], list[Scalar]], box: Box
) -> Scalar:
    """Largest g . qd over the box with a . qd = b . qd = 0: the fastest motion exactly along h.

    Args:
        g: speed along h per joint speed (n).
        across: lateral speeds a, b per joint speed, (n) each, as `principal` returns them.
        box: joint speed limits around 0.
    """
    return least_support(g, across, box)[0]


def least_support(
    g: list[Scalar], across: tuple[list[Scalar], list[Scalar]], box: Box
) -> tuple[Scalar, Scalar, Scalar]:
    """Least over (x, y) of the largest (g + x a + y b) . qd over the box, and that x and y.

    This dual of `straight_support` is convex and piecewise linear: its minimum is at a kink of two
    joints, of one joint if all lateral velocities are parallel, or at 0 if there are none. Every
    (x, y) gives an upper bound, so the least over all kinks is the maximum.
    """
    a, b = across
    moving = [i for i, speeds in enumerate(zip(g, a, b, strict=True)) if speeds != (0.0, 0.0, 0.0)]
    square = [a[i] * a[i] + b[i] * b[i] for i in range(len(g))]
    best: tuple[Scalar, Scalar, Scalar] = (support(g, box), 0.0, 0.0)
    for i in moving:
        still = where_less(0.0, square[i], 0.0, 1.0)
        scale = -g[i] / (square[i] + still)
        x, y = scale * a[i], scale * b[i]
        value = _dual(g, a, b, box, x, y, (i,))
        best = _lesser((where_less(0.0, square[i], value, math.inf), x, y), best)
    for i, j in itertools.combinations(moving, 2):
        det = a[i] * b[j] - a[j] * b[i]
        least = PARALLEL**2 * (square[i] * square[j])
        crossing = where_less(least, det * det, 1.0 / where_less(least, det * det, det, 1.0), 0.0)
        x = (g[j] * b[i] - g[i] * b[j]) * crossing
        y = (g[i] * a[j] - g[j] * a[i]) * crossing
        value = _dual(g, a, b, box, x, y, (i, j))
        best = _lesser((where_less(least, det * det, value, math.inf), x, y), best)
    return best


def _lesser(
    new: tuple[Scalar, Scalar, Scalar], best: tuple[Scalar, Scalar, Scalar]
) -> tuple[Scalar, Scalar, Scalar]:
    x, y = (where_less(new[0], best[0], p, q) for p, q in zip(new[1:], best[1:], strict=True))
    return minimum(best[0], new[0]), x, y


def _dual(
    g: list[Scalar],
    a: list[Scalar],
    b: list[Scalar],
    box: Box,
    x: Scalar,
    y: Scalar,
    kinks: tuple[int, ...],
) -> Scalar:
    reduced = [0.0 if i in kinks else g[i] + (x * a[i] + y * b[i]) for i in range(len(g))]
    return support(reduced, box)
