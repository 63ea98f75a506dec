"""LLVM IR of interval operations, a box per lane, as `interval_backend` has them.

Every bound is rounded outward, by up to two units in the last place. NaN means "unknown".
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial

from hitjoints.kernels.tape.interval_backend import CIRCULAR_ERROR, TURN_ERROR
from hitjoints.kernels.tape.llvm_text import Writer

ULP = 2.0**-52
"""A double's distance to the next is at most this share of it,"""
SMALLEST = 2.0**-970
"""or, below this, of this."""

Bounds = tuple[str, str]


class IntervalWriter(Writer):
    """Operations over vectors of intervals, each a pair of names."""

    def unknown(self, a: str, b: str) -> str:
        """Whether a or b is NaN."""
        return self.let(f"fcmp uno {self.type} {a}, {b}")

    def either(self, a: str, b: str) -> str:
        """A or b, vectors of bits."""
        return self.let(f"or <{self.lanes} x i1> {a}, {b}")

    def both(self, a: str, b: str) -> str:
        """A and b, vectors of bits."""
        return self.let(f"and <{self.lanes} x i1> {a}, {b}")

    def at_most(self, a: str, b: str) -> str:
        """A <= b, a vector of bits."""
        return self.let(f"fcmp ole {self.type} {a}, {b}")

    def least(self, a: str, b: str) -> str:
        """The smaller; b if either is NaN."""
        return self.select(self.less(a, b), a, b)

    def greatest(self, a: str, b: str) -> str:
        """The larger; b if either is NaN."""
        return self.select(self.less(b, a), a, b)

    def poisoned(self, unknown: str, value: str) -> str:
        """The value, NaN where it is unknown."""
        return self.select(unknown, self.constant(math.nan), value)

    def down(self, x: str) -> str:
        """A double below x: by one or two units in the last place."""
        return self._moved(x, -ULP)

    def up(self, x: str) -> str:
        """A double above x."""
        return self._moved(x, ULP)

    def _moved(self, x: str, share: float) -> str:
        size = self.binary("fadd", self.call("fabs", x), self.constant(SMALLEST))
        return self.call("fma", size, self.constant(share), x)

    def hull(self, values: list[str]) -> Bounds:
        """Least and greatest of an even number of values, NaN if one is."""
        low = high = values[0]
        unknown = self.unknown(values[0], values[1])
        for a, b in zip(values[2::2], values[3::2], strict=True):
            unknown = self.either(unknown, self.unknown(a, b))
        for value in values[1:]:
            low, high = self.least(low, value), self.greatest(high, value)
        return self.poisoned(unknown, low), self.poisoned(unknown, high)

    def write(self, name: str, operands: list[Bounds]) -> Bounds:
        """Write one operation, as `interval_backend` has it."""
        writers: dict[str, Callable[..., Bounds]] = {
            "add": self.add,
            "sub": lambda a, b: self.add(a, self.negative(b)),
            "mul": self.product,
            "square": self.square,
            "div": self.quotient,
            "neg": self.negative,
            "abs": self.absolute,
            "min": partial(self.extreme, "min"),
            "max": partial(self.extreme, "max"),
            "select": self.choice,
            "sqrt": self.root,
            "sin": partial(self.wave, "sin"),
            "cos": partial(self.wave, "cos"),
        }
        return writers[name](*operands)

    def outward(self, low: str, high: str) -> Bounds:
        """The interval, widened by what rounding may have cost."""
        return self.down(low), self.up(high)

    def add(self, a: Bounds, b: Bounds) -> Bounds:
        """Sum a + b."""
        return self.outward(*(self.binary("fadd", x, y) for x, y in zip(a, b, strict=True)))

    def product(self, a: Bounds, b: Bounds) -> Bounds:
        """Product a b, of different intervals."""
        return self.outward(*self.hull([self.binary("fmul", x, y) for x in a for y in b]))

    def square(self, a: Bounds) -> Bounds:
        """The square of a."""
        return self.outward(*(self.binary("fmul", x, x) for x in self.absolute(a)))

    def quotient(self, a: Bounds, b: Bounds) -> Bounds:
        """Quotient a / b, unknown where b contains 0."""
        zero = self.constant(0.0)
        low, high = self.hull([self.binary("fdiv", x, y) for x in a for y in b])
        around = self.both(self.at_most(b[0], zero), self.at_most(zero, b[1]))
        return self.outward(self.poisoned(around, low), self.poisoned(around, high))

    def negative(self, a: Bounds) -> Bounds:
        """-a."""
        return self.let(f"fneg {self.type} {a[1]}"), self.let(f"fneg {self.type} {a[0]}")

    def root(self, a: Bounds) -> Bounds:
        """Square root of what of a is not negative."""
        zero = self.constant(0.0)
        low, high = (self.call("sqrt", self.select(self.less(x, zero), zero, x)) for x in a)
        low, high = self.outward(low, high)
        return self.select(self.less(low, zero), zero, low), high

    def choice(self, a: Bounds, b: Bounds, yes: Bounds, no: Bounds) -> Bounds:
        """`yes` where surely a < b, `no` where surely not, else both."""
        surely, never = self.less(a[1], b[0]), self.at_most(b[1], a[0])
        low, high = self.hull([yes[0], no[0]])[0], self.hull([yes[1], no[1]])[1]
        return (
            self.select(surely, yes[0], self.select(never, no[0], low)),
            self.select(surely, yes[1], self.select(never, no[1], high)),
        )

    def absolute(self, a: Bounds) -> Bounds:
        """|a|."""
        zero = self.constant(0.0)
        low, high = self.hull([self.call("fabs", x) for x in a])
        inside = self.both(self.at_most(a[0], zero), self.at_most(zero, a[1]))
        return self.select(inside, zero, low), high

    def extreme(self, name: str, a: Bounds, b: Bounds) -> Bounds:
        """The smaller is at most either upper bound even if the other is unknown, and so on."""
        least, pick = (0, self.least) if name == "min" else (1, self.greatest)
        sharp = self.poisoned(self.unknown(a[least], b[least]), pick(a[least], b[least]))
        p, q = a[1 - least], b[1 - least]
        loose = self.select(self.unknown(q, q), p, pick(p, q))
        return (sharp, loose) if name == "min" else (loose, sharp)

    def wave(self, name: str, x: Bounds) -> Bounds:
        """Sine or cosine: of the ends, and the extrema that may lie between them."""
        low, high = self.hull([self.circular(name, end) for end in x])
        top, bottom = (0.25, 0.75) if name == "sin" else (0.0, 0.5)
        high = self.select(self.reaches(x, top), self.constant(1.0), high)
        low = self.select(self.reaches(x, bottom), self.constant(-1.0), low)
        error = self.constant(CIRCULAR_ERROR)
        return self.binary("fsub", low, error), self.binary("fadd", high, error)

    def reaches(self, x: Bounds, phase: float) -> str:
        """Whether some whole number of turns plus the phase may lie in x."""
        turn, shift = self.constant(2.0 * math.pi), self.constant(phase)
        ends = [self.binary("fsub", self.binary("fdiv", end, turn), shift) for end in x]
        sizes = [self.call("fabs", end) for end in ends]
        size = self.binary("fadd", self.binary("fadd", self.constant(1.0), sizes[0]), sizes[1])
        slack = self.binary("fmul", self.constant(TURN_ERROR), size)
        first = self.call("ceil", self.binary("fsub", ends[0], slack))
        last = self.call("floor", self.binary("fadd", ends[1], slack))
        return self.at_most(first, last)
