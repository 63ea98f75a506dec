"""What an arm with rotors behind elastic joints does in a hit."""

from __future__ import annotations

from dataclasses import dataclass, field, fields, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin

from hitjoints.dynamics.inertia import factor_mass_matrix, require_mobile
from hitjoints.dynamics.kinematics import WORLD_ALIGNED, point_jacobian
from hitjoints.errors import InputError
from hitjoints.impact.restitution import contact_spring
from hitjoints.impact.rotor import known_rotors, known_stiffness, per_joint
from hitjoints.impact.spring_arm import Parted, SpringArm, second_contact
from hitjoints.told import Told
from hitjoints.vectors import number, unit

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from hitjoints.model.robot import Contact, Robot
    from hitjoints.types import Array


@dataclass(frozen=True, repr=False)
class ElasticImpact(Told):
    """What an elastic arm makes of a hit.

    Attributes:
        object_speed: m/s, of the object when they part.
        robot_speed: m/s, of the contact along the direction at that instant: the links still swing.
        contact_time: s, until they part; None if they go on together, the speeds then being those
            after 64 contact times of the rigid pair.
        impulse: N s, of the contact.
        shown: kg, impulse / (speed - robot_speed), what a balance of momentum sees at that instant;
            None where the contact is as fast as before. Information, no property of the arm: the
            swinging links decide, and by the mean speed afterwards it is "rotor" for any contact.
        equivalent: kg, the inertia for which Eq. 3 gives the object's speed; None where the object
            is faster than any inertia could make it.
    """

    object_speed: float
    robot_speed: float
    contact_time: float | None
    impulse: float
    shown: float | None
    equivalent: float | None
    _parted: Parted = field(repr=False, compare=False)

    @cached_property
    def second_contact(self) -> float | None:
        """When the swinging arm meets the object again, s after the parting.

        None if it does not within 0.1 s.
        """
        return second_contact(self._parted)

    def as_dict(self) -> dict[str, float | None]:
        """Return the values by name."""
        names = [item.name for item in fields(self) if not item.name.startswith("_")]
        return {name: getattr(self, name) for name in (*names, "second_contact")}


def elastic_impact(  # noqa: PLR0913
    robot: Robot,
    q: ArrayLike,
    contact: Contact | int,
    direction: ArrayLike,
    mass: float,
    speed: float,
    restitution: float,
    contact_time: float,
    stiffness: ArrayLike | None = None,
    damping: ArrayLike = 0.0,
    servo: tuple[ArrayLike, ArrayLike] | None = None,
    *,
    qd: ArrayLike | None = None,
    rotor_inertia: ArrayLike | None = None,
    spring: tuple[float, float] | None = None,
) -> ElasticImpact:
    """Return what a hit does when rotors sit behind elastic joints: exact, in closed form.

    The contact is a spring and a damper that do not pull. Its contact time and restitution are
    those of the rigid pair, the arm's links alone against the object.

    Args:
        robot: the arm.
        q: (n,) rad, at the impact.
        contact: joint number or Contact.
        direction: (3,).
        mass: kg, of the object, which is at rest.
        speed: m/s, of the contact along the direction.
        restitution: eps, from 0 to 1.
        contact_time: s, how long the rigid pair touches.
        stiffness: N m/rad of the joints, (n,) or one number; None: the robot's, or 1e4 where it is
            not known.
        damping: N m s/rad of the joints, (n,) or one number.
        servo: gains (N m/rad, N m s/rad), each (n,) or one number, of servos at the rotors, which
            keep the motion before the hit.
        qd: (n,) rad/s, the arm's motion at the impact. The arm is then taken as it stands in the
            middle of the contact, where it has moved on, and what its own motion does to its links
            is added, as long as nothing compensates it. None: as it stands at the impact.
        rotor_inertia: kg m^2, reflected, (n,) or one number; None: the robot's. Where it is zero,
            the joint has no spring either.
        spring: stiffness (N/m) and damping (N s/m) of the contact, in place of those that
            restitution and contact_time give.

    Returns:
        Speeds, contact time, impulse and the inertias that they show.

    Raises:
        InputError: an argument cannot be used.
        InfeasibleError: the contact cannot move along the direction.
        ModelError: the rotor inertia is not known, or the mass matrix is wrong.
    """
    contact, q, h = robot.contact(contact), robot.one_configuration(q), unit(direction)
    if h.ndim != 1:
        raise InputError("direction", f"{len(h)} rows", "one direction")
    for name, value in (("mass", mass), ("speed", speed), ("contact_time", contact_time)):
        number(value, name, "it must be finite and above 0", lambda found: found > 0)
    try:
        proportional, derivative = servo if servo is not None else (0.0, 0.0)
    except (TypeError, ValueError):
        raise InputError("servo", servo, "two gains: N m/rad and N m s/rad") from None
    gains = per_joint(proportional, robot, "servo"), per_joint(derivative, robot, "servo")
    arm = SpringArm(
        *_links(robot, q, contact, h),
        known_rotors(robot, rotor_inertia),
        known_stiffness(robot, stiffness),
        per_joint(damping, robot, "damping"),
        gains,
    )
    between = pair_spring(arm.mobility, mass, restitution, contact_time)
    if spring is not None:
        between = spring
        if not (np.isfinite(between).all() and between[0] > 0 and between[1] >= 0):
            raise InputError("spring", spring, "a stiffness above 0 and a damping not below 0")
    parted = arm.collide(mass, speed, between, contact_time)
    if qd is not None:
        motion = robot.one_configuration(qd, "qd")
        half = (contact_time if parted.time is None else parted.time) / 2
        response, pull = _links(robot, q + half * motion, contact, h)
        own, bend = _own_motion(robot, q, motion, contact, h)
        moved = replace(arm, response=response, pull=pull, own=own, bend=bend)
        parted = moved.collide(mass, speed, between, contact_time)
    object_speed = parted.impulse / mass
    robot_speed = object_speed + parted.closing
    lost, share = speed - robot_speed, object_speed / ((1.0 + restitution) * speed)
    return ElasticImpact(
        object_speed,
        robot_speed,
        parted.time,
        parted.impulse,
        parted.impulse / lost if lost > 0 else None,
        mass * share / (1.0 - share) if share < 1 else None,
        parted,
    )


def _links(robot: Robot, q: Array, contact: Contact, h: Array) -> tuple[Array, Array]:
    """Return M^-1 (n, n) and g = J^T h (n,) at a configuration.

    Raises:
        InfeasibleError: the contact cannot move along h.
    """
    jacobian = point_jacobian(robot.model, robot.data, q, contact)
    factor_mass_matrix(robot.model, robot.data, q)
    inverse, g = np.linalg.inv(robot.data.M), h @ jacobian
    require_mobile(jacobian, float(g @ inverse @ g), contact, h)
    return inverse, g


def _own_motion(
    robot: Robot, q: Array, qd: Array, contact: Contact, h: Array
) -> tuple[Array, float]:
    """Return what an arm does of itself, its gravity compensated and its motors free of torque.

    Returns:
        The joints' accelerations (n,) rad/s^2, and the contact's along h without them (m/s^2).
    """
    model, data = robot.weightless_model, robot.data
    still = np.zeros(robot.n)
    own = pin.rnea(model, model.createData(), q, qd, still)
    factor_mass_matrix(robot.model, data, q)
    accelerations = -pin.cholesky.solve(robot.model, data, own)
    pin.forwardKinematics(robot.model, data, q, qd, still)
    bent = pin.getFrameClassicalAcceleration(
        robot.model, data, contact.joint, contact.placement, WORLD_ALIGNED
    )
    return accelerations, float(h @ bent.linear)


def pair_spring(
    mobility: float, mass: float, restitution: float, contact_time: float
) -> tuple[float, float]:
    """Return the contact's stiffness (N/m) and damping (N s/m) for a rigid pair.

    Args:
        mobility: 1/kg, of the arm's contact.
        mass: kg, of the object.
        restitution: from 0 to 1.
        contact_time: s.

    Raises:
        InputError: a restitution outside [0, 1].
    """
    pair = 1.0 / (mobility + 1.0 / mass)
    per_mass = contact_spring(restitution, contact_time)
    return pair * per_mass[0], pair * per_mass[1]
