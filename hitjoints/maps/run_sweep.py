"""Run a sweep over object positions, into a store that a killed one resumes from, and open it."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from hitjoints.errors import InputError
from hitjoints.maps.integrity import grid_of, missing_blocks, open_arrays, read_attributes
from hitjoints.maps.map_kinds import kind_of
from hitjoints.maps.map_layout import bytes_of
from hitjoints.maps.schedule import run_blocks
from hitjoints.maps.store import MapStore, map_in_memory, map_on_disk

if TYPE_CHECKING:
    from xarray import Dataset

    from hitjoints.maps.cells import Question
    from hitjoints.maps.grid import Grid

IN_MEMORY = 4e9
"""Bytes of a map that has no store."""
Progress = Callable[[int, int], None]


class Work(NamedTuple):
    """What a sweep is computed on, and who asked for it; see `sweep_workspace`."""

    scheduler: str | None
    threads: int | None
    progress: Progress | None
    command: str


def run_sweep(question: Question, grid: Grid, out: str | Path | None, work: Work) -> Dataset:
    """Compute what is missing of a map, and return it.

    Args:
        question: what is asked at every position.
        grid: the positions.
        out: path of the Zarr store; held in memory when None.
        work: how.

    Raises:
        InputError: `out` holds another map, or the map is too large for memory.
    """
    if out is None:
        size = bytes_of(grid, question)
        if size > IN_MEMORY:
            expected = f"a map of {size / 1e9:.3g} GB is not held in memory: name a Zarr store"
            raise InputError("out", out, expected)
        store, source = map_in_memory(question, grid, work.command)
        _fill(store, question, grid, work)
        return _opened(source).load()
    path = Path(out)
    with map_on_disk(path, question, grid, work.command) as store:
        _fill(store, question, grid, work)
    return _opened(path)


def open_map(path: str | Path) -> Dataset:
    """Open a map that a sweep has written; values are read when they are used.

    Args:
        path: of the Zarr store, of `sweep_workspace` or `sweep_motion`.

    Returns:
        As the sweep did.

    Raises:
        InputError: it is not a map of hitjoints, or a part of it is missing or damaged.
    """
    path = Path(path)
    attributes = read_attributes(path, "path")
    arrays, kind = open_arrays(path, "path", attributes), kind_of(attributes)
    missing = missing_blocks(arrays, grid_of(attributes), kind)
    if missing:
        raise InputError(
            "path",
            path,
            f"{len(missing)} blocks of this map are missing or damaged; the command that wrote it "
            f"computes them ({attributes['command'] or f'sweep_{kind.name}'})",
        )
    return _opened(path)


def _fill(store: MapStore, question: Question, grid: Grid, work: Work) -> None:
    missing = store.missing()
    total = int(np.prod(grid.shape))
    done = total - sum(len(grid.positions(index)[0]) for index in missing)
    blocks = run_blocks(question, grid, missing, scheduler=work.scheduler, threads=work.threads)
    for index, values in blocks:
        store.write(index, values)
        done += len(grid.positions(index)[0])
        if work.progress is not None:
            work.progress(done, total)


def _opened(store: Any) -> Dataset:
    import xarray as xr

    dataset: Dataset = xr.open_zarr(store, chunks=None, consolidated=False)
    return dataset.drop_vars("done").set_coords("direction_vector")
