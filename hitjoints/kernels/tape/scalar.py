"""A program compiled for one row at a time: a call takes less than a microsecond."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from hitjoints.kernels.tape.llvm_backend import compile_function
from hitjoints.kernels.tape.llvm_text import scalar_function
from hitjoints.kernels.tape.trace import Tape

Array = np.ndarray[Any, np.dtype[np.float64]]

SIGNATURE = ctypes.PYFUNCTYPE(None, ctypes.c_void_p, ctypes.c_void_p)
"""It keeps the interpreter's lock: giving it up costs as much as the call."""


class Bound(NamedTuple):
    """A program with its numbers: fill `inputs`, call `run`, read `outputs`. For one thread."""

    inputs: Array
    outputs: Array
    run: Callable[[], None]


class ScalarProgram:
    """A compiled program; threads share it, each with numbers of its own.

    Args:
        program: what to run.
        fused: products and sums may become one instruction; else, in a program without sines,
            every bit is as Python's floats have it.
        effort: of compiling, see `compile_function`.
    """

    def __init__(self, program: Tape, fused: bool = True, effort: int = 2) -> None:
        self.program = program
        text = scalar_function(program, fused)
        self._function, self._keep = compile_function(text, SIGNATURE, effort)

    def bind(self) -> Bound:
        """Return the program with arrays that nobody else has."""
        inputs, outputs = np.zeros(self.program.inputs), np.zeros(len(self.program.outputs))
        places = (ctypes.c_void_p(array.ctypes.data) for array in (inputs, outputs))
        return Bound(inputs, outputs, partial(self._function, *places))
