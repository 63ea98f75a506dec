"""Write a NetCDF file through h5netcdf, and survive a disk that fills up meanwhile."""

from __future__ import annotations

from io import FileIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from hitjoints.datasets.parts import parts

if TYPE_CHECKING:
    from typing_extensions import Buffer
    from xarray import Dataset


def write_netcdf(dataset: Dataset, path: Path) -> None:
    """Write a data set as NetCDF 4.

    Args:
        dataset: what to write; read part by part.
        path: of the new file.

    Raises:
        OSError: the file system refuses.
    """
    import h5netcdf

    with PatientFile(path) as patient:
        with h5netcdf.File(patient, "w") as file:
            _fill(file, dataset)
        patient.settle()


class PatientFile(FileIO):
    """A file that never refuses a write, and tells afterwards what the file system refused.

    HDF5 cannot let go of a file whose last pages it cannot write: it tries again when the process
    ends, and takes it down. So the first refusal is kept here until HDF5 is done.
    """

    def __init__(self, path: Path) -> None:
        super().__init__(path, "w+")
        self._refusal: OSError | None = None

    def write(self, data: Buffer, /) -> int:
        """Write all of some bytes, or keep why that failed."""
        view = memoryview(data).cast("B")
        written = 0
        try:
            while written < len(view) and self._refusal is None:
                written += super().write(view[written:]) or 0
        except OSError as error:
            self._refusal = error
        return len(view)

    def truncate(self, size: int | None = None, /) -> int:
        """Set the length, or keep why that failed."""
        try:
            return super().truncate(size)
        except OSError as error:
            self._refusal = self._refusal or error
            return size or 0

    def settle(self) -> None:
        """Raise what was refused, if anything was.

        Raises:
            OSError: the first refusal.
        """
        if self._refusal is not None:
            raise self._refusal


def _fill(file: Any, dataset: Dataset) -> None:
    file.dimensions = dict(dataset.sizes)
    for key, said in dataset.attrs.items():
        file.attrs[key] = _flat(said)
    for name, variable in dataset.variables.items():
        copy = file.create_variable(str(name), variable.dims, _kind(variable.dtype))
        copy.attrs.update(variable.attrs)
    for name in dataset.coords:
        file[str(name)][...] = dataset[name].values
    for part, where in parts(dataset):
        for name, values in part.data_vars.items():
            cut = tuple(where.get(str(d), slice(None)) for d in values.dims)
            file[str(name)][cut] = values.values


def _kind(stored: np.dtype[Any]) -> np.dtype[Any]:
    """Return the type a variable has in the file: no booleans there, and text of any length."""
    import h5py

    if stored.kind == "b":
        return np.dtype("int8")
    text = stored.kind in "OUT"
    return np.dtype(h5py.string_dtype()) if text else stored


def _flat(said: Any) -> Any:
    """Return an attribute as NetCDF knows it: no booleans, and a nested one as text."""
    value = int(said) if isinstance(said, bool) else said
    entries = value if isinstance(value, list) else [value]
    return value if all(isinstance(entry, (str, int, float)) for entry in entries) else str(value)
