"""Numbers in reasons and tables: none that says more than is known."""

from __future__ import annotations

import math
from typing import Any


def at_most(value: float, digits: int = 3) -> str:
    """Return a number rounded towards zero: a maximum as printed can be reached.

    Args:
        value: what to print.
        digits: how many count.
    """
    if value == 0 or not math.isfinite(value):
        return f"{value:g}"
    scale = 10.0 ** (math.floor(math.log10(abs(value))) + 1 - digits)
    down = math.trunc(value / scale * (1 + 1e-15)) * scale
    return f"{down:.{digits}g}"


def told_apart(lesser: float, greater: float) -> tuple[str, str]:
    """Return two numbers with as many digits as it takes to tell them apart, four at least.

    The lesser is rounded down.
    """
    for digits in range(4, 17):
        words = at_most(lesser, digits), f"{greater:.{digits}g}"
        if float(words[0]) < float(words[1]):
            return words
    return repr(lesser), repr(greater)


def vector(values: Any) -> str:
    """Return a vector as text."""
    return ", ".join(f"{value:.4g}" for value in values)
