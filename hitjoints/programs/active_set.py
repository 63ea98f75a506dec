"""From a solver's approximate answer to the exact one: guess what is active, solve for the rest."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from hitjoints.programs.problem import Matrix, Program, Vector

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
    fixed, active, u = _active(p, u, y, z)
    z = np.where(active, z, 0.0)
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


def settle(program: Program, u: Vector, y: Vector, z: Vector) -> tuple[Vector, Vector, Vector]:
    """Return the answer with the same bounds and inequalities active, else nothing of (u, y, z).

    A solver's last digits depend on where in memory its numbers lie, and what an optimum leaves
    open on its whole way there. This answer depends on neither: of those that what is active
    leaves, it is the smallest, within the box.

    Args:
        program: as `polish`.
        u: (n,), (m,), (p,) the approximate answer.
        y: (n,), (m,), (p,) the approximate answer.
        z: (n,), (m,), (p,) the approximate answer.
    """
    p = program
    fixed, active, u = _active(p, u, y, z)
    free, held = ~fixed, fixed.copy()
    rows, right = np.vstack([p.A, p.C[active]]), np.concatenate([p.b, p.d[active]])
    y, z = np.zeros_like(y), np.zeros_like(z)
    for _ in range(p.n):
        moving = ~held
        u = np.where(moving, 0.0, u)
        k, m = int(moving.sum()), right.size
        system = np.zeros((int(free.sum()) + m, k + m))
        if p.H is not None:
            system[: len(system) - m, :k] = p.H[free][:, moving]
        system[: len(system) - m, k:] = rows[:, free].T
        system[len(system) - m :, :k] = rows[:, moving]
        error = np.concatenate([p.bound_multipliers(u, y, z)[free], right - rows @ u])
        found = eliminated(system, error)
        u[moving] = found[:k]
        beyond = moving & (np.abs(u) > 1.0)
        if not beyond.any():
            break
        u, held = np.clip(u, -1.0, 1.0), held | beyond
    z[active] = found[k + p.b.size :]
    return u, found[k : k + p.b.size], z


def _active(
    p: Program, u: Vector, y: Vector, z: Vector
) -> tuple[NDArray[np.bool_], NDArray[np.bool_], Vector]:
    """Return which variables lie at a bound, which inequalities are active, and u with the former.

    One counts as active when its multiplier exceeds its slack.
    """
    w = p.bound_multipliers(u, y, z)
    high, low = w > 1 - u, w < -1 - u
    return high | low, z > p.d - p.C @ u, np.where(high | low, np.where(high, 1.0, -1.0), u)


def eliminated(system: Matrix, right: Vector) -> Vector:
    """Return the smallest x (k,) with system x = right; same numbers in, same bits out.

    Gauss-Jordan with full pivoting, element by element: in which order LAPACK sums depends on where
    in memory the numbers lie.

    Args:
        system: (r, k), of size one. What depends on other rows to `DEPENDENT` is left out.
        right: (r,).
    """
    table, k = np.column_stack((system, right)), system.shape[1]
    rows, columns = np.ones((len(right), 1)), np.ones(k)
    pivots: list[tuple[int, int]] = []
    while len(pivots) < min(system.shape):
        sizes = np.abs(table[:, :k]) * rows * columns
        row, column = divmod(int(np.argmax(sizes)), k)
        if not sizes[row, column] > DEPENDENT:
            break
        pivots.append((row, column))
        rows[row], columns[column] = 0.0, 0.0
        table[row] /= table[row, column]
        others = table[:, column].copy()
        others[row] = 0.0
        table -= others[:, None] * table[row]
    at, chosen = [row for row, _ in pivots], [column for _, column in pivots]
    x, left = np.zeros(k), columns.nonzero()[0]
    x[chosen] = table[at, k]
    if not (left.size and pivots):
        return x
    ways = np.zeros((k, left.size))
    ways[chosen] = -table[at][:, left]
    ways[left, np.arange(left.size)] = 1.0
    gram = (ways[:, :, None] * ways[:, None, :]).sum(axis=0)
    along = eliminated(gram, (ways * x[:, None]).sum(axis=0))
    return np.asarray(x - (ways * along).sum(axis=1))
