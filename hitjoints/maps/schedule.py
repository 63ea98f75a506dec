"""Where blocks are computed: in this process, or on a Dask cluster."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from hitjoints.errors import InputError, MissingExtraError
from hitjoints.maps.cells import Question, evaluate
from hitjoints.maps.grid import Grid

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Index = tuple[int, int, int]
    Result = tuple[Index, dict[str, NDArray[Any]]]

CONNECT_TIMEOUT = 10.0  # s
RETRIES = 3  # of a block whose worker died under it
AHEAD = 4  # blocks queued per worker thread: enough to keep it busy, few enough to hold in memory


def run_blocks(
    question: Question,
    grid: Grid,
    indices: list[Index],
    *,
    scheduler: str | None = None,
    threads: int | None = None,
) -> Iterator[Result]:
    """Yield the values of each block as it is computed.

    Args:
        question, grid, indices: what to compute.
        scheduler: address of a Dask scheduler; in this process when None.
        threads: threads of this process; all available processors when None.

    Raises:
        MissingExtraError: a scheduler is named, and dask.distributed is not installed.
        InputError: the scheduler does not answer.
    """
    if scheduler is None:
        for index in indices:
            yield index, evaluate(question, *grid.positions(index), threads)
    else:
        yield from _on_cluster(question, grid, indices, scheduler)


def _on_cluster(
    question: Question, grid: Grid, indices: list[Index], scheduler: str
) -> Iterator[Result]:
    try:
        import distributed
    except ImportError:
        raise MissingExtraError("distributed", "dask") from None
    try:
        client = distributed.Client(scheduler, timeout=CONNECT_TIMEOUT, set_as_default=False)
    except (OSError, ValueError) as error:
        raise InputError("scheduler", scheduler, f"no Dask scheduler answers ({error})") from None
    with client, client.as_current():
        # Sent once; a worker that dies is replaced and gets it again.
        shared = client.scatter(question, broadcast=True, hash=False)
        waiting = iter(indices)

        def submit(index: Index) -> Any:
            # Dask runs one task per worker thread, so a task keeps to one thread itself.
            positions, numbers = grid.positions(index)
            return client.submit(
                _task, index, shared, positions, numbers, pure=False, retries=RETRIES
            )

        room = AHEAD * max(1, sum(client.nthreads().values()))
        running = distributed.as_completed()
        for _, index in zip(range(room), waiting, strict=False):
            running.add(submit(index))
        for future in running:
            yield future.result()
            for index in waiting:
                running.add(submit(index))
                break


def _task(index: Index, question: Question, positions: Any, numbers: Any) -> Result:
    return index, evaluate(question, positions, numbers, threads=1)
