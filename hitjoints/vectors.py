"""Checks of the plain vectors that come in from outside."""

from __future__ import annotations

import math
import operator
from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from hitjoints.errors import InputError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

FEW = 1000
LARGEST_SEED = 2**63 - 1
UNIT = 4 * np.finfo(float).eps  # how far from 1 a scaled vector's length may be
TINY, HUGE = 1e-150, 1e150  # lengths whose squares neither under- nor overflow


def unit(direction: ArrayLike, argument: str = "direction") -> NDArray[np.float64]:
    """Return one direction (3,), or one per row (N, 3), scaled to length 1.

    Raises:
        InputError: wrong shape, not finite, or zero.
    """
    array = points(direction, argument)
    if array.ndim == 1:
        # Plain floats: a controller asks for one direction a thousand times a second.
        length = math.hypot(*array.tolist())
        if abs(length - 1.0) <= UNIT:
            return array  # what was scaled once is not scaled again
        if TINY < length < HUGE:
            return array / length
    # Scaling by the largest entry first keeps tiny and huge vectors from under- or overflowing.
    scale = np.abs(array).max(axis=-1, keepdims=True, initial=0.0)
    if not (scale > 0).all():
        raise InputError(argument, _brief(array), "a direction must not be zero")
    scaled = array / scale
    length = np.sqrt((scaled * scaled).sum(axis=-1, keepdims=True))
    return np.asarray(scaled / length)


def points(values: ArrayLike, argument: str) -> NDArray[np.float64]:
    """Return one vector (3,) or rows (N, 3) of finite numbers.

    Raises:
        InputError: wrong shape or not finite.
    """
    array = real(values, argument, "three numbers x,y,z are needed")
    if array.shape[-1:] != (3,) or array.ndim not in (1, 2):
        raise InputError(argument, _brief(array), "three numbers x,y,z (or rows of three)")
    if not all_finite(array):
        raise InputError(argument, _brief(array), "every number must be finite")
    return array


def positive_mass(mass: object) -> float:
    """Return the mass (kg) of an object that can be hit.

    Raises:
        InputError: it is not one finite number above 0.
    """
    return number(mass, "mass", "an object weighs more than 0 kg", lambda value: value > 0)


def number(
    value: object,
    argument: str,
    expected: str,
    allowed: Callable[[float], bool] = math.isfinite,
) -> float:
    """Return one finite number.

    Args:
        value: anything.
        argument: what to call it when it is refused.
        expected: what would be right.
        allowed: tells whether it may be this one.

    Raises:
        InputError: it is no finite number, or not allowed.
    """
    try:
        found = float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError, OverflowError):
        found = math.nan
    if not (math.isfinite(found) and allowed(found)):
        raise InputError(argument, value, expected)
    return found


def whole(value: object, argument: str, least: int, most: int) -> int:
    """Return one whole number from `least` to `most`.

    Args:
        value: any integer, NumPy's too.
        argument: what to call it when it is refused.
        least: it may be.
        most: it may be.

    Raises:
        InputError: it is none, or out of range.
    """
    try:
        number = operator.index(value)  # type: ignore[arg-type]
    except TypeError:
        raise InputError(argument, value, "a whole number") from None
    if not least <= number <= most:
        expected = f"at least {least}" if number < least else f"at most {most}"
        raise InputError(argument, value, expected)
    return number


def real(values: ArrayLike, argument: str, expected: str) -> NDArray[np.float64]:
    """Return real numbers as an array of floats, the same array when it is one.

    Args:
        values: numbers in any shape.
        argument: what to call them when they are refused.
        expected: what would be right.

    Raises:
        InputError: they are no real numbers: text, complex, masked, too large, or ragged.
    """
    if type(values) is np.ndarray and values.dtype == float:
        return values
    # NumPy would drop masks and imaginary parts, and read text as numbers.
    for part in (values, *(values if isinstance(values, (list, tuple)) else ())):
        if isinstance(part, np.ma.MaskedArray) and np.ma.is_masked(part):
            raise InputError(argument, values, f"{expected}, none of them masked")
    try:
        array = np.asarray(values)
        if array.dtype.kind in "biufO":
            return array.astype(float)
    except (TypeError, ValueError, OverflowError):
        pass
    raise InputError(argument, values, expected) from None


def all_finite(array: NDArray[np.float64]) -> bool:
    """Tell whether every entry is finite."""
    # A sum of sane numbers is finite, and several times faster to find. That of squares, for few;
    # for many it would wake the threads of the linear algebra library, which takes milliseconds.
    total = np.vdot(array, array) if array.size < FEW else np.einsum("i->", array.ravel("K"))
    return math.isfinite(total) or bool(np.isfinite(array).all())


def _brief(array: NDArray[np.float64]) -> str:
    return np.array2string(array, precision=4, threshold=6, separator=",").replace("\n", "")


def positive_per_joint(values: ArrayLike | None, n: int, name: str) -> NDArray[np.float64] | None:
    """Return a number above zero for each of n joints, from one for all or one for each.

    Args:
        values: one number, or n; None gives None.
        n: how many joints.
        name: of the argument.

    Raises:
        InputError: not finite, not above zero, or another count.
    """
    if values is None:
        return None
    expected = f"one number above zero, or {n} of them"
    try:
        array = np.asarray(values, dtype=float)
    except (TypeError, ValueError):
        raise InputError(name, values, expected) from None
    if array.size == 1:
        array = np.full(n, array.item())
    if array.shape != (n,) or not (np.isfinite(array) & (array > 0)).all():
        raise InputError(name, np.asarray(values).tolist(), expected)
    return array
