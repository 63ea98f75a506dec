"""A grid of object positions, cut into blocks that are computed and stored whole."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from hitjoints.errors import InputError
from hitjoints.vectors import real, whole

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

Slices = tuple[slice, slice, slice]

MOST_COORDINATES = 100_000
"""Along an axis."""
MOST_POSITIONS = 100_000_000
"""In a grid."""


@dataclass(frozen=True, eq=False)
class Grid:
    """Object positions x by y by z.

    Attributes:
        axes: the coordinates along x, y and z, each (n,) m, ascending.
        block: positions in a block along x, y and z.
    """

    axes: tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]
    block: tuple[int, int, int]

    @property
    def shape(self) -> tuple[int, int, int]:
        """Number of positions along x, y and z."""
        x, y, z = (axis.size for axis in self.axes)
        return x, y, z

    @cached_property
    def blocks(self) -> tuple[int, int, int]:
        """Number of blocks along x, y and z."""
        x, y, z = (-(-n // b) for n, b in zip(self.shape, self.block, strict=True))
        return x, y, z

    def indices(self) -> Iterator[tuple[int, int, int]]:
        """Yield the index of every block."""
        yield from product(*map(range, self.blocks))

    def slices(self, index: tuple[int, int, int]) -> Slices:
        """Return the part of the grid that a block covers."""
        x, y, z = (
            slice(i * b, min((i + 1) * b, n))
            for i, b, n in zip(index, self.block, self.shape, strict=True)
        )
        return x, y, z

    def positions(
        self, index: tuple[int, int, int]
    ) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
        """Return a block's positions (P, 3) and their numbers (P,) in the whole grid."""
        cut = self.slices(index)
        mesh = np.meshgrid(*(a[s] for a, s in zip(self.axes, cut, strict=True)), indexing="ij")
        ranges = [np.arange(s.start, s.stop) for s in cut]
        numbers = np.ravel_multi_index(np.meshgrid(*ranges, indexing="ij"), self.shape)
        return np.stack([m.ravel() for m in mesh], axis=1), numbers.ravel()


def make_grid(x: ArrayLike, y: ArrayLike, z: ArrayLike, per_block: int) -> Grid:
    """Cut a grid into blocks of about `per_block` positions.

    Raises:
        InputError: an axis is empty, not finite, or not ascending; or there are too many positions.
    """
    axes = (_axis("x", x), _axis("y", y), _axis("z", z))
    positions = math.prod(axis.size for axis in axes)
    if positions > MOST_POSITIONS:
        expected = f"at most {MOST_POSITIONS} positions in a map"
        raise InputError("x, y, z", f"{positions} positions", expected)
    block_z = min(axes[2].size, per_block)
    block_y = min(axes[1].size, max(1, per_block // block_z))
    block_x = min(axes[0].size, max(1, per_block // (block_y * block_z)))
    return Grid(axes, (block_x, block_y, block_z))


def _axis(name: str, values: ArrayLike) -> NDArray[np.float64]:
    axis = np.atleast_1d(real(values, name, "ascending finite coordinates"))
    if axis.ndim != 1 or not axis.size or not np.isfinite(axis).all() or (np.diff(axis) <= 0).any():
        raise InputError(name, np.array2string(axis, threshold=6), "ascending finite coordinates")
    whole(axis.size, f"count of {name}", 1, MOST_COORDINATES)
    return axis
