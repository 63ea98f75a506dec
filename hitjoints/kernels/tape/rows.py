"""Spread rows over threads that are kept: every row meets the same instructions in any split."""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor, wait

from hitjoints.errors import InputError

QUICKEST = 0.01
"""ns, a row takes at least."""

WORTH_A_THREAD = 1e6
"""Nanoseconds of work in a piece: waking a thread for less costs more than it saves."""

FOR_A_THREAD = 4
"""Pieces for which a thread is asked to help if nobody says how many shall: on a busy machine it
may begin late, and with few pieces that is waited for."""

ALIGNMENT = 4096
"""Pieces start at multiples of this."""

MOST_THREADS = 256
"""Threads that are kept at most; they are made when they are first needed."""

_kept: list[ThreadPoolExecutor] = []


def _forget() -> None:
    """Begin anew in a forked child, which has none of its parent's threads."""
    _kept.clear()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_forget)


def available_cpus() -> int:
    """Return how many CPUs this process may use."""
    affinity = getattr(os, "sched_getaffinity", None)
    return len(affinity(0)) if affinity else os.cpu_count() or 1


def over_rows(
    work: Callable[[int, int], object], rows: int, threads: int | None, nanoseconds: float
) -> None:
    """Call work(start, stop) for pieces that cover the rows.

    The calling thread works too, and takes whatever the others have not begun: where they get no
    processor, it is as if there were none.

    Args:
        work: releases the interpreter lock while it runs.
        rows: how many.
        threads: None for as many as help.
        nanoseconds: about how long a row takes.

    Raises:
        InputError: threads is not positive.
    """
    if threads is not None and threads < 1:
        raise InputError("threads", threads, "at least 1")
    # A program of constants alone takes no time at all.
    blocks = round(WORTH_A_THREAD / (max(nanoseconds, QUICKEST) * ALIGNMENT))
    piece = max(1, blocks) * ALIGNMENT
    pieces = -(-rows // piece)
    if threads is None:
        helpers = min(pieces // FOR_A_THREAD, available_cpus() - 1)
    else:
        helpers = min(pieces, threads) - 1
    if helpers < 1:
        work(0, rows)
        return
    todo = deque(range(0, rows, piece))

    def drain() -> None:
        while todo:
            try:
                start = todo.popleft()
            except IndexError:  # another thread was faster
                return
            work(start, min(start + piece, rows))

    begun = [_pool().submit(drain) for _ in range(helpers)]
    try:
        drain()
    finally:
        todo.clear()
        for future in begun:
            future.cancel()
        wait(begun)
    for future in begun:
        if not future.cancelled():
            future.result()


def _pool() -> ThreadPoolExecutor:
    if not _kept:
        # Two threads at once may make two; one of them is then idle, and ends with its last use.
        _kept.append(ThreadPoolExecutor(MOST_THREADS, thread_name_prefix="hitjoints"))
    return _kept[0]
