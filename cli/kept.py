"""What is left when a command is broken off: said in its last line, and no empty folder."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

_watched: list[Path] = []
_continued: list[Path] = []
_before: dict[Path, float] = {}
"""When files were written that are there already."""


def begin() -> None:
    """Forget what an earlier command in this process wrote."""
    for memory in (_watched, _continued, _before):
        memory.clear()


def watch(path: Path) -> None:
    """Remember a file or folder that is going to be written."""
    _watched.append(path)
    _before.update({file: _written(file) for file in _files(path)})


def continues(path: Path) -> None:
    """Remember a store that the same command continues."""
    _continued.append(path)


def kept() -> str:
    """Return in words what there is of what was asked for, and how to go on."""
    stores = [str(path) for path in _continued if path.exists()]
    if stores:
        return f"{', '.join(stores)} keeps what is done, and the same command goes on from there"
    files = [
        str(file)
        for path in _watched
        for file in _files(path)
        if _written(file) > _before.get(file, 0.0)
    ]
    return f"written: {', '.join(files)}" if files else "nothing was written"


@contextmanager
def output_folder(out: Path) -> Iterator[None]:
    """Make a folder and those above it, and remove them again if nothing comes to be in them.

    Raises:
        InputError: it cannot be made, or not be written to.
    """
    from hitjoints.errors import InputError

    missing = [folder for folder in (out, *out.parents) if not folder.exists()]
    try:
        out.mkdir(parents=True, exist_ok=True)
    except FileExistsError:
        raise InputError("out", out, "it is a file; a folder is needed") from None
    except OSError as error:
        raise InputError("out", out, f"the folder cannot be made ({error.strerror})") from None
    if not os.access(out, os.W_OK | os.X_OK):
        raise InputError("out", out, "the folder cannot be written to (permission denied)")
    watch(out)
    try:
        yield
    except BaseException:
        for folder in missing:
            _remove_if_empty(folder)
        raise


def _remove_if_empty(folder: Path) -> None:
    try:
        folder.rmdir()
    except OSError:
        return  # it is not empty, or gone


def _files(path: Path) -> list[Path]:
    """Return a file, a store, or the files of a folder."""
    if path.suffix == ".zarr" or not path.is_dir():
        return [path]
    return sorted(one for one in path.rglob("*") if one.is_file())


def _written(path: Path) -> float:
    """Return when a file was written, s; 0 where there is none."""
    try:
        return path.stat().st_mtime
    except OSError:
        return 0.0
