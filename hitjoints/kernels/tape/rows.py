"""Split rows over threads: disjoint ranges, so the result does not depend on how many there are."""

from __future__ import annotations

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

from hitjoints.errors import InputError

WORTH_A_THREAD = 8192
"""Fewer rows than this cost less than starting a thread."""

ALIGNMENT = 64
"""Ranges start at multiples of this, so that a row meets the same instructions in any split."""


def available_cpus() -> int:
    """CPUs this process may use."""
    affinity = getattr(os, "sched_getaffinity", None)
    return len(affinity(0)) if affinity else os.cpu_count() or 1


def over_rows(work: Callable[[int, int], object], rows: int, threads: int | None) -> None:
    """Call work(start, stop) for ranges that cover the rows.

    Args:
        work: releases the interpreter lock while it runs.
        rows: how many.
        threads: None for as many as help.

    Raises:
        InputError: threads is not positive.
    """
    if threads is None:
        threads = max(1, min(available_cpus(), rows // WORTH_A_THREAD))
    elif threads < 1:
        raise InputError("threads", threads, "at least 1")
    share = -(-rows // (threads * ALIGNMENT)) * ALIGNMENT
    if threads == 1 or share >= rows:
        work(0, rows)
        return
    with ThreadPoolExecutor(threads) as pool:
        starts = range(0, rows, share)
        list(pool.map(lambda start: work(start, min(start + share, rows)), starts))
