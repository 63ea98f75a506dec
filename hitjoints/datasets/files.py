"""Write a data set or another file: whole or not at all, and over nothing that is not ours."""

from __future__ import annotations

import errno
import os
import shutil
import stat
import tempfile
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from hitjoints.datasets.lock import locked
from hitjoints.datasets.netcdf import write_netcdf
from hitjoints.datasets.ownership import why_not_ours
from hitjoints.datasets.tables import write_csv
from hitjoints.errors import InputError

if TYPE_CHECKING:
    from xarray import Dataset

DATASET_ENDINGS = (".zarr", ".nc", ".csv")
MAP_ENDINGS = (".zarr",)
LOOKS = 4
"""At a scratch folder that is gone after a failure, 0.05 s apart, until it counts as gone."""
TRIES = 20
"""At removing a scratch folder."""


def check_writable(path: Path, argument: str, endings: tuple[str, ...]) -> None:
    """Refuse an output path before any work is done for it.

    Args:
        path: of the output.
        argument: that it was given as.
        endings: that it may have.

    Raises:
        InputError: another ending, a folder that cannot be written to, or a folder in its place
            that hitjoints did not write.
    """
    if path.suffix not in endings:
        raise InputError(argument, path, f"the name must end in {', '.join(endings)}")
    try:
        target = resolved(path)
    except OSError as error:
        raise InputError(argument, path, f"it cannot be written ({_reason(error)})") from None
    there = target.exists()
    if not target.parent.is_dir():
        folder = target.parent if path.is_symlink() else path.parent
        raise InputError(argument, path, f"there is no folder {folder}")
    if not os.access(target.parent, os.W_OK) or (there and not os.access(target, os.W_OK)):
        raise InputError(argument, path, "it cannot be written (permission denied)")
    if there and not (target.is_dir() or target.is_file()):
        raise InputError(argument, path, "it is a device or a pipe; a file is needed")
    if there and target.is_dir() != (path.suffix == ".zarr"):
        raise InputError(argument, path, "it is a folder" if target.is_dir() else "it is a file")
    if target.is_dir() and endings != MAP_ENDINGS:  # a map is continued, not replaced
        _check_replaceable(target, argument, path)


def check_apart(outputs: Iterable[tuple[Path, str]], inputs: Iterable[str | Path]) -> None:
    """Refuse an output that is an input, or another output.

    Args:
        outputs: each with the argument that it was given as.
        inputs: what is read; names that are no files do no harm.

    Raises:
        InputError: writing the one would overwrite the other.
    """
    taken = {resolved(Path(name)): "it is read, too: choose another name" for name in inputs}
    for path, argument in outputs:
        target = resolved(path)
        if target in taken:
            raise InputError(argument, path, taken[target])
        taken[target] = "it is written twice: choose another name"


def write_whole(path: Path, argument: str, write: Callable[[Path], object]) -> None:
    """Let `write` fill a scratch path beside `path`, then put the result in its place.

    Args:
        path: of a file, or of a Zarr folder.
        argument: that it was given as.
        write: called with the scratch path.

    Raises:
        InputError: the file system refuses, or a folder that hitjoints did not write is in the
            place; nothing is left behind.
    """
    try:
        target = resolved(path)
        with scratch_beside(target) as made:
            write(made)
            if made.is_dir():
                _replace_folder(made, target, argument, path)
            else:
                made.replace(target)
    except OSError as error:
        raise InputError(argument, path, f"it cannot be written ({_reason(error)})") from None


def resolved(path: Path) -> Path:
    """Return where a path leads: links are followed, not replaced.

    Raises:
        OSError: nowhere.
    """
    try:
        target = Path(os.path.realpath(path))
        if stat.S_ISLNK(os.lstat(target).st_mode):
            raise OSError(errno.ELOOP, os.strerror(errno.ELOOP))
    except (FileNotFoundError, NotADirectoryError):
        pass
    except ValueError as error:  # a zero byte
        raise OSError(errno.EINVAL, str(error)) from None
    return target


@contextmanager
def scratch_beside(path: Path) -> Iterator[Path]:
    """Yield a path on the same disk, whose folder is gone afterwards with what is left in it."""
    scratch = Path(tempfile.mkdtemp(dir=path.parent, prefix=".hitjoints."))
    looks = LOOKS
    try:
        yield scratch / f"made{path.suffix}"
        looks = 1
    finally:
        # Threads of zarr's may still be writing when one of them was refused, and make the folder
        # anew that was just removed: it has to stay away.
        for _ in range(TRIES):
            shutil.rmtree(scratch, ignore_errors=True)
            looks = LOOKS if scratch.exists() else looks - 1
            if looks <= 0:
                break
            time.sleep(0.05)


def write_dataset(dataset: Dataset, path: Path, argument: str = "out") -> None:
    """Write a data set as Zarr, NetCDF or CSV, by the path's ending.

    Args:
        dataset: what to write.
        path: of the output; a data set of hitjoints in its place is replaced.
        argument: that it was given as.

    Raises:
        InputError: an unknown ending, or a path that cannot be written.
    """
    check_writable(path, argument, DATASET_ENDINGS)
    write = {".zarr": _write_zarr, ".nc": write_netcdf, ".csv": write_csv}[path.suffix]
    write_whole(path, argument, lambda made: write(dataset, made))


def _reason(error: OSError) -> str:
    return error.strerror or str(error)


def _write_zarr(dataset: Dataset, path: Path) -> None:
    dataset.to_zarr(path, zarr_format=3, consolidated=False)


def _replace_folder(made: Path, target: Path, argument: str, path: Path) -> None:
    """Put a folder in the place of a data set of ours, or of nothing."""
    with locked(target.parent, wait=True):
        old = made.with_name("old")
        if target.exists():
            target.rename(old)
            try:
                _check_replaceable(old, argument, path)
            except InputError:
                old.rename(target)
                raise
        made.rename(target)


def _check_replaceable(folder: Path, argument: str, path: Path) -> None:
    reason = why_not_ours(folder)
    if reason:
        raise InputError(argument, path, reason)
