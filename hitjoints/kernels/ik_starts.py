"""Random configurations from counters: row, seed, attempt and joint give the number, nothing else
does.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np

from hitjoints.kernels.formulas.chain import Chain
from hitjoints.kernels.tape.rows import over_rows
from hitjoints.model.turns import FAR, FAR_SLIDE, SLIDE, TURN

GOLDEN = 0x9E3779B97F4A7C15
MASK = (1 << 64) - 1
BLOCK = 8192
NANOSECONDS = 10.0  # about what a number takes

Array = np.ndarray[Any, np.dtype[np.float64]]


def random_starts(
    chain: Chain,
    rows: np.ndarray[Any, np.dtype[np.integer[Any]]],
    seed: int,
    attempt: int,
    threads: int | None,
) -> Array:
    """Uniform configurations (n, N) within the position limits, near zero where they are far."""
    n = chain.size
    low, high = _ranges(chain)
    keys = _keys(seed, attempt, n)
    counters = rows.astype(np.uint64)
    q = np.empty((n, len(rows)))

    def fill(start: int, stop: int) -> None:
        for a in range(start, stop, BLOCK):
            block = counters[a : min(a + BLOCK, stop)] * np.uint64(GOLDEN)
            for joint in range(n):
                unit = _unit(block + np.uint64(keys[joint]))
                unit *= high[joint] - low[joint]
                unit += low[joint]
                link = chain.links[joint]
                np.clip(unit, link.lower, link.upper, out=q[joint, a : a + len(block)])

    over_rows(fill, len(rows), threads, NANOSECONDS * n)
    return q


def start_range(lower: float, upper: float, slides: bool) -> tuple[float, float]:
    """Return where to start within limits (rad or m): all of them, or a turn (2 m) near zero.

    Limits of more than two turns (20 m) stand for none.
    """
    most, width = (FAR_SLIDE, SLIDE) if slides else (FAR, TURN)
    if upper - lower <= most:
        return lower, upper
    low = min(max(-width / 2, lower), upper - width)
    return low, low + width


def one_start(chain: Chain, row: int, seed: int, attempt: int) -> Array:
    """One of them (n,), the same bits: arrays of one number take longer than that number."""
    counter = (row & MASK) * GOLDEN
    low, high = _ranges(chain)
    units = [
        (finalise((counter + key) & MASK) >> 11) * 2.0**-53
        for key in _keys(seed, attempt, chain.size)
    ]
    return np.array(
        [
            min(max(unit * (b - a) + a, link.lower), link.upper)
            for unit, a, b, link in zip(units, low, high, chain.links, strict=True)
        ]
    )


@lru_cache(maxsize=64)
def _ranges(chain: Chain) -> tuple[list[float], list[float]]:
    ends = [start_range(link.lower, link.upper, link.prismatic) for link in chain.links]
    return [pair[0] for pair in ends], [pair[1] for pair in ends]


@lru_cache(maxsize=256)
def _keys(seed: int, attempt: int, n: int) -> list[int]:
    return [mix(mix(mix(seed & MASK) + attempt) + joint) for joint in range(n)]


def mix(z: int) -> int:
    """A step of splitmix64 on one integer."""
    return finalise((z + GOLDEN) & MASK)


def finalise(z: int) -> int:
    """The finaliser of splitmix64 on one integer."""
    z = ((z ^ (z >> 30)) * 0xBF58476D1CE4E5B9) & MASK
    z = ((z ^ (z >> 27)) * 0x94D049BB133111EB) & MASK
    return z ^ (z >> 31)


def _unit(z: np.ndarray[Any, np.dtype[np.uint64]]) -> Array:
    """The same finaliser on an array, which it overwrites, as doubles in [0, 1)."""
    z ^= z >> np.uint64(30)
    z *= np.uint64(0xBF58476D1CE4E5B9)
    z ^= z >> np.uint64(27)
    z *= np.uint64(0x94D049BB133111EB)
    z ^= z >> np.uint64(31)
    z >>= np.uint64(11)
    return np.asarray(z * 2.0**-53, dtype=np.float64)
