"""The belted ellipsoid: how heavy an arm is at its contact, along any direction."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from hitjoints.tolerances import MOBILITY_FLOOR

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from hitjoints.types import Array

TYPICAL = 0.10
"""m, about the radius at which the median inertia is drawn."""
LONGEST = 0.20
"""m, where the inertia is cut off: at a singularity it is infinite."""


def belted_ellipsoid(inverse: ArrayLike, rows: int = 33, columns: int = 64) -> tuple[Array, Array]:
    """Return directions and the directional inertia along each.

    Args:
        inverse: (3, 3) 1/kg, J M^-1 J^T.
        rows: of the grid over the sphere, pole to pole; the poles are where the inertia is least,
            and round them the surface is smooth.
        columns: of that grid, around.

    Returns:
        (rows, columns, 3) unit vectors; (rows, columns) kg, inf where the contact cannot move.
    """
    Li = np.asarray(inverse, dtype=float)
    axes = np.linalg.eigh(Li)[1]
    polar, around = np.linspace(0, np.pi, rows), np.linspace(0, 2 * np.pi, columns)
    local = np.stack(
        [
            np.outer(np.sin(polar), np.cos(around)),
            np.outer(np.sin(polar), np.sin(around)),
            np.outer(np.cos(polar), np.ones(columns)),
        ],
        axis=-1,
    )
    u = local @ axes.T
    mobility = np.einsum("rci,ij,rcj->rc", u, Li, u)
    movable = mobility > MOBILITY_FLOOR
    return u, np.where(movable, 1.0 / np.where(movable, mobility, 1.0), np.inf)


def inertia_surface(inverse: ArrayLike) -> tuple[Array, str] | None:
    """Return the belted ellipsoid of the directional inertia as a surface round the contact.

    Args:
        inverse: (3, 3) 1/kg, J M^-1 J^T.

    Returns:
        (rows, columns, 3) m from the contact, cut at `LONGEST`; what it is, with its scale. None
        if the contact cannot move at all.
    """
    u, inertia = belted_ellipsoid(inverse)
    finite = inertia[np.isfinite(inertia)]
    if not finite.size:
        return None
    per_length = round_number(0.1 * float(np.median(finite)) / TYPICAL)  # kg per 10 cm
    radius = np.minimum(0.1 * inertia / per_length, LONGEST)
    note = f", cut at {LONGEST * 100:g} cm" if (radius >= LONGEST).any() else ""
    return radius[..., None] * u, f"directional inertia, 10 cm = {per_length:g} kg{note}"


def round_number(value: float) -> float:
    """Return the nearest of 1, 2, 5 times a power of ten."""
    choices = np.array([1.0, 2.0, 5.0, 10.0]) * 10.0 ** np.floor(np.log10(value))
    return float(choices[np.argmin(np.abs(np.log(choices / value)))])
