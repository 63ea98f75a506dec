"""Run a program over boxes by the compiled machine: `interval_backend` in microseconds."""

from __future__ import annotations

import ctypes
import functools
from typing import Any

import numpy as np

from hitjoints.kernels.tape.interval_backend import Interval
from hitjoints.kernels.tape.llvm_backend import compile_function, host_lanes
from hitjoints.kernels.tape.machine_text import FIELDS, OPERATIONS, interval_machine
from hitjoints.kernels.tape.numpy_backend import assign_registers
from hitjoints.kernels.tape.trace import Operand, Tape

POINTER, COUNT = ctypes.c_void_p, ctypes.c_int64
SIGNATURE = ctypes.CFUNCTYPE(
    None, POINTER, COUNT, POINTER, POINTER, COUNT, POINTER, COUNT, POINTER, COUNT
)


@functools.cache
def machine() -> tuple[Any, int, Any]:
    """The machine for this CPU, its lanes, and what must outlive it."""
    lanes = host_lanes()
    function, keep = compile_function(interval_machine(lanes), SIGNATURE)
    return function, lanes, keep


class MachineProgram:
    """A program over boxes, as a table of instructions; threads may share it.

    Args:
        program: what to run.
    """

    def __init__(self, program: Tape) -> None:
        self.program = program
        self._run, self._lanes, self._keep = machine()
        width = 2 * self._lanes
        register, total = assign_registers(program)
        constants: dict[float, int] = {}

        def place(operand: Operand) -> int:
            if isinstance(operand, int):
                return width * register[operand]
            return width * (total + constants.setdefault(operand, len(constants)))

        self._code = np.zeros((program.count, FIELDS), dtype=np.int64)
        for step, operation in enumerate(program.operations):
            operands = [place(operand) for operand in operation.operands]
            square = operation.name == "mul" and operands[0] == operands[1]
            self._code[step, 0] = OPERATIONS.index("square" if square else operation.name)
            self._code[step, 1] = width * register[program.inputs + step]
            self._code[step, 2 : 2 + len(operands)] = operands
        self._places = np.array([place(o) for o in program.outputs], dtype=np.int64)
        self._bank = np.zeros((total + max(1, len(constants)), width))
        for value, k in constants.items():
            self._bank[total + k] = value

    def __call__(self, inputs: list[Interval], boxes: int) -> Interval:
        """Bounds of every output, see `IntervalProgram`."""
        padded = max(1, -(-boxes // self._lanes)) * self._lanes
        given = np.empty((max(1, self.program.inputs), 2, padded))
        for row, bounds in zip(given, inputs, strict=False):
            row[0, :boxes], row[1, :boxes] = bounds
        given[:, :, boxes:] = 0.0
        found = np.empty((len(self._places), 2, padded))
        bank = self._bank.copy()  # every call its own: threads
        self._run(
            self._code.ctypes.data,
            len(self._code),
            bank.ctypes.data,
            given.ctypes.data,
            self.program.inputs,
            self._places.ctypes.data,
            len(found),
            found.ctypes.data,
            padded,
        )
        return Interval(found[:, 0, :boxes], found[:, 1, :boxes])
