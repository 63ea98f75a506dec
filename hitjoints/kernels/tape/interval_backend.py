"""Run a program over boxes: bounds that hold for every point, rounding included.

Every bound is rounded outward by one unit in the last place. NaN means "unknown" on its way through
a program (a division by an interval around zero) and becomes an infinite bound at the end.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from hitjoints.kernels.tape.trace import Operand, Operation, Tape

Array = np.ndarray[Any, np.dtype[np.float64]]

CIRCULAR_ERROR = 1e-15
"""No implementation of sine or cosine in use is further off than this."""

TURN_ERROR = 1e-12
"""Slack in deciding whether an extremum lies in an interval, relative to its size in turns."""


class Interval(NamedTuple):
    """All numbers from lower to upper, per box."""

    lower: Array
    upper: Array


def outward(lower: Array, upper: Array) -> Interval:
    """Widen by the last place."""
    return Interval(np.nextafter(lower, -np.inf), np.nextafter(upper, np.inf))


def extremes(candidates: list[Array]) -> tuple[Array, Array]:
    """Least and greatest of the candidates, NaN if one is."""
    low = high = candidates[0]
    for candidate in candidates[1:]:
        low, high = np.minimum(low, candidate), np.maximum(high, candidate)
    return low, high


def add(a: Interval, b: Interval) -> Interval:
    """Sum a + b."""
    return outward(a.lower + b.lower, a.upper + b.upper)


def subtract(a: Interval, b: Interval) -> Interval:
    """Difference a - b."""
    return outward(a.lower - b.upper, a.upper - b.lower)


def multiply(a: Interval, b: Interval) -> Interval:
    """Product a b, with a = b taken as a square."""
    if a is b:
        low, high = absolute(a)
        return outward(low * low, high * high)
    return outward(*extremes([x * y for x in a for y in b]))


def divide(a: Interval, b: Interval) -> Interval:
    """Quotient a / b, unknown where b contains 0."""
    around_zero = (b.lower <= 0.0) & (b.upper >= 0.0)
    bounds = [np.where(around_zero, np.nan, y) for y in b]
    with np.errstate(over="ignore"):  # beyond the greatest number is infinity: a bound, too
        return outward(*extremes([x / y for x in a for y in bounds]))


def negative(a: Interval) -> Interval:
    """-a."""
    return Interval(-a.upper, -a.lower)


def absolute(a: Interval) -> Interval:
    """|a|."""
    low, high = extremes([np.abs(a.lower), np.abs(a.upper)])
    return Interval(np.where((a.lower <= 0.0) & (a.upper >= 0.0), 0.0, low), high)


def square_root(a: Interval) -> Interval:
    """Square root of what of a is not negative."""
    lower, upper = (np.sqrt(np.maximum(x, 0.0)) for x in a)
    return Interval(np.maximum(np.nextafter(lower, -np.inf), 0.0), np.nextafter(upper, np.inf))


def minimum(a: Interval, b: Interval) -> Interval:
    """The smaller: at most either upper bound, even if the other is unknown."""
    return Interval(np.minimum(a.lower, b.lower), np.fmin(a.upper, b.upper))


def maximum(a: Interval, b: Interval) -> Interval:
    """The larger: at least either lower bound, even if the other is unknown."""
    return Interval(np.fmax(a.lower, b.lower), np.maximum(a.upper, b.upper))


def select(a: Interval, b: Interval, yes: Interval, no: Interval) -> Interval:
    """`yes` where surely a < b, `no` where surely not, else both."""
    surely, never = a.upper < b.lower, a.lower >= b.upper
    low, high = extremes([yes.lower, no.lower])[0], extremes([yes.upper, no.upper])[1]
    return Interval(
        np.where(surely, yes.lower, np.where(never, no.lower, low)),
        np.where(surely, yes.upper, np.where(never, no.upper, high)),
    )


def sine(x: Interval) -> Interval:
    """Sine: highest a quarter turn after 0, lowest at three quarters."""
    return _circular(np.sin, x, 0.25, 0.75)


def cosine(x: Interval) -> Interval:
    """Cosine: highest at 0, lowest after half a turn."""
    return _circular(np.cos, x, 0.0, 0.5)


def _circular(function: Any, x: Interval, highest: float, lowest: float) -> Interval:
    low, high = extremes([function(x.lower), function(x.upper)])
    high = np.where(_reaches(x, highest), 1.0, high)
    low = np.where(_reaches(x, lowest), -1.0, low)
    return Interval(low - CIRCULAR_ERROR, high + CIRCULAR_ERROR)


def _reaches(x: Interval, phase: float) -> Any:
    """Whether some whole number of turns plus the phase may lie in x."""
    first, last = x.lower / (2.0 * np.pi) - phase, x.upper / (2.0 * np.pi) - phase
    slack = TURN_ERROR * (1.0 + np.abs(first) + np.abs(last))
    return np.ceil(first - slack) <= np.floor(last + slack)


FUNCTIONS: dict[str, Any] = {
    "add": add,
    "sub": subtract,
    "mul": multiply,
    "div": divide,
    "neg": negative,
    "abs": absolute,
    "min": minimum,
    "max": maximum,
    "select": select,
    "sqrt": square_root,
    "sin": sine,
    "cos": cosine,
}


class IntervalProgram:
    """A program over boxes.

    Args:
        program: what to run.
    """

    def __init__(self, program: Tape) -> None:
        self.program = program
        last = program.last_use()
        self.dying = [
            [o for o in set(operation.operands) if isinstance(o, int) and last[o] == step]
            for step, operation in enumerate(program.operations)
        ]

    def __call__(self, inputs: list[Interval], boxes: int) -> Interval:
        """Bounds of every output.

        Args:
            inputs: per input lower and upper bounds, (B,) or (1,) each.
            boxes: their number B.

        Returns:
            Lower and upper bounds, (outputs, B); infinite where nothing is known.
        """
        values: dict[int, Interval] = dict(enumerate(inputs))
        with np.errstate(invalid="ignore", over="ignore", divide="ignore"):
            for step, operation in enumerate(self.program.operations):
                values[self.program.inputs + step] = self._apply(operation, values)
                for dead in self.dying[step]:
                    del values[dead]
        results = [_known(values, output) for output in self.program.outputs]
        shape = (len(results), boxes)
        lower, upper = np.empty(shape), np.empty(shape)
        for k, result in enumerate(results):
            lower[k] = np.where(np.isnan(result.lower), -np.inf, result.lower)
            upper[k] = np.where(np.isnan(result.upper), np.inf, result.upper)
        return Interval(lower, upper)

    def _apply(self, operation: Operation, values: dict[int, Interval]) -> Interval:
        operands = [_known(values, operand) for operand in operation.operands]
        result: Interval = FUNCTIONS[operation.name](*operands)
        return result


def _known(values: dict[int, Interval], operand: Operand) -> Interval:
    if isinstance(operand, int):
        return values[operand]
    constant = np.full(1, operand)
    return Interval(constant, constant)
