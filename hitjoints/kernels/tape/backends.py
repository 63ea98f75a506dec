"""Choose what runs a program, and run it over rows."""

from __future__ import annotations

import functools
import os
from collections.abc import Callable
from typing import Any, Protocol

import numpy as np

from hitjoints.errors import UnknownNameError
from hitjoints.kernels.tape.numpy_backend import NumpyProgram
from hitjoints.kernels.tape.rows import over_rows
from hitjoints.kernels.tape.trace import Tape, Tracer

Array = np.ndarray[Any, np.dtype[np.float64]]

BACKENDS = ("llvm", "numpy")
VARIABLE = "HITJOINTS_BACKEND"


class Runnable(Protocol):
    """A program made ready for one back end."""

    program: Tape
    lanes: int

    def __call__(self, inputs: list[Array], out: Array, start: int, stop: int) -> None:
        """Evaluate rows start..stop."""


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
        trial([np.full(trial.lanes, 2.0)], out, 0, trial.lanes)
    except (ImportError, OSError, RuntimeError):
        return False
    return bool(np.all(out == 3.0))


def prepare(program: Tape, rows_only: int, backend: str | None) -> Runnable:
    """Make a program ready to run; its first `rows_only` inputs always differ per row."""
    if choose(backend) == "numpy":
        return NumpyProgram(program)
    from hitjoints.kernels.tape.llvm_backend import LlvmProgram

    return LlvmProgram(program, rows_only)


def evaluate(
    run: Callable[..., None],
    lanes: int,
    outputs: int,
    inputs: list[Array],
    rows: int,
    threads: int | None,
) -> Array:
    """Evaluate all rows.

    Args:
        run: a `Runnable`, or one with its further arguments bound.
        lanes: fewest rows it takes.
        outputs: how many values it gives per row.
        inputs: per input (rows,) values, or (1,) shared by all rows.
        rows: how many.
        threads: None for as many as help.

    Returns:
        (outputs, rows).
    """
    missing = lanes - rows
    if missing > 0 and rows > 0:
        inputs = [x if len(x) == 1 else np.append(x, np.full(missing, x[-1])) for x in inputs]
    out = np.empty((outputs, max(rows, lanes)))
    if rows:
        over_rows(lambda start, stop: run(inputs, out, start, stop), out.shape[1], threads)
    return out[:, :rows]
