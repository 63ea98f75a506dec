"""What a hit does to the object and to the robot (Eq. 1-4, 10, 11).

All functions broadcast like NumPy. `speed` is that of the contact point along the hitting
direction just before impact; for an object that already moves, give `object_velocity`, its own
speed along that direction: impact depends on the difference alone.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from hitjoints.errors import InputError
from hitjoints.impact.flux import flux as flux_at
from hitjoints.impact.flux import speed_for
from hitjoints.vectors import real

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


def hitting_flux(
    inertia: ArrayLike, mass: ArrayLike, speed: ArrayLike, *, object_velocity: ArrayLike = 0.0
) -> Any:
    """Return the directional hitting flux phi = lambda / (lambda + m_o) v (Eq. 4).

    With the maximum speed this is the maximum flux: Eq. 10 as printed,
    (1 + m_o / lambda) v, contradicts Eq. 4.

    Args:
        inertia: lambda, kg, above 0; infinite is an immovable robot.
        mass: of the object, kg, at least 0.
        speed: m/s.
        object_velocity: m/s.

    Returns:
        m/s, of the broadcast shape; a float for scalars.

    Raises:
        InputError: an argument is out of its range or not a number.
    """
    mobility, checked = 1.0 / _inertia(inertia), _mass(mass)
    return _plain(flux_at(mobility, checked, _relative(speed, object_velocity)))


def object_speed(
    inertia: ArrayLike,
    mass: ArrayLike,
    speed: ArrayLike,
    restitution: ArrayLike,
    *,
    object_velocity: ArrayLike = 0.0,
) -> Any:
    """Return the object's speed after the hit, (1 + eps) phi (Eq. 3).

    Args:
        inertia: as `hitting_flux`.
        mass: as `hitting_flux`.
        speed: as `hitting_flux`.
        object_velocity: as `hitting_flux`.
        restitution: eps, from 0 to 1.

    Returns:
        m/s. Errors as `hitting_flux`.
    """
    flux = hitting_flux(inertia, mass, speed, object_velocity=object_velocity)
    return _plain(np.asarray(object_velocity) + (1.0 + _restitution(restitution)) * flux)


def rebound(
    inertia: ArrayLike,
    mass: ArrayLike,
    speed: ArrayLike,
    restitution: ArrayLike,
    *,
    object_velocity: ArrayLike = 0.0,
) -> Any:
    """Return the change of the robot's speed, -(1 + eps) m_o / (lambda + m_o) v (Eq. 11).

    Args:
        inertia: as `hitting_flux`.
        mass: as `hitting_flux`.
        speed: as `hitting_flux`.
        object_velocity: as `hitting_flux`.
        restitution: eps, from 0 to 1.

    Returns:
        m/s, negative for a hit: the robot is slowed down. Errors as `hitting_flux`.
    """
    checked = _mass(mass)
    share = checked / (_inertia(inertia) + checked)
    lost = (1.0 + _restitution(restitution)) * share * _relative(speed, object_velocity)
    return _plain(0.0 - lost)


def required_speed(
    inertia: ArrayLike, mass: ArrayLike, flux: ArrayLike, *, object_velocity: ArrayLike = 0.0
) -> Any:
    """Return the speed that produces a flux, (lambda + m_o) / lambda phi; inverse of Eq. 4.

    Args:
        inertia: as `hitting_flux`.
        mass: as `hitting_flux`.
        object_velocity: as `hitting_flux`.
        flux: m/s.

    Returns:
        m/s. Errors as `hitting_flux`.
    """
    flux = _numbers("flux", flux)
    relative = speed_for(1.0 / _inertia(inertia), _mass(mass), flux)
    return _plain(_numbers("object_velocity", object_velocity) + relative)


def _numbers(name: str, values: ArrayLike) -> Any:
    array = real(values, name, "a number is needed")
    if not np.isfinite(array).all():
        raise InputError(name, _offender(array, ~np.isfinite(array)), "it must be finite")
    return array


def _inertia(values: ArrayLike) -> Any:
    array = real(values, "inertia", "a number is needed")
    if not (array > 0).all():
        raise InputError("inertia", _offender(array, ~(array > 0)), "it must be above 0 kg")
    return array


def _mass(values: ArrayLike) -> Any:
    array = _numbers("mass", values)
    if (array < 0).any():
        raise InputError("mass", _offender(array, array < 0), "it must not be below 0 kg")
    return array


def _restitution(values: ArrayLike) -> Any:
    array = _numbers("restitution", values)
    bad = (array < 0) | (array > 1)
    if bad.any():
        raise InputError("restitution", _offender(array, bad), "it must lie from 0 to 1")
    return array


def _relative(speed: ArrayLike, object_velocity: ArrayLike) -> Any:
    return _numbers("speed", speed) - _numbers("object_velocity", object_velocity)


def _offender(array: Any, bad: Any) -> float:
    return float(array[bad].flat[0]) if array.ndim else float(array)


def _plain(values: Any) -> Any:
    return float(values) if np.ndim(values) == 0 else values
