"""Points, Jacobians and their derivatives for rows of configurations.

The batch kernels give inertias and their gradients; the planner also needs second derivatives of
positions, which have a closed form in the joint axes: d J_i / d q_j = w_a x J_b with a the smaller
and b the larger of i and j, w the axis of a revolute joint, zero for a prismatic one.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import pinocchio as pin

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from hitjoints.robot import Contact, Robot

    Array = NDArray[np.float64]


@dataclass(frozen=True)
class Poses:
    """Where the joints of N configurations are.

    Attributes:
        rotations: (n, N, 3, 3), of the joint frames.
        origins: (n, N, 3) m, of the joint frames: chi_1 .. chi_n.
        axes: (N, n, 3) world axes.
    """

    rotations: Array
    origins: Array
    axes: Array


class Geometry:
    """The arm's kinematics over rows of configurations.

    Args:
        robot: the arm.
    """

    def __init__(self, robot: Robot) -> None:
        model, n = robot.model, robot.n
        # At rest every joint's Jacobian column in its own frame is its axis.
        data = model.createData()
        pin.computeJointJacobians(model, data, np.zeros(n))
        columns = np.array(
            [np.reshape(pin.getJointJacobian(model, data, i + 1, pin.LOCAL), (6, n))[:, i]
             for i in range(n)]
        )  # fmt: skip
        self.revolute = np.linalg.norm(columns[:, 3:], axis=1) > 0.5
        axes = np.where(self.revolute[:, None], columns[:, 3:], columns[:, :3])
        placements = [model.jointPlacements[i + 1] for i in range(n)]
        along = axes[:, :, None] * axes[:, None, :]
        # Rodrigues: R(q) = along + cos q (1 - along) + sin q skew.
        turns = np.array([p.rotation for p in placements])
        skew = np.array([pin.skew(axis) for axis in axes])
        self._parts = turns @ along, turns @ (np.eye(3) - along), turns @ skew
        self._shifts = np.array([p.translation for p in placements])
        self._axes = np.einsum("iab,ib->ia", turns, axes)

    def poses(self, q: Array) -> Poses:
        """Return where the joints are, for q (N, n)."""
        turned = np.where(self.revolute, q, 0.0).T[:, :, None, None]
        slid = np.where(self.revolute, 0.0, q).T[:, :, None]
        fixed, cosine, sine = (part[:, None] for part in self._parts)
        local = fixed + np.cos(turned) * cosine + np.sin(turned) * sine
        shifts = self._shifts[:, None, :] + slid * self._axes[:, None, :]
        n, rows = len(local), len(q)
        rotations, origins = np.empty((n, rows, 3, 3)), np.empty((n, rows, 3))
        axes = np.empty((rows, n, 3))
        rotations[0], origins[0], axes[:, 0] = local[0], shifts[0], self._axes[0]
        for i in range(1, n):
            before = rotations[i - 1]
            np.matmul(before, local[i], out=rotations[i])
            axes[:, i] = before @ self._axes[i]
            origins[i] = origins[i - 1] + (before @ shifts[i][:, :, None])[:, :, 0]
        return Poses(rotations, origins, axes)

    def point(self, poses: Poses, contact: Contact) -> tuple[Array, Array]:
        """Return a contact's position (N, 3) m and the columns (N, n, 3) of its Jacobian."""
        last = contact.joint - 1
        position = self._place(poses, contact)
        columns = np.zeros_like(poses.axes)
        reach = position[:, None, :] - np.moveaxis(poses.origins[: last + 1], 0, 1)
        columns[:, : last + 1] = cross(poses.axes[:, : last + 1], reach)
        slides = np.flatnonzero(~self.revolute[: last + 1])
        columns[:, slides] = poses.axes[:, slides]
        return position, columns

    def gap(
        self, poses: Poses, near: Contact, far: Contact, direction: Array
    ) -> tuple[Array, Array]:
        """Return a . (chi_far - chi_near) (N,) m for a direction a, and its gradient (N, n).

        Args:
            poses: of the configurations.
            near: an earlier contact, or one on the same joint.
            far: a later one.
            direction: (3,) a.
        """
        first, last = near.joint, far.joint
        start, end = self._place(poses, near), self._place(poses, far)
        between = (end - start)[:, None, :]
        reach = end[:, None, :] - np.moveaxis(poses.origins[first:last], 0, 1)
        axes = poses.axes[:, :last]
        reach = np.concatenate((np.broadcast_to(between, (len(end), first, 3)), reach), axis=1)
        row = np.zeros(poses.axes.shape[:2])
        row[:, :last] = (cross(direction, axes) * reach).sum(axis=2)
        slides = np.flatnonzero(~self.revolute[:last])
        row[:, slides] = (axes[:, slides] @ direction) * (slides >= first)
        return between[:, 0] @ direction, row

    def _place(self, poses: Poses, contact: Contact) -> Array:
        position = poses.origins[contact.joint - 1]
        if any(contact.offset):
            position = position + poses.rotations[contact.joint - 1] @ np.array(contact.offset)
        return np.asarray(position)

    def bend(self, poses: Poses, columns: Array, qd: Array) -> Array:
        """Return d (J qd) / d q_j at fixed qd, (N, n, 3).

        Turning joint j turns what the joints from j on contribute to the velocity; the joints
        before it turn its own column.

        Args:
            poses, columns: of the configurations and of the contact.
            qd: (N, n) rad/s.
        """
        spins = poses.axes * self.revolute[:, None]
        moved = columns * qd[:, :, None]
        beyond = np.cumsum(moved[:, ::-1], axis=1)[:, ::-1]
        turned = np.cumsum(spins * qd[:, :, None], axis=1)
        before = np.zeros_like(turned)
        before[:, 1:] = turned[:, :-1]
        return cross(spins, beyond) + cross(before, columns)


def cross(a: Any, b: Any) -> Array:
    """Return a x b over the last axis; numpy.cross costs several times as much on small arrays."""
    a0, a1, a2 = a[..., 0], a[..., 1], a[..., 2]
    b0, b1, b2 = b[..., 0], b[..., 1], b[..., 2]
    return np.stack((a1 * b2 - a2 * b1, a2 * b0 - a0 * b2, a0 * b1 - a1 * b0), axis=-1)
