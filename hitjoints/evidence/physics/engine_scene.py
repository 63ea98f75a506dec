"""The arm, the box and the table in the physics engine, at the moment of the impact."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pinocchio as pin

from hitjoints.dynamics.inertia import inverse_inertia
from hitjoints.evidence.physics.engine_arm import add_motors, arm_spec, link_name
from hitjoints.evidence.physics.engine_box import add_box, add_pair, add_table, set_options, silent
from hitjoints.impact.restitution import contact_spring
from hitjoints.model.engine import compiled, engine

if TYPE_CHECKING:
    from hitjoints.evidence.physics.first_touch import ImpactState
    from hitjoints.evidence.physics.setting import EngineSetting
    from hitjoints.model.robot import Robot
    from hitjoints.types import Array

RADIUS = 0.05
"""m, of the sphere that is the link's surface at the contact."""
FIRMER = 50
"""Settling times of the table in a contact's time: a table on which an edge does not sink in."""


def build_scene(
    robot: Robot,
    impact: ImpactState,
    setting: EngineSetting,
    steps: tuple[float, float] | None = None,
) -> tuple[Any, Any]:
    """Return MuJoCo's model and data, the arm about to touch the box at its full speed.

    Only what is named collides: the sphere of the contact with the box, and the box's feet with
    the table. The sphere touches the box at the contact point and its centre lies behind it along
    the face's normal, so the force passes through both.

    Args:
        robot: the arm.
        impact: the moment.
        setting: how the hit is made.
        steps: s, the engine's step and the time in which the table takes the weight; None: those
            for the contact.

    Raises:
        ModelError: the engine refuses the arm.
    """
    mujoco = engine()
    spec = arm_spec(robot)
    timestep, settling = steps or (setting.timestep, setting.contact_time / FIRMER)
    set_options(spec, timestep)
    if not setting.stands:
        spec.option.gravity = (0, 0, 0)
    axes, centre = impact.box_axes(setting), impact.box_centre(setting)
    _add_contact(spec, robot, impact, axes[:, 0], timestep)
    add_box(spec, centre, axes, impact.mass, setting.size)
    spec.body("box").add_site(name="face", pos=impact.face_point(setting))
    leaning = _leaning(robot, impact, setting)
    spring = contact_spring(setting.restitution, setting.contact_time)
    spring = -leaning * spring[0], -leaning * spring[1]
    add_pair(spec, "contact", "box", setting.contact_friction, spring)
    if setting.stands:
        add_table(spec, centre, setting.size, setting.friction, setting.support, settling)
    driven = list(robot.joint_names)
    if setting.stiffness:
        motors = add_motors(spec, robot, np.array(setting.rotors), np.array(setting.stiffness))
        driven = [motor or link for motor, link in zip(motors, driven, strict=True)]
    if setting.servo_gain > 0:
        _add_servos(spec, robot, driven, setting.servo_gain)
    model = compiled(spec, robot.name)
    data = mujoco.MjData(model)
    for names in (robot.joint_names, driven):
        for name, q, qd in zip(names, impact.q, impact.qd, strict=True):
            data.joint(name).qpos, data.joint(name).qvel = q, qd
    return model, data


def _leaning(robot: Robot, impact: ImpactState, setting: EngineSetting) -> float:
    """Return how much more easily the two surfaces part without the table than with it.

    The engine's springs are those of two bodies that nothing holds; a box that is hit high or low
    leans on its table, and is felt as heavier.
    """
    boxes, normal = impact.boxes(setting), impact.box_axes(setting)[:, 0]
    arm = normal @ inverse_inertia(robot, impact.q, impact.contact) @ normal
    pitch = setting.height**2 / boxes.pitch_inertia
    free = 1 / boxes.mass + boxes.lever**2 / boxes.spin_inertia + pitch
    return float(((arm + free) / (arm + 1 / boxes.effective_mass()))[0])


def _add_contact(
    spec: Any, robot: Robot, impact: ImpactState, normal: Array, timestep: float
) -> None:
    """Put the sphere and the contact point on the link that hits.

    The sphere is half a step away from the box: first seen half a step deep in it, whereby the
    engine's errors in the length of the contact cancel to first order.
    """
    mujoco = engine()
    contact = impact.contact
    link = spec.body(link_name(contact.joint))
    link.add_site(name="contact", pos=contact.offset)
    gap = float(normal @ impact.velocity(robot)) * timestep / 2
    pin.forwardKinematics(robot.model, robot.data, impact.q)
    placement = robot.data.oMi[contact.joint]
    centre = placement.actInv(impact.point - (RADIUS + gap) * normal)
    kind = mujoco.mjtGeom.mjGEOM_SPHERE
    silent(link.add_geom(name="contact", type=kind, pos=centre, size=(RADIUS, 0, 0)))


def _add_servos(spec: Any, robot: Robot, driven: list[str], gain: float) -> None:
    """Add a velocity servo to what drives every joint, as strong as the joint's effort limit."""
    mujoco = engine()
    for name, effort in zip(driven, robot.effort, strict=True):
        servo = spec.add_actuator(name=name, target=name, trntype=mujoco.mjtTrn.mjTRN_JOINT)
        servo.set_to_velocity(gain)
        if 0 < effort < np.inf:
            servo.forcelimited, servo.forcerange = True, (-effort, effort)
