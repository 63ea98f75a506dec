"""The rotors of an arm's motors: what is known of them, and the arm that carries them rigidly."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin

from hitjoints.errors import InputError, ModelError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from hitjoints.model.robot import Robot
    from hitjoints.types import Array

ASSUMED_STIFFNESS = 1e4
"""N m/rad, of a joint whose stiffness is not known: the order of harmonic drives of this size."""


def per_joint(values: ArrayLike, robot: Robot, argument: str, *, positive: bool = False) -> Array:
    """Return one number, or one per joint, as (n,) numbers.

    Raises:
        InputError: another count, not finite, below zero, or zero where it must be positive.
    """
    try:
        array = np.broadcast_to(np.asarray(values, dtype=float), (robot.n,))
    except (TypeError, ValueError):
        raise InputError(argument, values, f"one number, or {robot.n}") from None
    least = "above 0" if positive else "not below 0"
    if not np.isfinite(array).all() or (array < 0).any() or (positive and not array.all()):
        raise InputError(argument, values, f"every number must be finite and {least}")
    return np.array(array)


def known_rotors(robot: Robot, given: ArrayLike | None = None) -> Array:
    """Return the reflected rotor inertias (n,) kg m^2: given, or the robot's.

    Raises:
        InputError: they cannot be used.
        ModelError: none are given, and the robot's are not known.
    """
    if given is not None:
        return per_joint(given, robot, "rotor_inertia")
    if robot.rotor_inertia is None:
        raise ModelError(
            robot.name,
            "its rotor inertia is not known: add rotor_inertia (kg m^2, reflected through the "
            "gears, one per joint) to its TOML, or give rotor_inertia (--rotor-inertia)",
        )
    return robot.rotor_inertia


def known_stiffness(robot: Robot, given: ArrayLike | None = None) -> Array:
    """Return the joints' stiffness (n,) N m/rad: given, the robot's, or `ASSUMED_STIFFNESS`.

    Raises:
        InputError: it cannot be used.
    """
    if given is not None:
        return per_joint(given, robot, "stiffness", positive=True)
    if robot.joint_stiffness is not None:
        return robot.joint_stiffness
    return np.full(robot.n, ASSUMED_STIFFNESS)


def with_rotors(robot: Robot, rotor_inertia: ArrayLike | None = None) -> Robot:
    """Return the arm whose mass matrix is M + B: its rotors turn with the links, rigidly.

    Every quantity of it, gradients and batch kernels included, is then that of the model "rotor".

    Args:
        robot: the arm.
        rotor_inertia: (n,) or one number, kg m^2, reflected; None: the robot's.

    Raises:
        InputError: rotor_inertia cannot be used.
        ModelError: it is not known.
    """
    return _carrying(robot, tuple(known_rotors(robot, rotor_inertia).tolist()))


@lru_cache(maxsize=16)
def _carrying(robot: Robot, rotors: tuple[float, ...]) -> Robot:
    model = pin.Model(robot.model)
    model.armature = model.armature + np.array(rotors)
    return replace(robot, model=model, rotor_inertia=np.zeros(robot.n))
