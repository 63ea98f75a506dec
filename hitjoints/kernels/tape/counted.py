"""Formulas run in plain floats, and compiled once they have been asked for often: the same bits."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING, Any

import numpy as np

from hitjoints.kernels.tape.backends import choose
from hitjoints.kernels.tape.trace import Scalar, Tracer

if TYPE_CHECKING:
    from collections.abc import Callable

    from hitjoints.kernels.tape.scalar import ScalarProgram

    Formula = Callable[[tuple[Scalar, ...]], list[Scalar]]


class CountedProgram:
    """Formulas of some numbers, without sines; threads may share it.

    Products and sums are not fused when it is compiled, so that every answer has the bits that
    Python's floats give it, whatever was asked before.

    Args:
        formula: returns the outputs for the inputs.
        inputs: how many.
        worth: calls after which it is compiled: by then floats have taken as long as that does.
    """

    def __init__(self, formula: Formula, inputs: int, worth: int) -> None:
        self.formula, self.inputs, self.worth = formula, inputs, worth
        self._calls, self._own = 0, threading.local()
        self._program: ScalarProgram | None = None

    def __call__(self, *parts: np.ndarray[Any, Any]) -> list[Any]:
        """Return the outputs for arrays of inputs, always of the same shapes.

        Returns:
            The outputs; nothing where floats have no answer, such as for a division by zero.
        """
        bound = getattr(self._own, "bound", None)
        if bound is None:
            self._calls += 1
            if self._calls < self.worth or choose() != "llvm":
                return self._in_floats(parts)
            bound = self._own.bound = self._bind(parts)
        views, run, outputs = bound
        for view, part in zip(views, parts, strict=True):
            view[...] = part
        run()
        found: list[Any] = outputs()
        return found

    def _in_floats(self, parts: tuple[np.ndarray[Any, Any], ...]) -> list[Any]:
        numbers = np.concatenate([part.ravel() for part in parts]).tolist()
        try:
            return self.formula(tuple(numbers))
        except (ZeroDivisionError, ValueError, OverflowError):
            return []

    def _bind(self, parts: tuple[np.ndarray[Any, Any], ...]) -> tuple[Any, Any, Any]:
        from hitjoints.kernels.tape.scalar import ScalarProgram

        program = self._program
        if program is None:  # two threads at once may compile it twice
            tracer = Tracer(self.inputs)
            tape = tracer.program(self.formula(tracer.inputs))
            program = self._program = ScalarProgram(tape, fused=False, effort=0)
        inputs, outputs, run = program.bind()
        ends = np.cumsum([part.size for part in parts])
        pieces = np.split(inputs, ends[:-1])
        views = [piece.reshape(part.shape) for piece, part in zip(pieces, parts, strict=True)]
        return views, run, outputs.tolist
