"""Arms for the tests: models of built-in robots, and random chains."""

from __future__ import annotations

import functools

import numpy as np
import pinocchio as pin

from hitjoints.loading.load import load_robot


def model_of(name: str) -> pin.Model:
    return load_robot(name).model


iiwa14, iiwa7, panda, xarm7 = (
    functools.cache(functools.partial(model_of, name))
    for name in ("iiwa14", "iiwa7", "panda", "xarm7")
)


def random_chain(seed: int, joints: int | None = None, prismatic: float = 0.25) -> pin.Model:
    rng = np.random.default_rng(seed)
    model = pin.Model()
    model.name = f"chain {seed}"
    aligned = (pin.JointModelRX, pin.JointModelRY, pin.JointModelRZ)
    sliding = (pin.JointModelPX, pin.JointModelPY, pin.JointModelPZ)
    parent = 0
    for i in range(joints or int(rng.integers(2, 13))):
        slides, skew = rng.random() < prismatic, rng.random() < 0.5
        axis = rng.normal(size=3)
        axis /= np.linalg.norm(axis)
        if skew:
            joint = (
                pin.JointModelPrismaticUnaligned if slides else pin.JointModelRevoluteUnaligned
            )(axis)
        else:
            joint = (sliding if slides else aligned)[rng.integers(3)]()
        rotation = pin.Quaternion(rng.normal(size=4)).normalized().matrix()
        placement = pin.SE3(rotation, rng.uniform(-0.4, 0.4, 3))
        parent = model.addJoint(parent, joint, placement, f"joint_{i + 1}")
        spread = rng.normal(size=(3, 8))
        mass = rng.uniform(0.3, 5.0)
        second = 0.003 * mass * spread @ spread.T / 8
        body = pin.Inertia(mass, rng.uniform(-0.1, 0.1, 3), np.trace(second) * np.eye(3) - second)
        model.appendBodyToJoint(parent, body, pin.SE3.Identity())
    n = model.nv
    model.armature = rng.uniform(0.0, 0.2, n) * (rng.random(n) < 0.5)
    model.lowerPositionLimit = -rng.uniform(1.0, 3.0, n)
    model.upperPositionLimit = rng.uniform(1.0, 3.0, n)
    model.velocityLimit = rng.uniform(0.5, 3.0, n)
    return model


def configurations(model: pin.Model, count: int, seed: int = 0) -> np.ndarray:
    low = np.maximum(model.lowerPositionLimit, -np.pi)
    high = np.minimum(model.upperPositionLimit, np.pi)
    return np.random.default_rng(seed).uniform(low, high, (count, model.nv))


def directions(count: int, seed: int = 0) -> np.ndarray:
    h = np.random.default_rng(seed + 1000).normal(size=(count, 3))
    return h / np.linalg.norm(h, axis=1, keepdims=True)
