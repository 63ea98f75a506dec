"""The arm in the physics engine: the joints and inertias of its Pinocchio model, no meshes.

Nothing else acts on it: no damping, no friction in the joints, no limits, and gravity is
compensated link by link. Rotor inertia is that of the model, so that both have one mass matrix.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from hitjoints.kernels.formulas.chain import joint_axes
from hitjoints.model.engine import engine

if TYPE_CHECKING:
    from hitjoints.model.robot import Robot
    from hitjoints.types import Array

LEAST_INERTIA = 1e-12
"""kg and kg m^2: what a link without mass gets, because the engine refuses none."""


def link_name(joint: int) -> str:
    """Return the name of the body that a joint (1-based) carries."""
    return f"link_{joint}"


def arm_spec(robot: Robot) -> Any:
    """Return an editable MuJoCo model, `mujoco.MjSpec`, of an arm.

    Joint i is named as in `robot.joint_names` and moves the body `link_name(i)`, whose frame is
    that of Pinocchio's joint: positions and velocities mean the same in both.

    Raises:
        MissingExtraError: MuJoCo is not installed.
    """
    mujoco = engine()
    model = robot.model
    spec = mujoco.MjSpec()
    spec.compiler.boundmass = spec.compiler.boundinertia = LEAST_INERTIA
    axes, prismatic = joint_axes(model)
    body = spec.worldbody
    for i, name in enumerate(robot.joint_names):
        placement, inertia = model.jointPlacements[i + 1], model.inertias[i + 1]
        moments, axes_of_inertia = np.linalg.eigh(inertia.inertia)
        if np.linalg.det(axes_of_inertia) < 0:
            axes_of_inertia[:, 0] *= -1
        body = body.add_body(
            name=link_name(i + 1),
            pos=placement.translation,
            quat=quaternion(placement.rotation),
            gravcomp=1,
            explicitinertial=True,
            mass=inertia.mass,
            ipos=inertia.lever,
            inertia=moments,
            iquat=quaternion(axes_of_inertia),
        )
        kind = mujoco.mjtJoint
        body.add_joint(
            name=name,
            type=kind.mjJNT_SLIDE if prismatic[i] else kind.mjJNT_HINGE,
            axis=axes[i],
            armature=model.armature[i],
            limited=mujoco.mjtLimited.mjLIMITED_FALSE,
        )
    return spec


def add_motors(spec: Any, robot: Robot, rotors: Array, stiffness: Array) -> list[str]:
    """Put every joint's motor behind a spring: a body of its own, as many degrees of freedom more.

    A motor turns about an axis of its own in the base; a spring, a tendon of the engine, pulls at
    the difference of motor and link. A joint whose rotor is zero keeps nothing but its link.

    Args:
        spec: of an arm.
        robot: the arm.
        rotors: (n,) kg m^2, reflected through the gears.
        stiffness: (n,) N m/rad.

    Returns:
        Name of the motor's joint for every joint, empty where there is none.
    """
    mujoco = engine()
    names = [""] * robot.n
    for i in np.flatnonzero(rotors > 0):
        names[i] = name = f"motor_{i + 1}"
        motor = spec.worldbody.add_body(name=name, gravcomp=1)
        motor.explicitinertial, motor.mass, motor.inertia = True, LEAST_INERTIA, [rotors[i]] * 3
        motor.add_joint(
            name=name, type=mujoco.mjtJoint.mjJNT_HINGE, limited=mujoco.mjtLimited.mjLIMITED_FALSE
        )
        spring = spec.add_tendon(
            name=name, stiffness=(stiffness[i], 0.0, 0.0), springlength=(0.0, 0.0)
        )
        spring.wrap_joint(name, 1.0)
        spring.wrap_joint(robot.joint_names[i], -1.0)
    return names


def quaternion(rotation: Any) -> Any:
    """Return the (4,) quaternion w, x, y, z of a (3, 3) rotation."""
    quat = np.zeros(4)
    engine().mju_mat2Quat(quat, np.ascontiguousarray(rotation, dtype=float).ravel())
    return quat
