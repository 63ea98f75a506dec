"""A workspace map on disk: a Zarr group that grows block by block and survives a kill.

A block's variables are written first, then its flag in `done`. Whatever moment the process dies
at, a block whose flag is not set is computed again, with the same result; so the finished store
does not tell how often it was interrupted.
"""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from hitjoints.datasets.describe import UNITS, origin
from hitjoints.errors import InputError
from hitjoints.maps.cells import PER_DIRECTION, Question
from hitjoints.maps.grid import Grid

if TYPE_CHECKING:
    from numpy.typing import NDArray

SPACE = ("x", "y", "z")


class MapStore:
    """The store of one map, opened for writing.

    Args:
        path: of the Zarr group; made when it is not there, continued when it holds the same map.
        question, grid: what the map holds.

    Raises:
        InputError: the path holds something else, or a map of other parameters.
    """

    def __init__(self, path: Path, question: Question, grid: Grid, command: str) -> None:
        import zarr

        self.path, self.grid = path, grid
        attributes = _attributes(question, grid, command)
        marker = path / "zarr.json"
        if marker.exists() and (path / "done" / "zarr.json").exists():
            self._refuse_other(marker, attributes)
            _sweep_away_scratch(path)
        else:
            if path.exists() and not _is_unfinished_start(path):
                raise InputError("out", path, "it exists and is not a map of hitjoints")
            shutil.rmtree(path, ignore_errors=True)
            _create(path, question, grid, attributes)
        self._group = zarr.open_group(path, mode="r+")
        self._done: Any = self._group["done"]

    def _refuse_other(self, marker: Path, attributes: dict[str, Any]) -> None:
        found = json.loads(marker.read_text())["attributes"]
        differing = [
            key for key, value in attributes.items()
            if key != "command" and found.get(key) != json.loads(json.dumps(value))
        ]  # fmt: skip
        if differing:
            raise InputError(
                "out", self.path, f"it holds a map with another {', '.join(differing)}; "
                "choose another name or remove it"
            )  # fmt: skip

    def missing(self) -> list[tuple[int, int, int]]:
        """Return the indices of the blocks still to be computed."""
        done = self._done[...]
        return [index for index in self.grid.indices() if not done[index]]

    def write(self, index: tuple[int, int, int], values: dict[str, NDArray[np.float64]]) -> None:
        """Write a block's values, as `evaluate` returns them, then mark it as done."""
        x, y, z = self.grid.slices(index)
        size = (x.stop - x.start, y.stop - y.start, z.stop - z.start)
        for name, array in values.items():
            lead = array.shape[: 1 if name == "reachable" else 2]
            tail = array.shape[len(lead) + 1 :]
            target: Any = self._group[name]
            target[(..., x, y, z, *(slice(None) for _ in tail))] = array.reshape(
                *lead, *size, *tail
            )
        self._done[index] = 1


def _attributes(question: Question, grid: Grid, command: str) -> dict[str, Any]:
    robot = question.robot
    return origin(robot) | {
        "mass": question.mass,
        "samples": question.samples,
        "seed": question.seed,
        "offsets": [list(contact.offset) for contact in question.contacts],
        "joints": [contact.joint for contact in question.contacts],
        "directions": question.directions.tolist(),
        "grid": [axis.tolist() for axis in grid.axes],
        "block": list(grid.block),
        "command": command,
    }


def _create(path: Path, question: Question, grid: Grid, attributes: dict[str, Any]) -> None:
    """Lay out an empty map; `done` comes last, so that a store without it was never begun."""
    import zarr

    group = zarr.create_group(path, zarr_format=3, attributes=attributes)

    def add(name: str, dims: tuple[str, ...], values: Any = None, **options: Any) -> None:
        unit, long_name = UNITS[name]
        described: dict[str, Any] = {"units": unit, "long_name": long_name}
        if values is not None:
            array = group.create_array(
                name, data=np.asarray(values), dimension_names=dims, attributes=described
            )
            assert array is not None
        else:
            group.create_array(name, dimension_names=dims, attributes=described, **options)

    joints, directions = len(question.contacts), len(question.directions)
    n = question.robot.n
    add("joint", ("joint",), [contact.joint for contact in question.contacts])
    add("direction", ("direction",), np.arange(directions))
    add("direction_vector", ("direction", "xyz"), question.directions)
    for name, axis in zip(SPACE, grid.axes, strict=True):
        add(name, (name,), axis)
    add("axis", ("axis",), np.arange(1, n + 1))
    floats: dict[str, Any] = {"dtype": "float64", "fill_value": float("nan")}
    full = ("joint", "direction", *SPACE)
    shape, chunks = (joints, directions, *grid.shape), (joints, directions, *grid.block)
    for name in PER_DIRECTION:
        add(name, full, shape=shape, chunks=chunks, **floats)
    add("q", (*full, "axis"), shape=(*shape, n), chunks=(*chunks, n), **floats)
    lead = (joints, *grid.shape)
    add("reachable", ("joint", *SPACE), shape=lead, chunks=(joints, *grid.block), **floats)
    blocks: dict[str, Any] = {"shape": grid.blocks, "chunks": (1, 1, 1)}
    add("done", ("block_x", "block_y", "block_z"), dtype="uint8", fill_value=0, **blocks)


def _is_unfinished_start(path: Path) -> bool:
    """Tell whether a folder is a map of ours that died before it was laid out, or empty."""
    if not path.is_dir():
        return False
    marker = path / "zarr.json"
    if not marker.exists():
        return not any(path.iterdir())
    try:
        return str(json.loads(marker.read_text())["attributes"]["source"]).startswith("hitjoints")
    except (ValueError, KeyError, TypeError):
        return False


def _sweep_away_scratch(path: Path) -> None:
    """Remove the half-written files that a kill can leave beside zarr's chunks."""
    for scratch in path.rglob("*.partial"):
        scratch.unlink()
