"""From a solver's approximate answer to the exact one: guess what is active, solve for the rest."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from hitjoints.programs.problem import Program, Vector

# Rows of size one that depend on each other to this are one row; a violation of this size is a
# thousand times below what is certified.
DEPENDENT = 1e-11


def polish(program: Program, u: Vector, y: Vector, z: Vector) -> tuple[Vector, Vector, Vector]:
    """Improve an approximate answer of a program over the unit box.

    One step of the primal-dual active set method (M. Hintermueller, K. Ito, K. Kunisch, SIAM J.
    Optim. 13(3), 2002): a bound or an inequality counts as active when its multiplier exceeds its
    slack, for one of the two is zero at the optimum. The others' optimality conditions are linear;
    the smallest change of (u, y, z) that satisfies them is made, so that directions they leave
    open stay where they are. A wrong guess leaves u outside the box or a multiplier of the wrong
    sign, by which the next step mends it.

    Args:
        program: with bounds -1 and 1, rows and cost of order one.
        u: (n,), (m,), (p,) the approximate answer.
        y: (n,), (m,), (p,) the approximate answer.
        z: (n,), (m,), (p,) the approximate answer.

    Returns:
        The improved u, y, z; exact if the guess was right.
    """
    p = program
    w = p.bound_multipliers(u, y, z)
    high, low = w > 1 - u, w < -1 - u
    fixed, active = high | low, z > p.d - p.C @ u
    u, z = np.where(fixed, np.where(high, 1.0, -1.0), u), np.where(active, z, 0.0)
    rows, right = np.vstack([p.A, p.C[active]]), np.concatenate([p.b, p.d[active]])
    free = ~fixed
    k, m = int(free.sum()), right.size
    system = np.zeros((k + m, k + m))
    if p.H is not None:
        system[:k, :k] = p.H[free][:, free]
    system[:k, k:], system[k:, :k] = rows[:, free].T, rows[:, free]
    error = np.concatenate([p.bound_multipliers(u, y, z)[free], right - rows @ u])
    change = np.linalg.lstsq(system, error, rcond=DEPENDENT)[0]
    u[free] += change[:k]
    y = y + change[k : k + p.b.size]
    z[active] += change[k + p.b.size :]
    return u, y, z
