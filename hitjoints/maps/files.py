"""Write a data set or a figure: whole or not at all."""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from hitjoints.errors import InputError

if TYPE_CHECKING:
    from xarray import Dataset

DATASET_ENDINGS = (".zarr", ".nc", ".csv")


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
    if path.is_dir() and path.suffix != ".zarr":
        raise InputError(argument, path, "it is a folder")


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
    writers: dict[str, Callable[[Path], object]] = {
        ".zarr": lambda p: dataset.to_zarr(p, zarr_format=3, consolidated=False),
        ".nc": lambda p: dataset.to_netcdf(p, engine="h5netcdf"),
        ".csv": lambda p: dataset.to_dataframe().reset_index().to_csv(p, index=False),
    }
    write_whole(path, argument, writers[path.suffix])
