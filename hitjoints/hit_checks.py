"""Checks of the numbers of a hit."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from hitjoints.errors import InputError, UnknownNameError
from hitjoints.vectors import number, points

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from hitjoints.types import Array

LEAST_FLUX = 1e-6
"""m/s, the least flux that is a hit: an object so hit moves its own length in a day."""
UNCERTAIN = ("mass", "restitution", "friction", "yaw", "offset", "speed")
"""What a standard deviation can be given for: the object's numbers, where it is touched (m, across
the direction), and the arm's speed (as a share)."""


def check_flux(flux: float) -> None:
    """Refuse a flux (m/s) that no hit has.

    Raises:
        InputError: not finite, or less than `LEAST_FLUX`.
    """
    words = f"a desired flux is finite and at least {LEAST_FLUX:g} m/s"
    number(flux, "flux", words, lambda value: value >= LEAST_FLUX)


def vector_of(values: ArrayLike | None, name: str) -> Array:
    """Return three finite numbers, not to be written to.

    Raises:
        InputError: they are not.
    """
    if values is None:
        raise InputError(name, None, "three numbers x,y,z are needed")
    vector = points(values, name)
    if vector.shape != (3,):
        raise InputError(name, f"shape {vector.shape}", "three numbers x,y,z")
    return frozen(vector)


def frozen(vector: Array) -> Array:
    """Return a copy that is not to be written to."""
    fixed = np.array(vector)
    fixed.setflags(write=False)
    return fixed


def spread_of(spread: Mapping[str, float]) -> dict[str, float]:
    """Return checked standard deviations.

    Raises:
        InputError: one of something else, or no finite number >= 0.
    """
    checked = {}
    for name, value in spread.items():
        if name not in UNCERTAIN:
            raise UnknownNameError("spread", name, UNCERTAIN)
        words = "a standard deviation is finite and >= 0"
        checked[name] = number(value, f"spread {name}", words, lambda value: value >= 0)
    return checked
