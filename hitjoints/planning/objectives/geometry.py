"""Joint axes of rows of configurations, and how a contact's velocity changes with them.

The batch kernels give positions and Jacobians; the planner also needs second derivatives of
positions, which have a closed form in the joint axes: d J_i / d q_j = w_a x J_b with a the smaller
and b the larger of i and j, w the axis of a revolute joint, zero for a prismatic one.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pinocchio as pin

if TYPE_CHECKING:
    from hitjoints.model.robot import Robot
    from hitjoints.types import Array


class Axes:
    """The joint axes of an arm over rows of configurations.

    Args:
        robot: the arm.
    """

    def __init__(self, robot: Robot) -> None:
        model, n = robot.model, robot.n
        # At rest every joint's Jacobian column in its own frame is its axis.
        data = model.createData()
        pin.computeJointJacobians(model, data, np.zeros(n))
        columns = np.array(
            [
                np.reshape(pin.getJointJacobian(model, data, i + 1, pin.LOCAL), (6, n))[:, i]
                for i in range(n)
            ]
        )
        self.revolute = np.linalg.norm(columns[:, 3:], axis=1) > 0.5
        own = np.where(self.revolute[:, None], columns[:, 3:], columns[:, :3])
        along = own[:, :, None] * own[:, None, :]
        # Rodrigues: R(q) = along + cos q (1 - along) + sin q skew.
        turns = np.array([model.jointPlacements[i + 1].rotation for i in range(n)])
        skew = np.array([pin.skew(axis) for axis in own])
        self._parts = turns @ along, turns @ (np.eye(3) - along), turns @ skew
        self._own = np.einsum("iab,ib->ia", turns, own)

    def spins(self, q: Array) -> Array:
        """Return the world axes (N, n, 3) for q (N, n); zero for a prismatic joint."""
        turned = np.where(self.revolute, q, 0.0).T[:, :, None, None]
        fixed, cosine, sine = (part[:, None] for part in self._parts)
        local = fixed + np.cos(turned) * cosine + np.sin(turned) * sine
        axes = np.empty((len(q), q.shape[1], 3))
        rotation = local[0]
        axes[:, 0] = self._own[0]
        for i in range(1, len(local)):
            axes[:, i] = rotation @ self._own[i]
            rotation = rotation @ local[i]
        return np.asarray(axes * self.revolute[:, None])


def bend(spins: Array, columns: Array, qd: Array) -> Array:
    """Return d (J qd) / d q_j at fixed qd, (N, n, 3).

    Turning joint j turns what the joints from j on contribute to the velocity; the joints before
    it turn its own column.

    Args:
        spins: (N, n, 3), see `Axes.spins`.
        columns: (N, n, 3) of the contact's Jacobian.
        qd: (N, n) rad/s.
    """
    beyond = np.cumsum((columns * qd[:, :, None])[:, ::-1], axis=1)[:, ::-1]
    turned = np.cumsum(spins * qd[:, :, None], axis=1)
    before = np.zeros_like(turned)
    before[:, 1:] = turned[:, :-1]
    return cross(spins, beyond) + cross(before, columns)


def cross(a: Any, b: Any) -> Array:
    """Return a x b over the last axis; numpy.cross costs several times as much on small arrays."""
    a0, a1, a2 = a[..., 0], a[..., 1], a[..., 2]
    b0, b1, b2 = b[..., 0], b[..., 1], b[..., 2]
    return np.stack((a1 * b2 - a2 * b1, a2 * b0 - a0 * b2, a0 * b1 - a1 * b0), axis=-1)
