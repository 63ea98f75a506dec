"""Proofs that a program has no feasible point, in numbers that anyone can check and in words."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from hitjoints.programs.problem import Program

if TYPE_CHECKING:
    from hitjoints.programs.problem import Vector

# Rows with less than this share of the proof are left out of it, if it stands without them.
MINOR = 1e-6


@dataclass(frozen=True, eq=False)
class Infeasibility:
    """Why no x satisfies A x = b, C x <= d, lower <= x <= upper.

    For z >= 0, a feasible x would have y^T (A x - b) + z^T (C x - d) <= 0; its least value over the
    box, known in closed form, is `margin` > 0. (J. Farkas, 1902.)

    Attributes:
        reason: which rows or bounds are in the way, and by how much.
        y: (m,), (p,) multipliers; all zero when the box itself is empty.
        z: (m,), (p,) multipliers; all zero when the box itself is empty.
        margin: the least value; of an empty box, the largest lower - upper.
        roundoff: bound on the rounding error of `margin`, which exceeds it.
        shortfall: every x in the box violates one of the rows by this or more, in the row's unit.
        relative: the same with each row relative to the size of its terms; infinite for an empty
            box, which no tolerance fills.
    """

    reason: str
    y: Vector
    z: Vector
    margin: float
    roundoff: float
    shortfall: float
    relative: float


def show_blocked(program: Program) -> Infeasibility | None:
    """Return a proof of infeasibility by the box or one row alone, or None. Takes no solver."""
    p = program
    if (p.lower > p.upper).any():
        return _empty_box(p)
    rows, right = np.vstack([p.A, p.C]), np.concatenate([p.b, p.d])
    if right.size == 0:
        return None
    ends = rows * p.lower, rows * p.upper
    above = np.minimum(*ends).sum(axis=1) - right
    below = right - np.maximum(*ends).sum(axis=1)
    below[p.b.size :] = -np.inf
    excess = np.maximum(above, below)
    equal, unequal, roundoff = p.row_sizes
    worst = int(np.argmax(excess / np.maximum(np.concatenate([equal, unequal]), roundoff)))
    if excess[worst] <= roundoff:
        return None
    weights = np.zeros(right.size)
    weights[worst] = 1.0 if above[worst] > 0 else -1.0
    return verify(p, weights[: p.b.size], weights[p.b.size :])


def verify(program: Program, y: Vector, z: Vector) -> Infeasibility | None:
    """Return the proof that multipliers y (m,) and z (p,) make, or None if they make none.

    The margin must exceed twice the bound k eps S on its rounding error, S the sum of the
    magnitudes of all its terms and k the number of roundings a term goes through (N. Higham,
    Accuracy and Stability of Numerical Algorithms, 2002, section 3.1), plus the round-off that
    the rows may be missed by (`Program.row_sizes`).
    """
    p = program
    z = np.maximum(z, 0)
    equal, unequal, slack = p.row_sizes
    slope = y @ p.A + z @ p.C
    margin = float(np.minimum(slope * p.lower, slope * p.upper).sum() - y @ p.b - z @ p.d)
    total = float(np.abs(y) @ equal + z @ unequal)
    roundings = p.n + 2 * (p.b.size + p.d.size) + 6
    weight = float(np.abs(y).sum() + z.sum())
    roundoff = roundings * float(np.finfo(float).eps) * total + slack * weight
    if not margin > 2 * roundoff:
        return None
    shortfall = margin / weight
    reason = _words(y, z, shortfall)
    return Infeasibility(reason, y, z, margin, roundoff, shortfall, margin / total)


def show_conflict(program: Program, y: Vector, z: Vector) -> Infeasibility | None:
    """Return the proof that multipliers make, without rows of little share if it stands so."""
    equal, unequal, _ = program.row_sizes
    share = np.concatenate([np.abs(y) * equal, np.abs(z) * unequal])
    for cut in (MINOR, 0.0):
        kept = share >= cut * share.max()
        proof = verify(program, y * kept[: y.size], z * kept[y.size :])
        if proof is not None:
            return proof
    return None


def phase_one(unit: Program) -> Program:
    """Return the program of the least violations: min |r|^2 + |s|^2, A x - r = b, C x - s <= d.

    It is always feasible, and its multipliers, y = r and z = s, are Farkas multipliers of the
    original: y^T (A x - b) + z^T (C x - d) is least over the box at its solution, with value
    |r|^2 + |s|^2. The violations get bounds they cannot reach, for a program needs some.
    """
    n, m, p = unit.n, unit.b.size, unit.d.size
    room = np.concatenate([np.abs(unit.A).sum(axis=1), np.abs(unit.C).sum(axis=1)])
    room += 1 + np.abs(np.concatenate([unit.b, unit.d]))
    none = np.zeros(m + p)
    return Program(
        c=np.zeros(n + m + p),
        lower=np.concatenate([unit.lower, -room]),
        upper=np.concatenate([unit.upper, room]),
        H=np.diag(np.concatenate([np.zeros(n), none + 1])),
        A=np.hstack([unit.A, -np.eye(m), np.zeros((m, p))]),
        b=unit.b,
        C=np.hstack([unit.C, np.zeros((p, m)), -np.eye(p)]),
        d=unit.d,
    )


def _empty_box(program: Program) -> Infeasibility:
    p = program
    crossed = p.lower - p.upper
    which = [int(i) for i in np.flatnonzero(crossed > 0)]
    parts = [f"{i} (lower {p.lower[i]:.6g} > upper {p.upper[i]:.6g})" for i in which]
    reason = f"the bounds leave no room for variable {', '.join(parts)}"
    margin = float(crossed.max())
    none = np.zeros(p.b.size), np.zeros(p.d.size)
    return Infeasibility(reason, *none, margin, 0.0, margin, np.inf)


def _words(y: Vector, z: Vector, shortfall: float) -> str:
    names = [f"equality {i}" for i in np.flatnonzero(y)]
    names += [f"inequality {i}" for i in np.flatnonzero(z)]
    if len(names) == 1:
        return f"within the bounds, {names[0]} is missed by {shortfall:.3g} or more"
    listed = f"{', '.join(names[:-1])} and {names[-1]}"
    return (
        f"within the bounds, {listed} exclude each other: one is missed by {shortfall:.3g} or more"
    )
