"""Along the field (Eq. 7): the joint velocity nearest to a posture that moves J qd = s f."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from hitjoints.programs.joint_velocity import Terms, is_regular
from hitjoints.programs.warm import ROWS

if TYPE_CHECKING:
    from hitjoints.programs.problem import Matrix, Vector

PROGRESS = 1e3
"""Reward for following the field, rad^2/s^2: what posture may not outweigh."""
ROUNDOFF = 1e-13
"""Singular values below this share of the largest are round-off."""


class Following(NamedTuple):
    """The program, its bounds, and the unit of its last variable t: s = unit t.

    Attributes:
        terms: in (qd, t).
        lower: (n + 1,).
        upper: (n + 1,).
        unit: 1 unless the arm is nearly singular.
    """

    terms: Terms
    lower: Vector
    upper: Vector
    unit: float


def following_terms(J: Matrix, f: Vector, posture: Vector) -> Terms:
    """Return |qd - posture|^2 / 2 - PROGRESS s + s^2 / 2 under J qd = s f; variables (qd, s).

    When no bound is active, s = 1 and qd = J^+ f + N posture: Eq. 7.
    """
    n = posture.size
    A = np.empty((3, n + 1))
    A[:, :n], A[:, n] = J, -f
    c = np.empty(n + 1)
    c[:n], c[n] = -posture, -PROGRESS
    return Terms(np.eye(n + 1), c, A, np.zeros(3))


def following(J: Matrix, f: Vector, posture: Vector, lower: Vector, upper: Vector) -> Following:
    """Return the same with its bounds, and with all of its numbers of size one.

    Near a singularity an answer is met within a tolerance only if rows and variables are scaled:
    a row of 1e-8 m/rad is as binding as any other, and s may have no more room than that.

    Args:
        J: (3, n) m/rad.
        f: (3,) m/s.
        posture: (n,) rad/s, wanted besides.
        lower: (n,) rad/s.
        upper: (n,) rad/s.
    """
    if is_regular(J @ J.T):
        return Following(
            following_terms(J, f, posture), np.append(lower, 0.0), np.append(upper, 1.0), 1.0
        )
    n = posture.size
    turn, sizes, axes = np.linalg.svd(J, full_matrices=False)
    known = sizes > ROUNDOFF * sizes[0]
    along = f @ turn
    # Each direction of motion bounds s by what the joints can do in it.
    most = np.where(known, sizes, 0.0) * (np.abs(axes) @ np.maximum(upper, -lower))
    needed = np.where(known | (np.abs(along) > ROWS), np.abs(along), 0.0)
    room = float(np.min(most[needed > 0.0] / needed[needed > 0.0], initial=1.0))
    unit = room if room > 0.0 else 1.0
    rows = np.column_stack((sizes[:, None] * axes, -unit * along)) * known[:, None]
    rows /= np.maximum(np.linalg.norm(rows, axis=1), np.finfo(float).tiny)[:, None]
    H, c = np.eye(n + 1), np.append(-posture, -PROGRESS * unit)
    H[n, n] = unit * unit
    # What the joints leave of t ends at 1; a bound of its own would double that.
    end = 0.0 if room == 0.0 else 1.0 if room == 1.0 else 2.0
    terms = Terms(H, c, rows, np.zeros(len(rows)))
    return Following(terms, np.append(lower, 0.0), np.append(upper, end), unit)
