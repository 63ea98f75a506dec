"""Where blocks are computed: in this process, or on a Dask cluster."""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from itertools import islice
from typing import TYPE_CHECKING, Any

from hitjoints.errors import InputError, MissingExtraError
from hitjoints.kernels.tape.rows import available_cpus
from hitjoints.maps.cells import Question, evaluate
from hitjoints.maps.grid import Grid

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Index = tuple[int, int, int]
    Result = tuple[Index, dict[str, NDArray[Any]]]

CONNECT_TIMEOUT = 10.0  # s
RETRIES = 3  # of a block whose worker died under it
AHEAD = 2  # blocks in flight per worker: enough to keep it busy, few enough to hold in memory


def run_blocks(
    question: Question,
    grid: Grid,
    indices: list[Index],
    *,
    scheduler: str | None = None,
    threads: int | None = None,
) -> Iterator[Result]:
    """Yield the values of each block as it is computed, in whatever order.

    Args:
        question, grid, indices: what to compute.
        scheduler: address of a Dask scheduler; in this process when None.
        threads: threads of this process; all available processors when None.

    Raises:
        MissingExtraError: a scheduler is named, and dask.distributed is not installed.
        InputError: the scheduler does not answer, or threads is below 1.
    """
    if scheduler is None:
        workers = available_cpus() if threads is None else threads
        if workers < 1:
            raise InputError("threads", threads, "at least 1")
        pool = ThreadPoolExecutor(workers)
        try:
            yield from _run(pool, workers, question, grid, indices)
        finally:
            # Who breaks off, as by Ctrl-C, does not wait for the blocks that are being computed.
            pool.shutdown(wait=False, cancel_futures=True)
    else:
        with _cluster(scheduler) as client:
            # Sent once; a worker that takes the place of a dead one gets it again.
            shared = client.scatter(question, broadcast=True, hash=False)
            workers = max(1, sum(client.nthreads().values()))
            executor = client.get_executor(pure=False, retries=RETRIES)
            yield from _run(executor, workers, shared, grid, indices)


def _run(
    pool: Any, workers: int, question: Any, grid: Grid, indices: list[Index]
) -> Iterator[Result]:
    """Keep the workers busy, but no more results in memory than a few per worker."""
    waiting = iter(indices)
    running: set[Future[Result]] = set()
    while True:
        for index in islice(waiting, AHEAD * workers - len(running)):
            running.add(pool.submit(_task, index, question, *grid.positions(index)))
        if not running:
            return
        finished, running = wait(running, return_when=FIRST_COMPLETED)
        while finished:
            yield finished.pop().result()


def _task(index: Index, question: Question, positions: Any, numbers: Any) -> Result:
    # The blocks themselves are what runs in parallel.
    return index, evaluate(question, positions, numbers, threads=1)


def _cluster(scheduler: str) -> Any:
    try:
        import distributed
    except ImportError:
        raise MissingExtraError("distributed", "dask") from None
    try:
        return distributed.Client(scheduler, timeout=CONNECT_TIMEOUT, set_as_default=False)
    except (OSError, ValueError) as error:
        raise InputError("scheduler", scheduler, f"no Dask scheduler answers ({error})") from None
