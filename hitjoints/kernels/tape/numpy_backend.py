"""Run a program with NumPy, a block of rows per operation."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from hitjoints.kernels.tape.trace import Tape

BLOCK = 4096
"""Rows per block: long enough to hide the call, short enough for the live values to stay in
cache."""

NANOSECONDS = 0.6
"""About how long an operation takes per row."""

Array = np.ndarray[Any, np.dtype[np.float64]]


def select(a: Array, b: Array, yes: Array | float, no: Array | float, out: Array) -> None:
    """Write `yes` where a < b, else `no`."""
    condition = np.less(a, b)
    np.copyto(out, no)
    np.copyto(out, yes, where=condition)


FUNCTIONS: dict[str, Callable[..., Any]] = {
    "select": select,
    "add": np.add,
    "sub": np.subtract,
    "mul": np.multiply,
    "div": np.divide,
    "neg": np.negative,
    "abs": np.absolute,
    "min": np.minimum,
    "max": np.maximum,
    "sqrt": np.sqrt,
    "sin": np.sin,
    "cos": np.cos,
}


def assign_registers(program: Tape) -> tuple[list[int], int]:
    """A register for every value, reused once the value is dead; and how many there are."""
    last = program.last_use()
    register = list(range(program.inputs))
    free: list[int] = []
    total = program.inputs
    for step, operation in enumerate(program.operations):
        dying = {o for o in operation.operands if isinstance(o, int) and last[o] == step}
        released = [register[o] for o in sorted(dying) if o >= program.inputs]
        if operation.name != "select":
            free += released  # an elementwise ufunc may write over its own operand
        if not free:
            free.append(total)
            total += 1
        register.append(free.pop())
        if operation.name == "select":
            free += released
    return register, total


class NumpyProgram:
    """A program over rows.

    Args:
        program: what to run.
    """

    def __init__(self, program: Tape) -> None:
        self.program, self.lanes = program, 1
        self.nanoseconds = NANOSECONDS * program.count
        self.register, self.registers = assign_registers(program)

    def bind(
        self, inputs: list[Array] | Array, out: Array, iterations: int = 1
    ) -> Callable[[int, int], None]:
        """Return what evaluates rows start..stop.

        Args:
            inputs: per input (N,) values, any strides, or (1,) for one value shared by all rows.
            out: (outputs, N), filled.
            iterations: 1; this back end has no programs with states.
        """
        assert iterations == 1
        return partial(self._run, inputs, out)

    def bind_points(self, x: Array, shared: Array, out: Array) -> Callable[[int, int], None]:
        """Return the same for inputs that are the columns of x (N, m), and shared ones (k,)."""
        return self.bind([*x.T, *shared[:, None]], out)

    def _run(self, inputs: list[Array] | Array, out: Array, start: int, stop: int) -> None:
        width = min(BLOCK, stop - start)
        bank = np.empty((self.registers, width))
        values: list[Array] = [bank[r] for r in self.register]
        steps = self._steps(values)
        for block in range(start, stop, width):
            low = min(block, stop - width)  # the last rows overlap, so that every block is full
            for value, given in zip(values, inputs, strict=False):
                value[:] = given if len(given) == 1 else given[low : low + width]
            for function, operands, result in steps:
                function(*operands, out=result)
            for row, output in zip(out, self.program.outputs, strict=True):
                row[low : low + width] = values[output] if isinstance(output, int) else output

    def _steps(
        self, values: list[Array]
    ) -> list[tuple[Callable[..., Any], tuple[Array | float, ...], Array]]:
        """The operations as functions with their operands and where the result goes."""
        results = values[self.program.inputs :]
        return [
            (
                FUNCTIONS[operation.name],
                tuple(values[o] if isinstance(o, int) else o for o in operation.operands),
                result,
            )
            for operation, result in zip(self.program.operations, results, strict=True)
        ]
