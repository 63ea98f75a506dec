"""Arms for the tests: the iiwa 14, two URDF robots and random chains."""

from __future__ import annotations

import functools
from pathlib import Path

import numpy as np
import pinocchio as pin

# origin xyz, origin rpy in multiples of pi, position and velocity limit (deg), mass, com,
# inertia xx yy zz
IIWA14 = (
    ((0, 0, 0.1575), (0, 0, 0), 170, 85, 4, (0, -0.03, 0.12), (0.1, 0.09, 0.02)),
    ((0, 0, 0.2025), (0.5, 0, 1), 120, 85, 4, (0.0003, 0.059, 0.042), (0.05, 0.018, 0.044)),
    ((0, 0.2045, 0), (0.5, 0, 1), 170, 100, 3, (0, 0.03, 0.13), (0.08, 0.075, 0.01)),
    ((0, 0, 0.2155), (0.5, 0, 0), 120, 75, 2.7, (0, 0.067, 0.034), (0.03, 0.01, 0.029)),
    ((0, 0.1845, 0), (-0.5, 1, 0), 170, 130, 1.7, (0.0001, 0.021, 0.076), (0.02, 0.018, 0.005)),
    ((0, 0, 0.2155), (0.5, 0, 0), 120, 135, 1.8, (0, 0.0006, 0.0004), (0.005, 0.0036, 0.0047)),
    ((0, 0.081, 0), (-0.5, 1, 0), 175, 135, 0.3, (0, 0, 0.02), (0.001, 0.001, 0.001)),
)
FOLDER = Path(pin.__file__).parents[4] / "share/example-robot-data/robots"


@functools.cache
def iiwa14() -> pin.Model:
    model = pin.Model()
    model.name = "iiwa14"
    parent = 0
    for i, (xyz, rpy, reach, speed, mass, com, inertia) in enumerate(IIWA14):
        rotation = pin.rpy.rpyToMatrix(np.pi * np.array(rpy, float))
        placement = pin.SE3(rotation, np.array(xyz, float))
        parent = model.addJoint(parent, pin.JointModelRZ(), placement, f"joint_{i + 1}")
        body = pin.Inertia(float(mass), np.array(com, float), np.diag(inertia))
        model.appendBodyToJoint(parent, body, pin.SE3.Identity())
        model.upperPositionLimit[i] = np.deg2rad(reach)
        model.lowerPositionLimit[i] = -np.deg2rad(reach)
        model.velocityLimit[i] = np.deg2rad(speed)
    return model


@functools.cache
def panda() -> pin.Model:
    model = pin.buildModelFromUrdf(str(FOLDER / "panda_description/urdf/panda.urdf"))
    return pin.buildReducedModel(model, [8, 9], pin.neutral(model))


@functools.cache
def xarm7() -> pin.Model:
    return pin.buildModelFromUrdf(str(FOLDER / "xarm_description/urdf/xarm7.urdf"))


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
