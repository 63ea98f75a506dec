"""Write a data set or a figure: whole or not at all, and never more than a part in memory."""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from hitjoints.errors import InputError

if TYPE_CHECKING:
    from xarray import Dataset

DATASET_ENDINGS = (".zarr", ".nc", ".csv")
PART = 2_000_000  # values of a data set held in memory while it is copied


def check_writable(path: Path, argument: str, endings: tuple[str, ...]) -> None:
    """Refuse an output path before any work is done for it.

    Raises:
        InputError: its ending is not one of `endings`, or its folder cannot be written to.
    """
    if path.suffix not in endings:
        raise InputError(argument, path, f"the name must end in {', '.join(endings)}")
    folder = path.parent
    if not folder.is_dir():
        raise InputError(argument, path, f"there is no folder {folder}")
    if not os.access(folder, os.W_OK) or (path.exists() and not os.access(path, os.W_OK)):
        raise InputError(argument, path, "it cannot be written (permission denied)")
    if path.is_dir() != (path.suffix == ".zarr") and path.exists():
        raise InputError(argument, path, "it is a folder" if path.is_dir() else "it is a file")


def write_whole(path: Path, argument: str, write: Callable[[Path], object]) -> None:
    """Let `write` fill a scratch path beside `path`, then put the result in its place.

    Raises:
        InputError: the file system refuses; nothing is left behind.
    """
    try:
        with tempfile.TemporaryDirectory(dir=path.parent, prefix=f".{path.name}.") as scratch:
            made = Path(scratch) / path.name
            write(made)
            if path.is_dir():
                shutil.rmtree(path)
            os.replace(made, path)
    except OSError as error:
        raise InputError(argument, path, f"it cannot be written ({error.strerror})") from None


def write_dataset(dataset: Dataset, path: Path, argument: str = "out") -> None:
    """Write a data set as Zarr, NetCDF or CSV, by the path's ending.

    Raises:
        InputError: an unknown ending, or a path that cannot be written.
    """
    check_writable(path, argument, DATASET_ENDINGS)
    write = {".zarr": _write_zarr, ".nc": _write_netcdf, ".csv": _write_csv}[path.suffix]
    write_whole(path, argument, lambda made: write(dataset, made))


def _write_zarr(dataset: Dataset, path: Path) -> None:
    dataset.to_zarr(path, zarr_format=3, consolidated=False)


def _write_netcdf(dataset: Dataset, path: Path) -> None:
    import h5netcdf
    import numpy as np

    with h5netcdf.File(path, "w") as file:
        file.dimensions = dict(dataset.sizes)
        for key, said in dataset.attrs.items():
            # NetCDF attributes are flat and have no booleans; a nested one is kept as text.
            value = int(said) if isinstance(said, bool) else said
            parts = value if isinstance(value, list) else [value]
            flat = all(isinstance(part, (str, int, float)) for part in parts)
            file.attrs[key] = value if flat else str(value)
        for name, variable in dataset.variables.items():
            kind = np.dtype("int8") if variable.dtype == bool else variable.dtype
            copy = file.create_variable(str(name), variable.dims, kind)
            copy.attrs.update(variable.attrs)
        for name in dataset.coords:
            file[str(name)][...] = dataset[name].values
        for part, where in _parts(dataset):
            for name, values in part.data_vars.items():
                cut = tuple(where.get(str(d), slice(None)) for d in values.dims)
                file[str(name)][cut] = values.values


def _write_csv(dataset: Dataset, path: Path) -> None:
    """Write one row per cell; a vector's entries become columns q_1, q_2, ..."""
    spread = dataset
    for name in ("q", "direction_vector"):
        if name in dataset.variables:
            last = dataset[name].dims[-1]
            for i in range(dataset.sizes[last]):
                column = dataset[name].isel({last: i}).drop_vars([last], errors="ignore")
                spread = spread.assign({f"{name}_{i + 1}": column})
            spread = spread.drop_vars(name)
    spread = spread.drop_vars(["axis"], errors="ignore")
    for i, (part, _) in enumerate(_parts(spread)):
        table = part.to_dataframe().reset_index()
        table.to_csv(path, index=False, mode="a" if i else "w", header=not i)


def _parts(dataset: Dataset) -> Iterator[tuple[Dataset, dict[str, slice]]]:
    """Yield layers of a data set along x (or its last axis) that fit in memory."""
    axis = "x" if "x" in dataset.sizes else str(list(dataset.sizes)[-1])
    per_layer = sum(v.size for v in dataset.data_vars.values()) / dataset.sizes[axis]
    step = max(1, int(PART / per_layer))
    for start in range(0, dataset.sizes[axis], step):
        where = {axis: slice(start, min(start + step, dataset.sizes[axis]))}
        yield dataset.isel(where), where
