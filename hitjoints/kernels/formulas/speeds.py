"""Fastest motion of a contact within the joint speed limits, over abstract numbers."""

from __future__ import annotations

import itertools
import math

from hitjoints.kernels.formulas.links import cross
from hitjoints.kernels.tape.trace import Scalar, Vector, absolute, maximum, minimum, where_less

PARALLEL = 1e-9
"""Sine of the angle below which two joints' lateral velocities count as parallel."""

Box = list[tuple[float, float]]


def support(g: list[Scalar], box: Box) -> Scalar:
    """Largest g . qd over the box (Eq. 9): every joint at the bound its sign asks for."""
    total: Scalar = 0.0
    for value, (low, high) in zip(g, box, strict=True):
        if low == -high:
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


def straight_support(
    g: list[Scalar], across: tuple[list[Scalar], list[Scalar]], box: Box
) -> Scalar:
    """Largest g . qd over the box with a . qd = b . qd = 0: the fastest motion exactly along h.

    The dual min over mu of sum_i max over the box of (g_i + mu . (a_i, b_i)) qd_i is convex and
    piecewise
    linear: its minimum is at a kink of two joints, of one joint if all lateral velocities are
        parallel, or
    at 0 if there are none. Every mu gives an upper bound, so the least over all kinks is the
    maximum.

    Args:
        g: speed along h per joint speed (n).
        across: lateral speeds a, b per joint speed, (n) each.
        box: joint speed limits around 0.
    """
    a, b = across
    moving = [i for i, speeds in enumerate(zip(g, a, b, strict=True)) if speeds != (0.0, 0.0, 0.0)]
    square = [a[i] * a[i] + b[i] * b[i] for i in range(len(g))]
    best = support(g, box)
    for i in moving:
        still = where_less(0.0, square[i], 0.0, 1.0)
        scale = -g[i] / (square[i] + still)
        value = _dual(g, a, b, box, scale * a[i], scale * b[i], (i,))
        best = minimum(best, where_less(0.0, square[i], value, math.inf))
    for i, j in itertools.combinations(moving, 2):
        det = a[i] * b[j] - a[j] * b[i]
        least = PARALLEL**2 * (square[i] * square[j])
        crossing = where_less(least, det * det, 1.0 / where_less(least, det * det, det, 1.0), 0.0)
        x = (g[j] * b[i] - g[i] * b[j]) * crossing
        y = (g[i] * a[j] - g[j] * a[i]) * crossing
        value = _dual(g, a, b, box, x, y, (i, j))
        best = minimum(best, where_less(least, det * det, value, math.inf))
    return best


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
