"""How a workspace map lies in a Zarr group: attributes, coordinates, blocks."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from hitjoints.datasets.describe import UNITS, origin
from hitjoints.maps.cells import Question
from hitjoints.maps.grid import Grid
from hitjoints.maps.map_kinds import POSTURES, kind_of

if TYPE_CHECKING:
    from pathlib import Path

SPACE = ("x", "y", "z")


def attributes_of(question: Question, grid: Grid, command: str) -> dict[str, Any]:
    """Return what a map's numbers hang on, and the command that asked for it."""
    robot = question.robot
    return (
        origin(robot)
        | question.further
        | {
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
    )


def coordinates_of(attributes: dict[str, Any], n: int) -> dict[str, Any]:
    """Return the coordinates that belong to a map's attributes: name -> (axes, values).

    Args:
        attributes: of the map.
        n: joints of the arm.
    """
    directions = np.asarray(attributes["directions"], dtype=float)
    along = {
        name: ((name,), np.asarray(axis, dtype=float))
        for name, axis in zip(SPACE, attributes["grid"], strict=True)
    }
    return {
        "joint": (("joint",), np.asarray(attributes["joints"])),
        "direction": (("direction",), np.arange(len(directions))),
        "direction_vector": (("direction", "xyz"), directions),
        **along,
        "axis": (("axis",), np.arange(1, n + 1)),
    }


def lay_out(store: Path | Any, grid: Grid, n: int, attributes: dict[str, Any]) -> None:
    """Lay an empty map out in a Zarr store.

    Every chunk of the blocks carries a checksum: a damaged one is noticed when it is read.

    Args:
        store: a folder to be made, or a store of zarr's.
        grid: the positions.
        n: joints of the arm.
        attributes: of the map.
    """
    import zarr
    from zarr.codecs import ZstdCodec

    group = zarr.create_group(store, zarr_format=3, attributes=attributes)

    def add(name: str, axes: tuple[str, ...], **options: Any) -> None:
        unit, long_name = UNITS[name]
        described: dict[str, Any] = {"units": unit, "long_name": long_name}
        made = group.create_array(name, dimension_names=axes, attributes=described, **options)
        assert made is not None

    for name, (axes, values) in coordinates_of(attributes, n).items():
        add(name, axes, data=values)
    joints, directions = len(attributes["joints"]), len(attributes["directions"])
    floats: dict[str, Any] = {
        "dtype": "float64",
        "fill_value": float("nan"),
        "compressors": ZstdCodec(level=0, checksum=True),
    }
    full = ("joint", "direction", *SPACE)
    shape, chunks = (joints, directions, *grid.shape), (joints, directions, *grid.block)
    kind = kind_of(attributes)
    for name in kind.per_direction:
        add(name, full, shape=shape, chunks=chunks, **floats)
    for name in kind.postures:
        add(name, (*full, "axis"), shape=(*shape, n), chunks=(*chunks, n), **floats)
    lead = (joints, *grid.shape)
    add("reachable", ("joint", *SPACE), shape=lead, chunks=(joints, *grid.block), **floats)
    blocks: dict[str, Any] = {"shape": grid.blocks, "chunks": (1, 1, 1)}
    add("done", ("block_x", "block_y", "block_z"), dtype="uint8", fill_value=0, **blocks)


def bytes_of(grid: Grid, question: Question) -> int:
    """Return how much memory the values of a map take."""
    kind = question.kind
    numbers = len(kind.per_direction) + len(kind.postures) * question.robot.n
    per_position = len(question.directions) * numbers + 1
    return 8 * math.prod(grid.shape) * len(question.contacts) * per_position


def part_of(name: str, grid: Grid, index: tuple[int, int, int]) -> tuple[slice, ...]:
    """Return which part of a variable a block holds."""
    every = slice(None)
    leading = (every,) if name == "reachable" else (every, every)
    return (*leading, *grid.slices(index), *((every,) if name in POSTURES else ()))
