"""The straight hitting speed's linear program, answered in closed form and certified, or not."""

from __future__ import annotations

import threading
from collections import Counter
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np

from hitjoints.kernels.formulas.straight_motion import (
    evaluate_straight_motion,
    record_straight_motion,
)
from hitjoints.kernels.tape.backends import choose

if TYPE_CHECKING:
    from collections.abc import Callable

    from hitjoints.kernels.tape.scalar import ScalarProgram
    from hitjoints.programs.problem import Vector

FLOAT = np.dtype(float)
CERTIFIED = 1e-12
"""Residuals up to which an answer needs no other: round-off, a little amplified."""
WORTH_COMPILING = 2000
"""Programs of one size after which their formulas are compiled: by then plain floats have taken
as long as that does. The answers are the same to the last bit."""

_asked: Counter[int] = Counter()


def certified_motion(
    jacobian: Any, direction: Any, lower: Any, upper: Any
) -> tuple[float, Vector, float, float] | None:
    """Return the greatest speed straight along a direction (m/s), velocities (n,) rad/s that have
    it, and the primal residual and duality gap; None if they are too large to believe it, or if
    the input is anything but arrays of floats that make sense.
    """
    for array in (jacobian, direction, lower, upper):
        if type(array) is not np.ndarray or array.dtype is not FLOAT:
            return None
    n = lower.size
    shapes = jacobian.shape, direction.shape, lower.shape, upper.shape
    if shapes != ((3, n), (3,), (n,), (n,)) or not n:
        return None
    found = _answers.of(n)(jacobian, direction, lower, upper)
    usable, speed, primal, gap = found[0], found[1], found[n + 2], found[n + 3]
    if not (usable > 0.0 and primal <= CERTIFIED and gap <= CERTIFIED):
        return None
    return speed, np.array(found[2 : n + 2]), primal, gap


class _Answers(threading.local):
    """How programs of each size are answered; compiled ones with a thread's own numbers."""

    def __init__(self) -> None:
        self.compiled: dict[int, Callable[..., Any]] = {}

    def of(self, n: int) -> Callable[..., Any]:
        """Return what gives the formulas' outputs for n joints."""
        known = self.compiled.get(n)
        if known is None:
            _asked[n] += 1
            if _asked[n] < WORTH_COMPILING or choose() != "llvm":
                return _in_floats
            known = self.compiled[n] = _bound(_program(n), n)
        return known


_answers = _Answers()


def _in_floats(J: Vector, h: Vector, lower: Vector, upper: Vector) -> list[Any]:
    numbers = np.concatenate((J.ravel(), h, lower, upper))
    try:
        return evaluate_straight_motion(numbers.tolist(), lower.size)
    except (ZeroDivisionError, ValueError, OverflowError):  # where LLVM makes it no number
        return [0.0] * (lower.size + 4)


@cache  # one that is let go would take its code along
def _program(n: int) -> ScalarProgram:
    from hitjoints.kernels.tape.scalar import ScalarProgram

    return ScalarProgram(record_straight_motion(n), fused=False)


def _bound(program: ScalarProgram, n: int) -> Callable[..., Any]:
    inputs, outputs, run = program.bind()
    columns, h = inputs[: 3 * n].reshape(3, n), inputs[3 * n : 3 * n + 3]
    low, high = inputs[3 * n + 3 : 4 * n + 3], inputs[4 * n + 3 :]

    def answer(J: Vector, direction: Vector, lower: Vector, upper: Vector) -> Any:
        columns[:], h[:], low[:], high[:] = J, direction, lower, upper
        run()
        return outputs.tolist()

    return answer
