"""Record arithmetic once as a straight-line program.

The formulas run over plain floats and `Number`s mixed. A float is a constant and folds on the spot;
an operation on a `Number` is recorded, the same operation only once.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

Operand = int | float
"""An int names the result of an earlier operation, a float is a constant."""

COMMUTATIVE = frozenset({"add", "mul", "min", "max"})


@dataclass(frozen=True)
class Operation:
    """One step: `name` applied to `operands`."""

    name: str
    operands: tuple[Operand, ...]


@dataclass(frozen=True)
class Tape:
    """A straight-line program: step i defines value i, the first `inputs` values are given.

    Args:
        inputs: how many values are given.
        operations: the steps, in an order in which every operand is known.
        outputs: the results, each a value or a constant.
    """

    inputs: int
    operations: tuple[Operation, ...]
    outputs: tuple[Operand, ...]

    @property
    def count(self) -> int:
        """Number of operations in one evaluation."""
        return len(self.operations)

    def last_use(self) -> list[int]:
        """Step after which each value is dead (the number of steps for an output), per value."""
        last = [-1] * (self.inputs + self.count)
        for step, operation in enumerate(self.operations):
            for operand in operation.operands:
                if isinstance(operand, int):
                    last[operand] = step
        for output in self.outputs:
            if isinstance(output, int):
                last[output] = self.count
        return last


class Number:
    """A value known only when the program runs."""

    __slots__ = ("index", "tracer")

    def __init__(self, tracer: Tracer, index: int) -> None:
        self.tracer, self.index = tracer, index

    def __add__(self, other: Scalar) -> Scalar:
        return self.tracer.add(self, other)

    def __sub__(self, other: Scalar) -> Scalar:
        return self.tracer.add(self, -other)

    def __mul__(self, other: Scalar) -> Scalar:
        return self.tracer.multiply(self, other)

    def __truediv__(self, other: Scalar) -> Scalar:
        return self.tracer.record("div", self, other)

    def __rsub__(self, other: float) -> Scalar:
        return self.tracer.add(-self, other)

    def __rtruediv__(self, other: float) -> Scalar:
        return 0.0 if other == 0.0 else self.tracer.record("div", other, self)

    def __neg__(self) -> Number:
        return self.tracer.negate(self)

    __radd__, __rmul__ = __add__, __mul__


Scalar = float | Number
Vector = tuple[Scalar, Scalar, Scalar]


class Tracer:
    """Collects the operations applied to its numbers.

    Args:
        inputs: how many numbers the program is given.
    """

    def __init__(self, inputs: int) -> None:
        self.operations: list[Operation] = []
        self.known: dict[Operation, int] = {}
        self.inputs = tuple(Number(self, index) for index in range(inputs))

    def record(self, name: str, *arguments: Scalar) -> Number:
        """Append one operation, or find the same one made before."""
        operands = tuple(a.index if isinstance(a, Number) else float(a) for a in arguments)
        if name in COMMUTATIVE:
            operands = tuple(sorted(operands, key=lambda o: (isinstance(o, float), o)))
        operation = Operation(name, operands)
        if operation not in self.known:
            self.known[operation] = len(self.inputs) + len(self.operations)
            self.operations.append(operation)
        return Number(self, self.known[operation])

    def negated(self, number: Number) -> Number | None:
        """X if the number is -x."""
        step = number.index - len(self.inputs)
        if step >= 0 and self.operations[step].name == "neg":
            (operand,) = self.operations[step].operands
            return Number(self, int(operand))
        return None

    def negate(self, a: Number) -> Number:
        """-a."""
        positive = self.negated(a)
        return self.record("neg", a) if positive is None else positive

    def add(self, a: Number, b: Scalar) -> Scalar:
        """Sum a + b, signs pulled into a subtraction."""
        if not isinstance(b, Number):
            if b == 0.0:
                return a
            minus_a = self.negated(a)
            return self.record("add", a, b) if minus_a is None else self.record("sub", b, minus_a)
        minus_a, minus_b = self.negated(a), self.negated(b)
        if minus_b is not None:
            if minus_b.index == a.index:
                return 0.0
            return -(minus_a + minus_b) if minus_a is not None else self.record("sub", a, minus_b)
        return self.record("add", a, b) if minus_a is None else self.add(b, a)

    def multiply(self, a: Number, b: Scalar) -> Scalar:
        """A product a b, signs pulled out, so that x y and -x y share the work."""
        minus_a = self.negated(a)
        if minus_a is not None:
            return -(minus_a * b)
        if not isinstance(b, Number):
            if b == 0.0:
                return 0.0
            if b < 0.0:
                return -(a * -b)
            return a if b == 1.0 else self.record("mul", a, b)
        minus_b = self.negated(b)
        return self.record("mul", a, b) if minus_b is None else -(a * minus_b)

    def program(self, outputs: Sequence[Scalar]) -> Tape:
        """The operations the outputs need, renumbered."""
        given = len(self.inputs)
        needed = {o.index for o in outputs if isinstance(o, Number)}
        for step in reversed(range(len(self.operations))):
            if given + step in needed:
                needed.update(o for o in self.operations[step].operands if isinstance(o, int))
        place: dict[int, int] = {index: index for index in range(given)}
        kept: list[Operation] = []
        for step, operation in enumerate(self.operations):
            if given + step in needed:
                moved = tuple(place[o] if isinstance(o, int) else o for o in operation.operands)
                place[given + step] = given + len(kept)
                kept.append(Operation(operation.name, moved))
        results = tuple(place[o.index] if isinstance(o, Number) else float(o) for o in outputs)
        return Tape(given, tuple(kept), results)


def sin(x: Scalar) -> Scalar:
    """Sine of x (rad)."""
    return x.tracer.record("sin", x) if isinstance(x, Number) else math.sin(x)


def cos(x: Scalar) -> Scalar:
    """Cosine of x (rad)."""
    return x.tracer.record("cos", x) if isinstance(x, Number) else math.cos(x)


def square_root(x: Scalar) -> Scalar:
    """Square root of x >= 0."""
    return x.tracer.record("sqrt", x) if isinstance(x, Number) else math.sqrt(x)


def absolute(x: Scalar) -> Scalar:
    """|x|."""
    if not isinstance(x, Number):
        return abs(x)
    positive = x.tracer.negated(x)
    return x.tracer.record("abs", x if positive is None else positive)


def minimum(a: Scalar, b: Scalar) -> Scalar:
    """The smaller of a and b."""
    if isinstance(a, Number):
        return a.tracer.record("min", a, b)
    return b.tracer.record("min", a, b) if isinstance(b, Number) else min(a, b)


def maximum(a: Scalar, b: Scalar) -> Scalar:
    """The larger of a and b."""
    if isinstance(a, Number):
        return a.tracer.record("max", a, b)
    return b.tracer.record("max", a, b) if isinstance(b, Number) else max(a, b)


def where_less(a: Scalar, b: Scalar, yes: Scalar, no: Scalar) -> Scalar:
    """`yes` where a < b, else `no`."""
    if isinstance(a, Number):
        return a.tracer.record("select", a, b, yes, no)
    if isinstance(b, Number):
        return b.tracer.record("select", a, b, yes, no)
    return yes if a < b else no
