"""Branch and bound over boxes, breadth first: the one loop that every proof runs."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from hitjoints.types import Array

    Boxes = tuple[Array, Array]


def branch(low: Array, high: Array, bound: Callable[[Array, Array], Boxes], most: int) -> int:
    """Bound boxes and the parts that `bound` cuts them into, until none is left.

    Args:
        low: (B, d), the lower ends of the boxes to begin with.
        high: (B, d), the upper ends.
        bound: looks at boxes, and returns the parts of those that are not settled.
        most: boxes to look at; a generation that would exceed them is not begun.

    Returns:
        How many boxes were looked at. Whether any is left, `bound` was the last to know.
    """
    visited = 0
    while len(low) and visited + len(low) <= most:
        visited += len(low)
        low, high = bound(low, high)
    return visited
