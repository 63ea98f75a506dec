"""What the engine knows of an arm's drives: what is asked for, or what the hit reckons with."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

from hitjoints.dynamics.inertia import inertia_along
from hitjoints.errors import InputError
from hitjoints.impact.rotor import known_rotors, known_stiffness

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from hitjoints.hit import Hit
    from hitjoints.model.robot import Robot
    from hitjoints.rollouts.record import Rollout


class EngineDrives(NamedTuple):
    """Springs between motors and links, and the motors.

    Attributes:
        stiffness: (n,) N m/rad; empty for an arm without motors.
        rotors: (n,) kg m^2; likewise.
        contact_time: s, of the hit; None for the usual.
    """

    stiffness: tuple[float, ...] = ()
    rotors: tuple[float, ...] = ()
    contact_time: float | None = None


def engine_drives(
    robot: Robot,
    hit: Hit,
    elastic: bool | None,
    stiffness: ArrayLike | None,
    rotor_inertia: ArrayLike | None,
    contact_time: float | None,
) -> EngineDrives:
    """Return the motors of a simulation, see `simulate`.

    Raises:
        InputError: a value cannot be used, or belongs to motors that there are none of.
        ModelError: the rotor inertia is not known.
    """
    drives = hit.setting.drives
    if not (drives.model == "elastic" if elastic is None else elastic):
        if stiffness is not None or rotor_inertia is not None:
            name = "rotor_inertia" if stiffness is None else "stiffness"
            raise InputError(name, "given", "it belongs to elastic joints: ask for them too")
        return EngineDrives(contact_time=contact_time)
    rotors = known_rotors(robot, drives.rotor_inertia if rotor_inertia is None else rotor_inertia)
    springs = known_stiffness(robot, drives.stiffness if stiffness is None else stiffness)
    lasting = drives.contact_time if contact_time is None else contact_time
    return EngineDrives(tuple(springs.tolist()), tuple(rotors.tolist()), lasting)


def with_rotors_of(hit: Hit, motion: Rollout) -> Rollout:
    """Return a motion of the arm whose links carry its rotors, if the hit reckons with them."""
    arm, impact = hit.setting.drives.arm(motion.robot), motion.impact
    if arm is motion.robot or impact is None:
        return motion
    contact = arm.contact(hit.chosen_contact)
    inertia = inertia_along(arm, impact.q, contact, hit.direction)
    flux = hit.flux_of(inertia, impact.speed)
    return replace(motion, robot=arm, impact=replace(impact, inertia=inertia, flux=flux))
