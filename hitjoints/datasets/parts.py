"""A data set part by part, so that copying it takes the memory of a part."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from xarray import Dataset

PART = 2_000_000
"""Values held in memory while a data set is copied."""


def parts(dataset: Dataset) -> Iterator[tuple[Dataset, dict[str, slice]]]:
    """Yield layers of a data set along x (or its last axis) that fit in memory.

    Args:
        dataset: any; one without an axis, or with an empty one, is one part.

    Yields:
        A layer, and what it covers: axis -> slice.
    """
    axis = "x" if "x" in dataset.sizes else str(list(dataset.sizes or [""])[-1])
    values = sum(v.size for v in dataset.data_vars.values())
    if values == 0 or axis not in dataset.sizes:
        yield dataset, {}
        return
    step = max(1, PART * dataset.sizes[axis] // values)
    for start in range(0, dataset.sizes[axis], step):
        where = {axis: slice(start, min(start + step, dataset.sizes[axis]))}
        yield dataset.isel(where), where
