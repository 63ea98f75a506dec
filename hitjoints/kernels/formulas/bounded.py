"""Bounded quadratic programs of rank three, one step of the active set method as formulas.

Both programs of a control step have a diagonal Hessian but for J^T J, and rows that J makes. For a
guess of which bounds are active what is left is a linear system of three unknowns. A guess that
the next step would not change is right: the answer then meets all optimality conditions.
(M. Hintermueller, K. Ito, K. Kunisch, SIAM J. Optim. 13(3), 2002.)
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from hitjoints.kernels.formulas.links import dot, minus, plus
from hitjoints.kernels.tape.trace import Scalar, Vector, absolute, maximum, where_less

REGULAR = 1e-9
"""det / trace^3 of J J^T below which an arm counts as singular."""
ROUNDING, SMALLEST = 1e-15, 1e-100
"""Share of a diagonal entry, and number, below which a pivot is as good as none."""


class Guess(NamedTuple):
    """Which bounds are active.

    Attributes:
        sides: -1 for a variable at the lower bound, 1 at the upper, 0 between.
        one_by_one: 1 if the next guess is to differ in one entry only, which ends most cycles.
    """

    sides: list[Scalar]
    one_by_one: Scalar = 0.0


class Iterate(NamedTuple):
    """What a guess of the active bounds gives.

    Attributes:
        x: the variables.
        sides: the next guess.
        changed: how much that differs from the guess; 0 for an answer.
        miss: by how much x violates the equations it was solved from, in their unit.
    """

    x: list[Scalar]
    sides: list[Scalar]
    changed: Scalar
    miss: Scalar


def nearest_velocity(columns: list[Vector], v: Vector) -> tuple[list[Scalar], Scalar]:
    """J^+ v (n), and whether J is regular enough for it (positive)."""
    squared = gram(columns, [1.0] * len(columns))
    force, det = solve_three(squared, v)
    trace = squared[0] + squared[3] + squared[5]
    return [dot(column, force) for column in columns], det - REGULAR * trace * trace * trace


def along_the_field(
    columns: list[Vector],
    f: Vector,
    wish: list[Scalar],
    bounds: tuple[list[Scalar], list[Scalar]],
    guess: Guess,
    progress: float,
) -> Iterate:
    """Least |qd - wish|^2 / 2 - progress s + s^2 / 2 with J qd = s f and 0 <= s <= 1.

    Args:
        columns: of J, (n) of three.
        f: the field.
        wish: (n).
        bounds: lower and upper, (n) each.
        guess: (n + 1), for (qd, s).
        progress: the reward of s.
    """
    rows = [*columns, (-f[0], -f[1], -f[2])]
    lower, upper = [*bounds[0], 0.0], [*bounds[1], 1.0]
    wanted = [*wish, progress]
    free = [_if_free(side, 1.0, 0.0) for side in guess.sides]
    held = _held(guess.sides, lower, upper)
    right = total(rows, [w * p + e for w, p, e in zip(free, wanted, held, strict=True)])
    y, _ = solve_three(gram(rows, free), right)
    best = [p - dot(row, y) for p, row in zip(wanted, rows, strict=True)]
    x = [w * b + e for w, b, e in zip(free, best, held, strict=True)]
    push = [b - value for b, value in zip(best, x, strict=True)]
    return _next(x, push, lower, upper, guess, total(rows, x))


def with_the_flux(
    columns: list[Vector],
    f: Vector,
    h: Vector,
    speed: Scalar,
    nearest: list[Scalar],
    weights: list[Scalar],
    bounds: tuple[list[Scalar], list[Scalar]],
    guess: Guess,
) -> Iterate:
    """Least |J qd - f|^2 / 2 + |qd - nearest|_D^2 / 2 with h . J qd = speed.

    With v = f - J qd - h y, y the multiplier of the row, a free joint has
    qd_i = nearest_i + J_i . v / D_i, and (1 - h h^T + S) v = r for S = sum J_i J_i^T / D_i.

    Args:
        columns: of J, (n) of three.
        f: the field.
        h: unit direction.
        speed: of the row.
        nearest: (n) J^+ f.
        weights: (n) the diagonal D.
        bounds: lower and upper, (n) each.
        guess: (n).
    """
    lower, upper = bounds
    free = [_if_free(side, 1.0, 0.0) for side in guess.sides]
    held = _held(guess.sides, lower, upper)
    easy = [w / d for w, d in zip(free, weights, strict=True)]
    given = total(columns, [w * z + e for w, z, e in zip(free, nearest, held, strict=True)])
    short = dot(h, f) - speed
    right = minus(minus(f, given), (short * h[0], short * h[1], short * h[2]))
    a, b, c, d, e, g = gram(columns, easy)
    x, y, z = h
    system = (
        a + 1.0 - x * x,
        b - x * y,
        c - x * z,
        d + 1.0 - y * y,
        e - y * z,
        g + 1.0 - z * z,
    )
    v, _ = solve_three(system, right)
    pulled = [dot(column, v) for column in columns]
    qd = [
        w * z0 + s * p + e0
        for w, z0, s, p, e0 in zip(free, nearest, easy, pulled, held, strict=True)
    ]
    # In the unit of qd: what a bound holds back.
    push = [
        p / d0 - (value - z0) for p, d0, value, z0 in zip(pulled, weights, qd, nearest, strict=True)
    ]
    miss = plus(v, minus(total(columns, qd), f))  # but for a multiple of h
    along = dot(h, miss)
    across = minus(miss, (along * h[0], along * h[1], along * h[2]))
    row = dot(h, total(columns, qd)) - speed
    return _next(qd, push, lower, upper, guess, (*across, row))


def gram(
    columns: list[Vector], weights: list[Scalar]
) -> tuple[Scalar, Scalar, Scalar, Scalar, Scalar, Scalar]:
    """Sum of w c c^T, as xx xy xz yy yz zz."""
    sums: list[Scalar] = [0.0] * 6
    for column, w in zip(columns, weights, strict=True):
        x, y, z = column
        wx, wy, wz = w * x, w * y, w * z
        for k, part in enumerate((wx * x, wx * y, wx * z, wy * y, wy * z, wz * z)):
            sums[k] = sums[k] + part
    return sums[0], sums[1], sums[2], sums[3], sums[4], sums[5]


def total(columns: list[Vector], factors: list[Scalar]) -> Vector:
    """Sum of x c."""
    result: Vector = (0.0, 0.0, 0.0)
    for c, x in zip(columns, factors, strict=True):
        result = plus(result, (x * c[0], x * c[1], x * c[2]))
    return result


def solve_three(
    S: tuple[Scalar, Scalar, Scalar, Scalar, Scalar, Scalar], v: Vector
) -> tuple[Vector, Scalar]:
    """S^-1 v for a symmetric positive S (xx xy xz yy yz zz), and det S.

    By S = L D L^T: exact to rounding however unlike the sizes in S are. Where a pivot is no more
    than rounding the answer is that of a matrix nearby: what it is good for, residuals tell.
    """
    xx, xy, xz, yy, yz, zz = S
    first = _pivot(xx, xx)
    a, b = xy / first, xz / first
    below = yz - b * xy
    second = _pivot(yy - a * xy, yy)
    c = below / second
    third = _pivot(zz - b * xz - c * below, zz)
    x, y = v[0], v[1] - a * v[0]
    z = (v[2] - b * x - c * y) / third
    y = y / second - c * z
    return (x / first - a * y - b * z, y, z), first * second * third


def _pivot(value: Scalar, size: Scalar) -> Scalar:
    """What is left of a diagonal entry, at least the rounding of its size."""
    return maximum(value, ROUNDING * size + SMALLEST)


def _if_free(side: Scalar, yes: Scalar, no: Scalar) -> Scalar:
    return where_less(absolute(side), 0.5, yes, no)


def _held(sides: list[Scalar], lower: list[Scalar], upper: list[Scalar]) -> list[Scalar]:
    """The value of a variable at its bound, 0 for a free one."""
    return [
        _if_free(side, 0.0, where_less(0.0, side, high, low))
        for side, low, high in zip(sides, lower, upper, strict=True)
    ]


def _next(
    x: list[Scalar],
    push: list[Scalar],
    lower: list[Scalar],
    upper: list[Scalar],
    guess: Guess,
    misses: Sequence[Scalar],
) -> Iterate:
    following: list[Scalar] = []
    changed: Scalar = 0.0
    # From the end, where s is: a guess that holds it too high has no answer, whatever else changes.
    for value, p, low, high, old in reversed(
        list(zip(x, push, lower, upper, guess.sides, strict=True))
    ):
        new = where_less(high - value, p, 1.0, where_less(p, low - value, -1.0, 0.0))
        # From bound to bound it goes by being free: a pull that far is of a guess far off.
        new = where_less(1.5, absolute(new - old), 0.0, new)
        # The first entry that changes is the only one, then (K. G. Murty, Opsearch 11, 1974).
        following.append(where_less(0.5, guess.one_by_one * changed, old, new))
        changed = maximum(changed, absolute(new - old))
    following.reverse()
    miss: Scalar = 0.0
    for part in misses:
        miss = miss + absolute(part)  # a sum: of what is no number nothing may be left out
    return Iterate(x, following, changed, miss)
