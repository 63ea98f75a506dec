"""Restitution and contact time as the stiffness and damping of a physics engine's contact.

A contact of MuJoCo is a spring and a damper that hold the two bodies' penetration r to
r'' = -w^2 r - 2 z w r', whatever they weigh, and that never pull: they let go when r'' = 0, before
the spring has come back. With s = sqrt(|1 - z^2|) the bodies then part at the share

    eps = exp(-(z / s) L),   L = pi - atan2(2 z s, 1 - 2 z^2)        (z < 1)
                             L = ln((z + s) / (z - s))               (z > 1)

of the speed they met with, after the time L / (s w). The usual formula with ln(eps) / pi is for
contacts that pull.
"""

from __future__ import annotations

import math
from functools import lru_cache

from hitjoints.vectors import number

LEAST = 1e-4
"""Restitution that stands for 0: for 0 itself the damping would be infinite."""
BISECTIONS = 200


def check_restitution(restitution: float) -> None:
    """Refuse a coefficient of restitution that lies outside [0, 1].

    Raises:
        InputError: it does, or is no number.
    """
    number(restitution, "restitution", "it must lie from 0 to 1", lambda value: 0 <= value <= 1)


def restitution_of(damping_ratio: float) -> float:
    """Return the restitution of a contact that does not pull, from its damping ratio z >= 0."""
    return math.exp(-damping_ratio * _ratio_and_length(damping_ratio)[1])


@lru_cache(maxsize=256)
def damping_ratio(restitution: float) -> float:
    """Return the damping ratio that gives a restitution; the inverse of `restitution_of`.

    Args:
        restitution: from 0 to 1; below `LEAST` it counts as that.

    Raises:
        InputError: outside [0, 1].
    """
    check_restitution(restitution)
    wanted, low, high = max(restitution, LEAST), 0.0, 1.0
    while restitution_of(high) > wanted:
        high *= 2
    for _ in range(BISECTIONS):
        middle = (low + high) / 2
        if middle in (low, high):
            break
        low, high = (middle, high) if restitution_of(middle) > wanted else (low, middle)
    return low if restitution_of(low) == wanted else high


def contact_spring(restitution: float, contact_time: float) -> tuple[float, float]:
    """Return the stiffness w^2 (1/s^2) and damping 2 z w (1/s), per unit of effective mass.

    Args:
        restitution: from 0 to 1.
        contact_time: s, from the first touch to the parting.

    Raises:
        InputError: a restitution outside [0, 1].
    """
    z = damping_ratio(restitution)
    w = _ratio_and_length(z)[1] / contact_time
    return w * w, 2 * z * w


def _ratio_and_length(z: float) -> tuple[float, float]:
    """Return s and L / s, the contact's length in units of 1 / w."""
    s = math.sqrt(abs(1 - z * z))
    if s < 1e-6:  # both branches tend to L / s = 2 for z = 1
        return s, 2.0
    if z < 1:
        return s, (math.pi - math.atan2(2 * z * s, 1 - 2 * z * z)) / s
    return s, math.log((z + s) / (z - s)) / s
