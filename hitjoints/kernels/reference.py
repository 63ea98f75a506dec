"""What Pinocchio and a search of vertices answer where a kernel is checked."""

from __future__ import annotations

import itertools
from functools import cached_property
from typing import Any

import numpy as np
import pinocchio as pin

from hitjoints.kernels.formulas.chain import Triple, velocity_limits
from hitjoints.kernels.formulas.speeds import PARALLEL
from hitjoints.tolerances import MOBILITY_FLOOR, rank_floor

MOST_LOOSE = 4
"""Joints besides the pair that a degenerate vertex may leave undecided."""

NEARLY_STUCK = 10.0
"""Up to so many times `rank_floor` a sample is too close to an infeasible direction to compare."""

Array = np.ndarray[Any, np.dtype[np.float64]]


class PinocchioAnswers:
    """The answers for one contact at one configuration, named as the outputs.

    Args:
        model: the arm.
        data: of it, overwritten.
        q: (n,) configuration.
        contact: joint and offset.
        h: (3,) unit direction.
        mass: kg, of the object.
    """

    def __init__(
        self,
        model: pin.Model,
        data: pin.Data,
        q: Array,
        contact: tuple[int, Triple],
        h: Array,
        mass: float = 0.0,
    ) -> None:
        self.h, self.mass, self.limits = h, mass, velocity_limits(model)
        joint, offset = contact[0], np.array(contact[1])
        pin.crba(model, data, q)
        pin.computeJointJacobians(model, data, q)
        pose = data.oMi[joint]
        arm = pose.rotation @ offset
        # Pinocchio gives the single column of a one-joint arm as a vector, and the derivative too.
        J = pin.getJointJacobian(model, data, joint, pin.LOCAL_WORLD_ALIGNED).reshape(6, model.nv)
        J = J[:3] - np.cross(arm, J[3:], axisb=0, axisc=0)
        g = J.T @ h
        pin.cholesky.decompose(model, data)
        u = pin.cholesky.solve(model, data, g)
        still = np.zeros_like(u)
        pin.computeForwardKinematicsDerivatives(model, data, q, u, still)
        dv = pin.getPointVelocityDerivatives(
            model, data, joint, pin.SE3(np.eye(3), offset), pin.LOCAL_WORLD_ALIGNED
        )[0].reshape(3, model.nv)
        # The difference of two calls leaves d(M u)/dq: gravity cancels.
        dMu = pin.computeRNEADerivatives(model, data, q, still, u)[0].copy()
        dMu -= pin.computeRNEADerivatives(model, data, q, still, still)[0]
        self.position: Array = pose.translation + arm
        self.jacobian: Array = J
        self.pull: Array = g
        self.response: Array = u
        self.mobility = float(g @ u)
        self.mobility_gradient: Array = 2.0 * h @ dv - u @ dMu

    @property
    def moves(self) -> bool:
        """The contact moves along h by enough to compare what depends on that."""
        return bool(np.linalg.norm(self.pull) > NEARLY_STUCK * rank_floor(self.jacobian))

    @property
    def inertia(self) -> float:
        """Kg."""
        return 1.0 / max(self.mobility, MOBILITY_FLOOR)

    @property
    def gradient(self) -> Array:
        """(n,) kg/rad."""
        return -self.mobility_gradient * self.inertia**2

    @property
    def speed(self) -> float:
        """m/s."""
        low, high = self.limits
        g = self.pull
        return float(np.where(g > 0.0, high, low) @ g) if g.any() else 0.0

    @cached_property
    def straight_speed(self) -> float:
        """m/s, nan where no vertex is certified."""
        return straight_optimum(self.jacobian, self.h, *self.limits)

    @property
    def flux(self) -> float:
        """m/s, Eq. 4 as it is printed: the compiled one has another form."""
        return self.inertia / (self.inertia + self.mass) * self.speed

    @property
    def straight_flux(self) -> float:
        """m/s."""
        return self.inertia / (self.inertia + self.mass) * self.straight_speed


def straight_optimum(J: Array, h: Array, low: Array, high: Array) -> float:
    """Largest speed (m/s) exactly along h within the box, nan if no vertex could be certified.

    For every choice of as many joints as there are rows across h, the others go to the bounds
    their reduced costs ask for and these cancel the lateral motion. Joint speeds found so are
    optimal as soon as they are feasible: complementary slackness.
    """
    g = J.T @ h
    _, sizes, rows = np.linalg.svd(np.linalg.svd(h[None, :])[2][1:] @ J, full_matrices=False)
    across = rows[sizes > rank_floor(J)]
    rank, norms = len(across), np.linalg.norm(across, axis=0)
    bases = map(list, itertools.combinations(np.flatnonzero(norms).tolist(), rank))
    for base in bases:
        square = across[:, base]
        if not abs(np.linalg.det(square)) > PARALLEL * norms[base].prod():
            continue
        mu = -np.linalg.solve(square.T, g[base])
        reduced = g + mu @ across
        noise = 1e-13 * (np.abs(g) + np.abs(mu) @ np.abs(across))
        loose = [
            i for i in np.flatnonzero((np.abs(reduced) <= noise) & (norms > 0.0)) if i not in base
        ]
        for corner in itertools.product((low, high), repeat=min(len(loose), MOST_LOOSE)):
            qd = np.where(reduced > 0.0, high, low)
            for i, bound in zip(loose, corner, strict=False):
                qd[i] = bound[i]
            qd[base] = 0.0
            qd[base] = np.linalg.solve(square, -across @ qd)
            if np.all((qd >= low - 1e-12) & (qd <= high + 1e-12)):
                return float(g @ qd)
    return np.nan
