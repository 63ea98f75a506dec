"""Where blocks are computed: in this process, or on a Dask cluster."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from contextlib import suppress
from itertools import islice
from threading import Event
from typing import TYPE_CHECKING, Any

from hitjoints.errors import HitjointsError, InputError, MissingExtraError
from hitjoints.kernels.tape.backends import choose
from hitjoints.kernels.tape.rows import available_cpus
from hitjoints.maps.cells import Question, evaluate
from hitjoints.maps.grid import Grid

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Index = tuple[int, int, int]
    Result = tuple[Index, dict[str, NDArray[Any]]]
    Submit = Callable[[Index], Future[Result]]

CONNECT_TIMEOUT = 10.0  # s
LEAVE_TIMEOUT = 2.0  # s
PULSE = 5.0  # s between two looks whether the scheduler is still there
RETRIES = 3  # of a block whose worker died under it
AHEAD = 2  # blocks in flight per worker: enough to keep it busy, few enough to hold in memory
MOST_THREADS = 1024


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
        question: what to compute at every position.
        grid: the positions.
        indices: of the blocks to be computed.
        scheduler: address of a Dask scheduler; in this process when None.
        threads: threads of this process; all available processors when None.

    Raises:
        MissingExtraError: a scheduler is named, and dask.distributed is not installed.
        InputError: the scheduler does not answer or goes away, or threads is out of range.
    """
    if scheduler is None:
        yield from _run_here(question, grid, indices, threads)
    else:
        yield from _run_there(question, grid, indices, scheduler)


def _run_here(
    question: Question, grid: Grid, indices: list[Index], threads: int | None
) -> Iterator[Result]:
    workers = available_cpus() if threads is None else threads
    if not 1 <= workers <= MOST_THREADS:
        raise InputError("threads", threads, f"1 to {MOST_THREADS} threads")
    choose()  # before there are threads: two that import llvmlite at once may both go without it
    stop = Event()
    with ThreadPoolExecutor(workers) as pool:

        def submit(index: Index) -> Future[Result]:
            return pool.submit(_task, index, question, *grid.positions(index), stop.is_set)

        try:
            yield from _run(submit, AHEAD * workers, indices)
        finally:
            # Whoever asks for no more blocks does not wait for those that were begun.
            stop.set()
            pool.shutdown(wait=False, cancel_futures=True)


def _run_there(
    question: Question, grid: Grid, indices: list[Index], scheduler: str
) -> Iterator[Result]:
    client = _cluster(scheduler)

    def check() -> None:
        if client.status != "running":
            raise ConnectionError(f"the connection is {client.status}")

    try:
        # Sent once; a worker that takes the place of a dead one gets it again.
        shared = client.scatter(question, broadcast=True, hash=False)
        workers = max(1, sum(client.nthreads().values()))
        pool = client.get_executor(pure=False, retries=RETRIES)

        def submit(index: Index) -> Future[Result]:
            task: Future[Result] = pool.submit(_task, index, shared, *grid.positions(index))
            return task

        yield from _run(submit, AHEAD * workers, indices, check)
    except (HitjointsError, GeneratorExit):
        raise
    except Exception as error:  # whatever Dask says of lost workers, schedulers and versions
        raise InputError(
            "scheduler",
            scheduler,
            f"the cluster went away or failed ({type(error).__name__}: {error}); "
            "the same command goes on where it stopped, if it has an output",
        ) from None
    finally:
        with suppress(Exception):  # there may be nobody left to take leave of
            client.close(timeout=LEAVE_TIMEOUT)


def _run(
    submit: Submit, ahead: int, indices: list[Index], check: Callable[[], None] = lambda: None
) -> Iterator[Result]:
    """Keep the workers busy, but no more results in memory than a few per worker."""
    waiting = iter(indices)
    running: set[Future[Result]] = set()
    while True:
        for index in islice(waiting, ahead - len(running)):
            running.add(submit(index))
        if not running:
            return
        finished, running = wait(running, PULSE, return_when=FIRST_COMPLETED)
        if not finished:
            check()
        while finished:
            yield finished.pop().result()


def _task(
    index: Index,
    question: Question,
    positions: Any,
    numbers: Any,
    stopped: Callable[[], bool] = lambda: False,
) -> Result:
    # The blocks themselves are what runs in parallel.
    return index, evaluate(question, positions, numbers, threads=1, stopped=stopped)


def _cluster(scheduler: str) -> Any:
    try:
        import distributed
        from distributed.comm.addressing import parse_address, parse_host_port
    except ImportError:
        raise MissingExtraError("distributed", "dask") from None
    try:
        # A client of an address that is none hangs when it is thrown away.
        protocol, place = parse_address(scheduler)
        if protocol in ("tcp", "tls", "ws", "wss"):
            parse_host_port(place)
        return distributed.Client(scheduler, timeout=CONNECT_TIMEOUT, set_as_default=False)
    except (OSError, ValueError) as error:
        raise InputError("scheduler", scheduler, f"no Dask scheduler answers ({error})") from None
