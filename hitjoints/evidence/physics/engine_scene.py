"""The arm, the box and the table in the physics engine, at the moment of the impact."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import pinocchio as pin

from hitjoints.dynamics.kinematics import jacobian
from hitjoints.evidence.physics.engine_arm import add_motors, arm_spec, link_name, quaternion
from hitjoints.impact.restitution import contact_spring
from hitjoints.model.engine import compiled, engine

if TYPE_CHECKING:
    from hitjoints.evidence.physics.setting import EngineSetting
    from hitjoints.model.robot import Contact, Robot
    from hitjoints.types import Array

RADIUS = 0.05
"""m, of the sphere that is the link's surface at the contact."""
HARD = 0.9999
"""The engine's impedance of box on table, as hard as it has them."""
SOFT = 1e-4
"""The engine's impedance at the hit. The contact is then a plain spring and damper, to that share:
it yields to whatever moves the two bodies. With 0.9999 it would hold them to the motion of the two
alone, against servos and springs behind the arm."""
SLIP_TIME = 10
"""Steps in which friction at the hit takes hold."""
TABLE_TIME = 0.004
"""s, the time constant of box on table: shorter, and a sliding box hops."""
LEVEL = 1e-6
"""Greatest vertical part of a direction that is level."""


@dataclass(frozen=True, eq=False)
class ImpactState:
    """The state at the impact.

    Attributes:
        contact: the point that hits.
        direction: (3,) unit vector h.
        mass: kg, of the object.
        q: (n,) rad.
        qd: (n,) rad/s.
        point: (3,) m, where the arm touches.
    """

    contact: Contact
    direction: Array
    mass: float
    q: Array
    qd: Array
    point: Array

    def speed(self, robot: Robot) -> float:
        """Return the speed of the contact along the direction, m/s."""
        return float(self.direction @ jacobian(robot, self.q, self.contact) @ self.qd)

    @property
    def axes(self) -> Array:
        """(3, 3): the hitting direction, sideways, up, as columns."""
        h = self.direction
        across = np.cross((0.0, 0.0, 1.0), h)
        if np.linalg.norm(across) < LEVEL:  # straight up or down: any side will do
            across = np.cross((0.0, 1.0, 0.0), h)
        side = across / np.linalg.norm(across)
        return np.column_stack((h, side, np.cross(h, side)))

    def box_centre(self, setting: EngineSetting) -> Array:
        """Return where the box stands, (3,) m: its face touches the arm."""
        h, side, _ = self.axes.T
        return np.asarray(self.point + setting.size[0] / 2 * h + setting.off_centre * side)


def is_level(direction: Array) -> bool:
    """Tell whether a direction (3,) is horizontal: a box on a level table can be hit along it."""
    return bool(abs(direction[2]) < LEVEL)


def build_scene(robot: Robot, impact: ImpactState, setting: EngineSetting) -> tuple[Any, Any]:
    """Return MuJoCo's model and data, the arm about to touch the box at its full speed.

    Only what is named collides: the sphere of the contact with the box, and box with table. The
    sphere touches the box at the contact point and its centre lies behind it along the hitting
    direction, so the force passes through both.

    Raises:
        ModelError: the engine refuses the arm.
    """
    mujoco = engine()
    spec = arm_spec(robot)
    set_options(spec, setting.timestep)
    if not setting.on_table:
        spec.option.gravity = (0, 0, 0)
    _add_contact(spec, robot, impact, setting.timestep)
    centre = impact.box_centre(setting)
    add_box(spec, centre, impact.axes, impact.mass, setting.size)
    face = -setting.size[0] / 2, -setting.off_centre, 0
    spec.body("box").add_site(name="face", pos=face)
    stiffness, damping = contact_spring(setting.restitution, setting.contact_time)
    spring = -stiffness, -damping  # below 0 they are no time constants
    grip = 0.0, -1.0 / (SLIP_TIME * setting.timestep)
    _add_pair(spec, "contact", setting.contact_friction, spring, grip, SOFT)
    if setting.on_table:
        add_table(spec, centre, setting.size, setting.friction)
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


def set_options(spec: Any, timestep: float) -> None:
    """Set the engine up for contacts that are computed to the last digit.

    The integrator is Euler's, but implicit in what servos make of velocities.
    """
    mujoco = engine()
    option = spec.option
    option.timestep = timestep
    option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    option.tolerance, option.iterations = 1e-12, 100
    # A state that is lost is told, not replaced by the one at the beginning.
    option.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_AUTORESET)
    option.enableflags |= int(mujoco.mjtEnableBit.mjENBL_DIAGEXACT)


def add_box(
    spec: Any, centre: Array, axes: Array, mass: float, size: tuple[float, float, float]
) -> None:
    """Add a free box of even density."""
    mujoco = engine()
    box = spec.worldbody.add_body(name="box", pos=centre, quat=quaternion(axes))
    box.add_freejoint()
    half = [edge / 2 for edge in size]
    _silent(box.add_geom(name="box", type=mujoco.mjtGeom.mjGEOM_BOX, size=half, mass=mass))


def add_table(spec: Any, centre: Array, size: tuple[float, float, float], friction: float) -> None:
    """Add a level table under the box."""
    mujoco = engine()
    top = (0, 0, centre[2] - size[2] / 2)
    kind = mujoco.mjtGeom.mjGEOM_PLANE
    _silent(spec.worldbody.add_geom(name="table", type=kind, pos=top, size=(5, 5, 0.1)))
    _add_pair(spec, "table", friction, (TABLE_TIME, 1), (TABLE_TIME, 1), HARD)


def _add_contact(spec: Any, robot: Robot, impact: ImpactState, timestep: float) -> None:
    """Put the sphere and the contact point on the link that hits.

    The sphere is half a step away from the box: first seen half a step deep in it, whereby the
    engine's errors in the length of the contact cancel to first order.
    """
    mujoco = engine()
    contact = impact.contact
    link = spec.body(link_name(contact.joint))
    link.add_site(name="contact", pos=contact.offset)
    pin.forwardKinematics(robot.model, robot.data, impact.q)
    placement = robot.data.oMi[contact.joint]
    gap = impact.speed(robot) * timestep / 2
    centre = placement.actInv(impact.point - (RADIUS + gap) * impact.direction)
    kind = mujoco.mjtGeom.mjGEOM_SPHERE
    _silent(link.add_geom(name="contact", type=kind, pos=centre, size=(RADIUS, 0, 0)))


def _add_pair(
    spec: Any,
    other: str,
    friction: float,
    spring: tuple[float, float],
    grip: tuple[float, float],
    impedance: float,
) -> None:
    """Let the box touch another shape, with friction or without."""
    spec.add_pair(
        geomname1=other,
        geomname2="box",
        condim=3 if friction > 0 else 1,
        friction=(friction, friction, 0, 0, 0),
        solref=spring,
        solreffriction=grip,
        solimp=solimp(impedance),
    )


def solimp(impedance: float) -> tuple[float, ...]:
    """Return the engine's five numbers for an impedance that is the same at any depth."""
    return impedance, impedance, 0.001, 0.5, 2.0


def _add_servos(spec: Any, robot: Robot, driven: list[str], gain: float) -> None:
    """Add a velocity servo to what drives every joint, as strong as the joint's effort limit."""
    mujoco = engine()
    for name, effort in zip(driven, robot.effort, strict=True):
        servo = spec.add_actuator(name=name, target=name, trntype=mujoco.mjtTrn.mjTRN_JOINT)
        servo.set_to_velocity(gain)
        if 0 < effort < np.inf:
            servo.forcelimited, servo.forcerange = True, (-effort, effort)


def _silent(geom: Any) -> None:
    """Let a shape collide with nothing but what pairs name, and weigh nothing unless it has to."""
    geom.contype = geom.conaffinity = 0
    if geom.name != "box":
        geom.mass = 0
