"""Whether a stored map is whole: what is damaged is refused by name, or computed again."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from hitjoints.datasets.ownership import root_attributes
from hitjoints.errors import InputError
from hitjoints.maps.grid import Grid
from hitjoints.maps.map_kinds import MapKind, kind_of
from hitjoints.maps.map_layout import coordinates_of, part_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Arrays = dict[str, Any]


def read_attributes(path: Path, argument: str) -> dict[str, Any]:
    """Return the attributes of a map.

    Args:
        path: of its folder.
        argument: that it was given as.

    Raises:
        InputError: it is no map of hitjoints.
    """
    attributes = root_attributes(path)
    if attributes is None or not {"grid", "block", "joints", "directions"} <= attributes.keys():
        raise InputError(argument, path, "it exists and is not a map of hitjoints")
    return attributes


def open_arrays(path: Path, argument: str, attributes: dict[str, Any]) -> Arrays:
    """Open the variables of a map for reading and writing, its coordinates compared.

    Args:
        path: of its folder.
        argument: that it was given as.
        attributes: of the map.

    Returns:
        name -> array, of the blocks' variables and `done`.

    Raises:
        InputError: a variable is missing or damaged; the text names it.
    """
    import zarr

    name = "zarr.json"
    try:
        group = zarr.open_group(path, mode="r+")
        arrays: Arrays = {}
        for name in (*kind_of(attributes).blockwise, "done"):
            arrays[name] = group[name]
        for name, (_, values) in coordinates_of(attributes, arrays["q"].shape[-1]).items():
            stored: Any = group[name]
            if not np.array_equal(stored[...], values):
                raise ValueError(name)
    except Exception:  # whatever zarr and its codecs say of what they cannot read
        raise InputError(
            argument, path, f"{name} of this map is missing or damaged: remove the map"
        ) from None
    return arrays


def missing_blocks(arrays: Arrays, grid: Grid, kind: MapKind) -> list[tuple[int, int, int]]:
    """Return the blocks that are not there: never computed, or damaged since."""
    return [
        index
        for index in grid.indices()
        if not (_is_marked(arrays, index) and _is_whole(arrays, grid, index, kind))
    ]


def grid_of(attributes: dict[str, Any]) -> Grid:
    """Return the grid of a map from its attributes."""
    x, y, z = (np.asarray(axis, dtype=float) for axis in attributes["grid"])
    block_x, block_y, block_z = attributes["block"]
    return Grid((x, y, z), (block_x, block_y, block_z))


def _is_marked(arrays: Arrays, index: tuple[int, int, int]) -> bool:
    try:
        return bool(arrays["done"][index])
    except Exception:  # as above
        return False


def _is_whole(arrays: Arrays, grid: Grid, index: tuple[int, int, int], kind: MapKind) -> bool:
    """Tell whether a block can be read, and holds numbers wherever a position can be reached.

    A chunk that is not there reads as nan; so does one that was never written because all of its
    positions are out of reach, and nothing is lost with that.
    """
    try:
        block = {name: arrays[name][part_of(name, grid, index)] for name in kind.blockwise}
    except Exception:  # as above
        return False
    return _is_consistent(block, kind)


def _is_consistent(block: dict[str, NDArray[np.float64]], kind: MapKind) -> bool:
    if np.isnan(block["reachable"]).any():
        return False
    for name, absent in kind.absent(block).items():
        found = np.isnan(block[name])
        expected = absent[..., None] if name in kind.postures else absent
        if (found != expected).any():
            return False
    return True
