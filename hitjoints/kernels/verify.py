"""Compare a kernel with Pinocchio: it serves only if they agree."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pinocchio as pin

from hitjoints.errors import KernelMismatchError
from hitjoints.kernels.formulas.chain import Triple, velocity_limits
from hitjoints.kernels.formulas.speeds import PARALLEL
from hitjoints.tolerances import MOBILITY_FLOOR, rank_floor

SAMPLES = 24
TOLERANCES = {
    "inertia": 1e-10,
    "mobility": 1e-10,
    "gradient": 1e-9,
    "mobility_gradient": 1e-9,
    "response": 1e-9,
    "position": 1e-12,
    "jacobian": 1e-12,
    "speed": 1e-10,
    "flux": 1e-10,
    "straight_speed": 1e-8,
    "straight_flux": 1e-8,
}
"""Largest deviation, for kinematics and speeds relative to 1 plus their size, else to their
size."""

NEARLY_STUCK = 10.0
"""Up to so many times `rank_floor` a sample is too close to an infeasible direction to compare."""

KINEMATIC = frozenset({"position", "jacobian"})
RELATIVE = frozenset({"inertia", "mobility", "gradient", "mobility_gradient", "response"})
STRAIGHT = frozenset({"straight_speed", "straight_flux"})
STRAIGHT_SAMPLES = 8
"""Samples on which the straight speed is compared: each takes a small enumeration."""

MOST_LOOSE = 4
"""Joints besides the pair that a degenerate vertex may leave undecided."""

Array = np.ndarray[Any, np.dtype[np.float64]]


@dataclass(frozen=True)
class PinocchioAnswers:
    """Pinocchio's answers for one contact at one configuration, named as the outputs."""

    position: Array
    jacobian: Array
    mobility: float
    mobility_gradient: Array
    response: Array

    @classmethod
    def at(
        cls, model: pin.Model, data: pin.Data, q: Array, contact: tuple[int, Triple], h: Array
    ) -> PinocchioAnswers:
        """Evaluate at q (n,) for the unit direction h (3,)."""
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
        position = pose.translation + arm
        still = np.zeros_like(u)
        pin.computeForwardKinematicsDerivatives(model, data, q, u, still)
        dv = pin.getPointVelocityDerivatives(
            model, data, joint, pin.SE3(np.eye(3), offset), pin.LOCAL_WORLD_ALIGNED
        )[0].reshape(3, model.nv)
        # The difference of two calls leaves d(M u)/dq: gravity cancels.
        dMu = pin.computeRNEADerivatives(model, data, q, still, u)[0].copy()
        dMu -= pin.computeRNEADerivatives(model, data, q, still, still)[0]
        return cls(position, J, float(g @ u), 2.0 * h @ dv - u @ dMu, u)


def samples(model: pin.Model, count: int = SAMPLES) -> tuple[Array, Array, Array]:
    """Configurations (count, n) within limits, unit directions (count, 3), masses (count,) kg."""
    random = np.random.default_rng(0)
    low = np.maximum(model.lowerPositionLimit, -np.pi)
    high = np.minimum(model.upperPositionLimit, np.pi)
    q = random.uniform(low, np.maximum(low, high), (count, model.nv))
    h = random.normal(size=(count, 3))
    return q, h / np.linalg.norm(h, axis=1, keepdims=True), random.uniform(0.1, 5.0, count)


def check(
    model: pin.Model,
    contacts: Sequence[tuple[int, Triple]],
    inputs: tuple[Array, Array, Array],
    results: Mapping[str, Array],
) -> None:
    """Compare results with Pinocchio.

    Args:
        model: the arm.
        contacts: joint and offset, (K).
        inputs: q, directions and masses, as from `samples`.
        results: the kernel's outputs for them.

    Raises:
        KernelMismatchError: naming the output and the deviation.
    """
    data = model.createData()
    low, high = velocity_limits(model)
    for k, contact in enumerate(contacts):
        for i, (q, h, mass) in enumerate(zip(*inputs, strict=True)):
            reference = PinocchioAnswers.at(model, data, q, contact, h)
            pull = np.linalg.norm(reference.jacobian.T @ h)
            moves = pull > NEARLY_STUCK * rank_floor(reference.jacobian)
            expected = _expected(reference, h, float(mass), low, high)
            if STRAIGHT.intersection(results) and i < STRAIGHT_SAMPLES:
                speed = straight_optimum(reference.jacobian, h, low, high)
                expected["straight_speed"] = speed
                expected["straight_flux"] = speed / (1.0 + mass * reference.mobility)
            for name in results.keys() & expected.keys():
                if np.isnan(expected[name]).any() or not (moves or name in KINEMATIC):
                    continue
                deviation = float(np.abs(results[name][k, i] - expected[name]).max())
                _refuse(name, contact, deviation, TOLERANCES[name] * _size(name, expected))


def _expected(
    reference: PinocchioAnswers, h: Array, mass: float, low: Array, high: Array
) -> dict[str, Any]:
    g = reference.jacobian.T @ h
    mobility = max(reference.mobility, MOBILITY_FLOOR)
    speed = np.where(g > 0.0, high, low) @ g if g.any() else 0.0
    return {
        "position": reference.position,
        "jacobian": reference.jacobian,
        "mobility": reference.mobility,
        "mobility_gradient": reference.mobility_gradient,
        "response": reference.response,
        "inertia": 1.0 / mobility,
        "gradient": -reference.mobility_gradient / mobility**2,
        "speed": speed,
        "flux": speed / (1.0 + mass * mobility),
    }


def _size(name: str, expected: Mapping[str, Any]) -> float:
    if name not in RELATIVE:
        return 1.0 + float(np.abs(expected[name]).max())
    whole = {"gradient": "inertia", "mobility_gradient": "mobility"}.get(name, name)
    return max(float(np.abs(expected[part]).max()) for part in (name, whole))


def _refuse(name: str, contact: tuple[int, Triple], deviation: float, allowed: float) -> None:
    if not deviation <= allowed:
        raise KernelMismatchError(
            f"{name} at joint {contact[0]}, offset {contact[1]}: "
            f"off by {deviation:.3g} from Pinocchio, {allowed:.3g} allowed"
        )


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
