"""Compile a program for this CPU with LLVM and run it on rows."""

from __future__ import annotations

import ctypes
import functools
from collections.abc import Callable
from typing import Any

import llvmlite.binding as llvm
import numpy as np

from hitjoints.kernels.tape.llvm_text import run_function
from hitjoints.kernels.tape.trace import Tape

Array = np.ndarray[Any, np.dtype[np.float64]]

SIGNATURE = ctypes.CFUNCTYPE(None, *[ctypes.c_void_p] * 3, *[ctypes.c_int64] * 4)


NANOSECONDS = 0.24
"""About how long a vector operation takes."""


@functools.cache
def host() -> tuple[Any, str, str]:
    """Target, CPU name and features of this machine."""
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    features = llvm.get_host_cpu_features()
    return llvm.Target.from_default_triple(), llvm.get_host_cpu_name(), features.flatten()


def host_lanes() -> int:
    """Doubles per vector register."""
    features = host()[2].split(",")
    return 8 if "+avx512f" in features else 4 if "+avx2" in features else 2


def compile_function(text: str, signature: Any, effort: int = 2) -> tuple[Any, Any]:
    """Compile IR with a function `run`; returns it and the engine that must outlive it.

    Args:
        text: the IR.
        signature: of the function.
        effort: 2 makes the fastest code; 0 takes a third of the time, for code half as fast.
    """
    target, cpu, features = host()
    machine = target.create_target_machine(cpu=cpu, features=features, opt=effort)
    module = llvm.parse_assembly(text)
    engine = llvm.create_mcjit_compiler(module, machine)
    engine.finalize_object()
    function, keep = signature(engine.get_function_address("run")), (engine, module, machine)
    function.keep = keep  # who holds the function alone has its code, too
    return function, keep


class LlvmProgram:
    """A program compiled for rows.

    Args:
        program: what to run.
        rows_only: this many inputs always differ per row.
        states: outputs fed back as inputs, see `run_function`.
        effort: of compiling, see `compile_function`.
    """

    def __init__(self, program: Tape, rows_only: int, states: int = 0, effort: int = 2) -> None:
        self.program = program
        self.lanes = host_lanes()
        self.nanoseconds = NANOSECONDS * program.count / self.lanes
        text = run_function(program, self.lanes, rows_only, states)
        self.function, self.keep = compile_function(text, SIGNATURE, effort)

    def bind(
        self, inputs: list[Array] | Array, out: Array, iterations: int = 1
    ) -> Callable[[int, int], None]:
        """Return what evaluates rows start..stop.

        Args:
            inputs: per input (N,) values, any strides, or (1,) for one value shared by all rows.
            out: (outputs, N), filled, C-contiguous, N at least the number of lanes.
            iterations: at most this many rounds of a program with states.
        """
        count = len(inputs)
        if isinstance(inputs, np.ndarray):  # asking each of its rows takes as long as many steps
            first, apart = inputs.ctypes.data, inputs.strides[0]
            places = list(range(first, first + apart * count, apart))
            steps = [inputs.strides[1] // inputs.itemsize] * count
        else:
            places = [x.ctypes.data for x in inputs]
            steps = [0 if len(x) == 1 else x.strides[0] // x.itemsize for x in inputs]
        pointers, strides = (ctypes.c_void_p * count)(*places), (ctypes.c_int64 * count)(*steps)
        place, rows = out.ctypes.data, out.shape[1]

        def run(start: int, stop: int) -> None:
            first = min(start, stop - self.lanes)
            self.function(pointers, strides, place, rows, first, stop, iterations)

        return run

    def bind_points(self, x: Array, shared: Array, out: Array) -> Callable[[int, int], None]:
        """Return the same for inputs that are the columns of one array, and shared ones.

        Args:
            x: (N, m), C-contiguous, N at least the number of lanes.
            shared: (k,), contiguous.
            out: (outputs, N), filled, C-contiguous.
        """
        rows, columns = x.shape
        places = np.arange(columns + len(shared))
        places[:columns] = x.ctypes.data + x.itemsize * places[:columns]
        places[columns:] = shared.ctypes.data + x.itemsize * (places[columns:] - columns)
        strides = np.zeros(len(places), dtype=np.int64)
        strides[:columns] = columns
        result = out.ctypes.data

        def run(start: int, stop: int) -> None:
            first = min(start, stop - self.lanes)
            self.function(places.ctypes.data, strides.ctypes.data, result, rows, first, stop, 1)

        run.keep = x, shared, out  # type: ignore[attr-defined]
        return run
