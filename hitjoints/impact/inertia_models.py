"""The inertia that an arm shows at a contact, by one of several models of its drives."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from hitjoints.errors import UnknownNameError
from hitjoints.impact.composite import composite_inertia, composite_inertia_gradient
from hitjoints.impact.rotor import with_rotors
from hitjoints.quantities import checked, directional_inertia, directional_inertia_gradient

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from hitjoints.model.robot import Contact, Robot

InertiaModel = Literal["rigid", "rotor", "composite"]
INERTIA_MODELS: tuple[InertiaModel, ...] = ("rigid", "rotor", "composite")


def impact_inertia(
    robot: Robot,
    q: ArrayLike,
    contact: Contact | int,
    direction: ArrayLike,
    model: InertiaModel = "rigid",
    *,
    rotor_inertia: ArrayLike | None = None,
) -> Any:
    """Return the inertia that the arm shows in a hit, by a model of its drives.

    Args:
        robot: as `directional_inertia`.
        q: as `directional_inertia`.
        contact: as `directional_inertia`.
        direction: as `directional_inertia`.
        model: "rigid": the links alone, lambda_h of the paper; "rotor": with the rotors, coupled
            rigidly; "composite": all joints locked, the arm one free rigid body.
        rotor_inertia: (n,) or one number, kg m^2, reflected through the gears; None: the robot's.

    Returns:
        kg: a float for one configuration, (N,) for rows.

    Raises:
        InputError: as `directional_inertia`, or no such model.
        InfeasibleError: as `directional_inertia`; never by "composite", which no joint holds.
        ModelError: the rotor inertia is not known.
    """
    if model == "rigid":
        return directional_inertia(robot, q, contact, direction)
    if model == "rotor":
        return directional_inertia(with_rotors(robot, rotor_inertia), q, contact, direction)
    if model != "composite":
        raise UnknownNameError("model", model, INERTIA_MODELS)
    contact, q, h = checked(robot, q, contact, direction)
    values = composite_inertia(robot, np.atleast_2d(q), contact, h)
    return values if q.ndim == 2 else float(values[0])


def impact_inertia_gradient(
    robot: Robot,
    q: ArrayLike,
    contact: Contact | int,
    direction: ArrayLike,
    model: InertiaModel = "rigid",
    *,
    rotor_inertia: ArrayLike | None = None,
) -> NDArray[np.float64]:
    """Return the exact gradient of the inertia by the joint positions.

    Rotors are the same in every configuration, so that the derivative of M + B is that of M.

    Args:
        robot: as `directional_inertia`.
        q: as `directional_inertia`.
        contact: as `directional_inertia`.
        direction: as `directional_inertia`.
        model: as `impact_inertia`.
        rotor_inertia: as `impact_inertia`.

    Returns:
        kg/rad: (n,) for one configuration, (N, n) for rows.

    Raises:
        InputError: as `impact_inertia`.
        InfeasibleError: as `impact_inertia`.
        ModelError: as `impact_inertia`.
    """
    if model not in INERTIA_MODELS:
        raise UnknownNameError("model", model, INERTIA_MODELS)
    if model == "composite":
        contact, q, h = checked(robot, q, contact, direction)
        slopes = composite_inertia_gradient(robot, np.atleast_2d(q), contact, h)
        return slopes if q.ndim == 2 else slopes[0]
    arm = robot if model == "rigid" else with_rotors(robot, rotor_inertia)
    return directional_inertia_gradient(arm, q, contact, direction)
