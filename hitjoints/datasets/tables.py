"""Write a data set as a table, CSV."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from hitjoints.datasets.parts import parts

if TYPE_CHECKING:
    from xarray import Dataset


def write_csv(dataset: Dataset, path: Path) -> None:
    """Write one row per cell; a vector's entries become columns q_1, q_2, ...

    Args:
        dataset: what to write; read part by part.
        path: of the new file.

    Raises:
        OSError: the file system refuses.
    """
    spread = dataset
    for name in ("q", "direction_vector"):
        if name in dataset.variables:
            last = dataset[name].dims[-1]
            for i in range(dataset.sizes[last]):
                column = dataset[name].isel({last: i}).drop_vars([last], errors="ignore")
                spread = spread.assign({f"{name}_{i + 1}": column})
            spread = spread.drop_vars(name)
    spread = spread.drop_vars(["axis"], errors="ignore")
    for i, (part, _) in enumerate(parts(spread)):
        table = part.to_dataframe().reset_index()
        table.to_csv(path, index=False, mode="a" if i else "w", header=not i)
