"""Eq. 14 and the hitting motion for thousands of starts at once, through the batch kernels."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from hitjoints.built import kernel_for
from hitjoints.model.robot import Contact
from hitjoints.planning.objectives.problem_program import AWAY_MARGIN

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from hitjoints.model.robot import Robot
    from hitjoints.types import Array

ANGLES = (61, 5)
"""Of joint k, and of joint k + 1, that Eq. 14 is tried with: the best of them comes within 0.4 %
of the optimum."""
PART = 500
"""Starts whose angles are evaluated together."""
STEPS = 30
"""Of the motion along the line."""
CUTOFF = 1e-6
"""Relative singular value below which the pseudoinverse leaves a direction out."""


def best_postures(robot: Robot, q: Array, joint: int, h: Array) -> tuple[Array, Array]:
    """Return every row with q_k .. q_n by Eq. 14 on a grid, and its inertia.

    Args:
        robot: the arm.
        joint: k; at most one joint may follow it.
        h: (3,), unit.
        q: (N, n) rad; q_1 .. q_{k-1} are kept.

    Returns:
        (N, n) rad; (N,) kg, nan where no posture points away from the object.
    """
    ends = Contact(joint), robot.beyond(Contact(joint))
    kernel = kernel_for(robot, ends, ("inertia", "position"))
    free = range(joint - 1, robot.n)
    axes = [
        np.linspace(robot.lower[j], robot.upper[j], c)
        for j, c in zip(free, ANGLES[: len(free)], strict=True)
    ]
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, len(free))
    best, inertia = np.array(q), np.full(len(q), np.nan)
    for first in range(0, len(q), PART):
        part = slice(first, first + PART)
        rows = np.repeat(q[part], len(grid), axis=0)
        rows[:, joint - 1 :] = np.tile(grid, (len(q[part]), 1))
        values = kernel(rows, h)
        gap = (values["position"][1] - values["position"][0]) @ h
        allowed = np.where(gap <= -AWAY_MARGIN, values["inertia"][0], -np.inf)
        allowed = allowed.reshape(-1, len(grid))
        chosen = allowed.argmax(axis=1)
        best[part, joint - 1 :] = grid[chosen]
        most = allowed.max(axis=1)
        inertia[part] = np.where(np.isfinite(most), most, np.nan)
    return best, inertia


def along_the_line(
    robot: Robot, q: Array, joint: int, h: Array, distance: float
) -> tuple[Array, NDArray[np.bool_]]:
    """Move joint k of every row straight along h, by Eq. 7 without its null space term.

    Args:
        robot: as `best_postures`.
        joint: as `best_postures`.
        h: as `best_postures`.
        q: (N, n) rad, starts.
        distance: m.

    Returns:
        (N, n) rad, at the end of the way; (N,), whether the row got there within the position
        limits.
    """
    kernel = kernel_for(robot, (Contact(joint),), ("position", "jacobian"))
    origin = kernel(q, h)["position"][0].copy()
    here, inside = np.array(q), np.ones(len(q), dtype=bool)
    for step in range(1, STEPS + 1):
        values = kernel(here, h)
        # Aimed at the next point of the line, a step also takes back the error of the last.
        ahead = origin + (distance * step / STEPS) * h - values["position"][0]
        inverse = np.linalg.pinv(values["jacobian"][0], rcond=CUTOFF)
        here = here + np.einsum("rnc,rc->rn", inverse, ahead)
        inside &= ((here >= robot.lower) & (here <= robot.upper)).all(axis=1)
    miss = np.linalg.norm(kernel(here, h)["position"][0] - origin - distance * h, axis=1)
    return here, inside & (miss < distance / STEPS / 10)
