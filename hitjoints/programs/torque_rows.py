"""Torque limits as rows of a velocity program: what one step can change.

The torque that takes an arm from qd to qd+ within dt is tau = M (qd+ - qd) / dt + C qd + g: linear
in qd+. As an impulse, p = tau dt = M qd+ + b with b = (C qd + g) dt - M qd, it becomes a variable
of the program with bounds of its own, so that one solver serves with and without torque limits.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from hitjoints.programs.joint_velocity import Terms

if TYPE_CHECKING:
    from hitjoints.programs.problem import Matrix, Vector


class Impulses(NamedTuple):
    """The impulses p = M qd+ + b that one step demands of the joints, and their limits.

    Attributes:
        M: (n, n) kg m^2, or no rows.
        b: (n,) N m s.
        limit: (n,) N m s, for both signs.
    """

    M: Matrix
    b: Vector
    limit: Vector

    def allow(self, qd: Vector) -> bool:
        """Tell whether the step to qd (n,) rad/s is within the limits."""
        return bool((np.abs(self.M @ qd + self.b) <= self.limit).all())


def any_torque(n: int) -> Impulses:
    """Return the impulses of n joints that no torque limits: no rows."""
    return Impulses(np.zeros((0, n)), np.zeros(0), np.zeros(0))


def with_slack(terms: Terms, count: int, weight: float) -> Terms:
    """Return the terms with a slack e_i in each of the first `count` rows, at a cost of w e^2 / 2.

    The variables are (x, e).
    """
    n, m = terms.c.size, terms.b.size
    H = np.zeros((n + count, n + count))
    H[:n, :n] = terms.H
    H.flat[n * (n + count + 1) :: n + count + 1] = weight
    A = np.zeros((m, n + count))
    A[:, :n] = terms.A
    A[:count, n:] = -np.eye(count)
    return Terms(H, np.concatenate((terms.c, np.zeros(count))), A, terms.b)


def with_impulses(terms: Terms, impulses: Impulses) -> Terms:
    """Return the terms with rows M qd - p = -b; the variables are (x, p), x begins with qd (n,)."""
    size, n, m = terms.c.size, impulses.b.size, terms.b.size
    H = np.zeros((size + n, size + n))
    H[:size, :size] = terms.H
    A = np.zeros((m + n, size + n))
    A[:m, :size] = terms.A
    A[m:, : impulses.M.shape[1]] = impulses.M
    A[m:, size:] = -np.eye(n)
    return Terms(
        H, np.concatenate((terms.c, np.zeros(n))), A, np.concatenate((terms.b, -impulses.b))
    )
