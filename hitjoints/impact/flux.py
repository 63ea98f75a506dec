"""The flux of a hit (Eq. 4), unchecked, for numbers of any kind.

Floats, arrays and the numbers of a recorded program go in alike. The mobility is the inverse of
the directional inertia: it is zero for an immovable robot, and the formulas have no infinities.
"""

from __future__ import annotations

from typing import Any


def flux(mobility: Any, mass: Any, speed: Any) -> Any:
    """Return phi = lambda / (lambda + m_o) v (m/s), with lambda = 1 / mobility.

    Args:
        mobility: 1/kg, of the robot along the direction.
        mass: kg, of the object.
        speed: m/s, of the contact along the direction.
    """
    return speed / (1.0 + mass * mobility)


def speed_for(mobility: Any, mass: Any, flux: Any) -> Any:
    """Return the speed (m/s) that has a flux (m/s), the inverse of `flux`."""
    return (1.0 + mass * mobility) * flux
