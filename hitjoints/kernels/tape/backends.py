"""Choose what runs a program, and run it over rows."""

from __future__ import annotations

import functools
import os
from collections.abc import Callable
from typing import Any, Protocol

import numpy as np

from hitjoints.errors import UnknownNameError
from hitjoints.kernels.tape.interval_backend import Interval, IntervalProgram
from hitjoints.kernels.tape.numpy_backend import NumpyProgram
from hitjoints.kernels.tape.rows import ALIGNMENT, over_rows
from hitjoints.kernels.tape.trace import Tape, Tracer

Array = np.ndarray[Any, np.dtype[np.float64]]

BACKENDS = ("llvm", "numpy")
VARIABLE = "HITJOINTS_BACKEND"
IN_CACHE = 4 * ALIGNMENT
"""Rows that stay in a cache between two looks at them."""
USUAL_ROUNDS = 8
"""About how many rounds a row of a program with states takes."""


class Runnable(Protocol):
    """A program made ready for one back end.

    Attributes:
        program: what it runs.
        lanes: fewest rows it takes.
        nanoseconds: about how long a row takes.
    """

    program: Tape
    lanes: int
    nanoseconds: float

    def bind(
        self, inputs: list[Array] | Array, out: Array, iterations: int = 1
    ) -> Callable[[int, int], None]:
        """Return what evaluates rows start..stop."""

    def bind_points(self, x: Array, shared: Array, out: Array) -> Callable[[int, int], None]:
        """Return the same for inputs that are the columns of one array, and shared ones."""


def choose(backend: str | None = None) -> str:
    """Name of the back end to use.

    Args:
        backend: "llvm" or "numpy"; None for what HITJOINTS_BACKEND says, else the fastest that
            works here.

    Raises:
        UnknownNameError: no such back end.
        ImportError: "llvm" was asked for and llvmlite is missing.
    """
    argument = "backend" if backend is not None else VARIABLE
    name = backend if backend is not None else os.environ.get(VARIABLE)
    if not name:
        return "llvm" if llvm_works() else "numpy"
    if name not in BACKENDS:
        raise UnknownNameError(argument, name, BACKENDS)
    return name


@functools.cache
def llvm_works() -> bool:
    """Whether LLVM is installed and compiles for this CPU: 1 + 2 is tried once."""
    try:
        from hitjoints.kernels.tape.llvm_backend import LlvmProgram

        tracer = Tracer(1)
        trial = LlvmProgram(tracer.program([tracer.inputs[0] + 1.0]), rows_only=1)
        out = np.zeros((1, trial.lanes))
        trial.bind([np.full(trial.lanes, 2.0)], out)(0, trial.lanes)
    except (ImportError, OSError, RuntimeError):
        return False
    return bool(np.all(out == 3.0))


def prepare(program: Tape, rows_only: int, backend: str | None = None, effort: int = 2) -> Runnable:
    """Make a program ready to run; its first `rows_only` inputs always differ per row.

    Args:
        program: what to run.
        rows_only: how many.
        backend: as `choose`.
        effort: of compiling, 2 for millions of rows or 0 for thousands.
    """
    if choose(backend) == "numpy":
        return NumpyProgram(program)
    from hitjoints.kernels.tape.llvm_backend import LlvmProgram

    return LlvmProgram(program, rows_only, effort=effort)


def over_boxes(program: Tape) -> Callable[[list[Interval], int], Interval]:
    """Make a program ready to run over boxes."""
    if choose() == "numpy":
        return IntervalProgram(program)
    from hitjoints.kernels.tape.interval_machine import MachineProgram

    return MachineProgram(program)


def evaluate(
    run: Runnable,
    outputs: int,
    inputs: list[Array] | Array,
    rows: int,
    threads: int | None,
    iterations: int = 1,
    check: Callable[[int, int], None] | None = None,
) -> Array:
    """Evaluate all rows.

    Args:
        run: the program.
        outputs: how many values it gives per row.
        inputs: per input (rows,) values, or (1,) shared by all rows; or all of them in one array.
        rows: how many.
        threads: None for as many as help.
        iterations: at most this many rounds, of a program with states.
        check: looks at rows start..stop of the input, and may raise; nothing is returned then.

    Returns:
        (outputs, rows).
    """
    missing = run.lanes - rows
    if missing > 0 and rows > 0:
        inputs = [x if len(x) == 1 else np.append(x, np.full(missing, x[-1])) for x in inputs]
    out = np.empty((outputs, max(rows, run.lanes)))
    if rows:
        work = run.bind(inputs, out, iterations)
        if check is not None:
            work = _in_turn(work, check)
        rounds = min(iterations, USUAL_ROUNDS)
        over_rows(work, out.shape[1], threads, rounds * run.nanoseconds)
    return out[:, :rows]


def evaluate_points(run: Runnable, x: Array, shared: Array) -> Array:
    """Evaluate rows that lie in one array, in this thread: what a search calls again and again.

    Args:
        run: the program.
        x: (N, m) the first inputs.
        shared: (k,) the others, the same for all rows.

    Returns:
        (outputs, N).
    """
    rows = len(x)
    if not rows:
        return np.empty((len(run.program.outputs), 0))
    if rows < run.lanes:
        x = np.concatenate((x, np.repeat(x[-1:], run.lanes - rows, axis=0)))
    out = np.empty((len(run.program.outputs), len(x)))
    run.bind_points(np.ascontiguousarray(x), shared, out)(0, len(x))
    return out[:, :rows]


def _in_turn(
    work: Callable[[int, int], None], check: Callable[[int, int], None]
) -> Callable[[int, int], None]:
    """Evaluate and check a few rows at a time: they are read from memory once."""

    def both(start: int, stop: int) -> None:
        for first in range(start, stop, IN_CACHE):
            last = min(first + IN_CACHE, stop)
            work(first, last)
            check(first, last)  # afterwards: work hides the wait for the memory, a check cannot

    return both
