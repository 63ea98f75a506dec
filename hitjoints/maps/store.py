"""A workspace map on disk: a Zarr group that grows block by block and survives a kill.

A block's variables are written first, then its flag in `done`. Whatever moment the process dies
at, a block whose flag is not set is computed again, with the same result; so the finished store
does not tell how often it was interrupted. An empty map is laid out beside its place and moved
there whole, and one run at a time writes to it.
"""

from __future__ import annotations

import errno
import json
import re
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hitjoints.datasets.files import resolved, scratch_beside
from hitjoints.datasets.lock import locked
from hitjoints.errors import InputError
from hitjoints.maps.cells import Question
from hitjoints.maps.grid import Grid
from hitjoints.maps.integrity import missing_blocks, open_arrays, read_attributes
from hitjoints.maps.map_kinds import MapKind, kind_of
from hitjoints.maps.map_layout import attributes_of, lay_out, part_of

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

HALF_WRITTEN = re.compile(r"[0-9c]+\.[0-9a-f]{32}\.partial")
"""What zarr calls a chunk while it writes it; a kill can leave one."""


class MapStore:
    """A map that can be written to.

    Args:
        arrays: its variables.
        grid: its positions.
        path: of its folder.
        kind: of map.
    """

    def __init__(
        self, arrays: dict[str, Any], grid: Grid, path: Path | None, kind: MapKind
    ) -> None:
        self._arrays, self._grid, self._path, self._kind = arrays, grid, path, kind

    def missing(self) -> list[tuple[int, int, int]]:
        """Return the indices of the blocks to be computed: not done, or damaged since."""
        return missing_blocks(self._arrays, self._grid, self._kind)

    def write(self, index: tuple[int, int, int], values: dict[str, NDArray[np.float64]]) -> None:
        """Write a block's values, as `evaluate` returns them, then mark it as done.

        Raises:
            InputError: the file system refuses.
        """
        size = tuple(part.stop - part.start for part in self._grid.slices(index))
        with _refusals(self._path):
            for name, array in values.items():
                lead = 1 if name == "reachable" else 2
                shape = (*array.shape[:lead], *size, *array.shape[lead + 1 :])
                self._arrays[name][part_of(name, self._grid, index)] = array.reshape(shape)
            self._arrays["done"][index] = 1


def map_in_memory(question: Question, grid: Grid, command: str) -> tuple[MapStore, Any]:
    """Lay a map out in memory; return it, and the store of zarr's that it is in."""
    import zarr

    store = zarr.storage.MemoryStore()
    lay_out(store, grid, question.robot.n, attributes_of(question, grid, command))
    group = zarr.open_group(store, mode="r+")
    arrays = {name: group[name] for name in (*question.kind.blockwise, "done")}
    return MapStore(arrays, grid, None, question.kind), store


@contextmanager
def map_on_disk(path: Path, question: Question, grid: Grid, command: str) -> Iterator[MapStore]:
    """Open the store of a map for writing; no other run can meanwhile.

    Args:
        path: of the Zarr group; made when it is not there, continued when it holds the same map.
        question: what is asked at every position.
        grid: the positions.
        command: what to write into the store as its origin.

    Raises:
        InputError: the path holds something else, a map of other parameters, a damaged one, or
            one that another run is writing; or it cannot be written.
    """
    attributes = attributes_of(question, grid, command)
    with _refusals(path):
        target = resolved(path)
        if not target.exists() or (target.is_dir() and not any(target.iterdir())):
            _begin(target, grid, question.robot.n, attributes)
    _refuse_other(path, attributes)
    with ExitStack() as held:
        try:
            held.enter_context(locked(path))
        except BlockingIOError:
            raise InputError("out", path, "another run is writing it") from None
        for scratch in path.glob("*/c/**/*.partial"):
            if HALF_WRITTEN.fullmatch(scratch.name):
                scratch.unlink()
        yield MapStore(open_arrays(path, "out", attributes), grid, path, question.kind)


@contextmanager
def _refusals(path: Path | None) -> Iterator[None]:
    """Say what the file system refuses in a line.

    Raises:
        InputError: it refused.
    """
    try:
        yield
    except OSError as error:
        reason = error.strerror or str(error)
        raise InputError("out", path, f"it cannot be written ({reason})") from None


def _begin(path: Path, grid: Grid, n: int, attributes: dict[str, Any]) -> None:
    """Put an empty map in its place, unless another run is faster."""
    with scratch_beside(path) as made:
        lay_out(made, grid, n, attributes)
        try:
            made.rename(path)
        except OSError as error:
            if error.errno not in (errno.ENOTEMPTY, errno.EEXIST):
                raise


def _refuse_other(path: Path, attributes: dict[str, Any]) -> None:
    found, kind = read_attributes(path, "out"), kind_of(attributes)
    if kind_of(found) is not kind:
        expected = f"it holds a {kind_of(found).name} map; choose another name or remove it"
        raise InputError("out", path, expected)
    differing = [
        key for key, value in json.loads(json.dumps(attributes)).items()
        if key != "command" and found.get(key) != value
    ]  # fmt: skip
    if differing:
        raise InputError(
            "out",
            path,
            f"it holds a map with another {', '.join(differing)}; choose another name or remove it",
        )
