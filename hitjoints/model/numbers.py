"""Numbers in the attributes of an XML description: read once, refused by name."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from hitjoints.errors import ModelError, shown

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element

    from numpy.typing import NDArray


def number(
    element: Element | None, key: str, where: str, source: str, default: float | None = 0.0
) -> float:
    """Read one finite number.

    Args:
        element: what holds the attribute, if it is there at all.
        key: name of the attribute.
        where: what to call the element in messages.
        source: what to call the description in messages.
        default: what an attribute that is not there counts as; None refuses it.

    Raises:
        ModelError: it is missing or not a finite number.
    """
    text = None if element is None else element.get(key)
    if text is None and default is not None:
        return default
    if text is None:
        # urdfdom would drop the whole inertia of the link and go on.
        raise ModelError(source, f"{where} has no {key}")
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise ModelError(source, f"{where} {key} = {shown(text, repr)} is not a finite number")
    return value


def vector(
    element: Element | None, key: str, where: str, source: str, default: str = "0 0 0"
) -> NDArray[np.float64]:
    """Read three finite numbers (3,).

    Args:
        element: what holds the attribute, if it is there at all.
        key: name of the attribute.
        where: what to call the element in messages.
        source: what to call the description in messages.
        default: the text of an attribute that is not there.

    Raises:
        ModelError: it is not three finite numbers.
    """
    text = default if element is None else element.get(key, default)
    try:
        value = np.array([float(word) for word in text.split()])
    except ValueError:
        value = np.empty(0)
    if value.shape != (3,) or not np.isfinite(value).all():
        raise ModelError(source, f"{where} {key} = {shown(text, repr)} is not three finite numbers")
    return value


def written(values: NDArray[np.float64]) -> str:
    """Return numbers as any parser reads them back, to the last bit."""
    return " ".join(map(repr, values.tolist()))
