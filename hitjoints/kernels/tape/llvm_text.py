"""Write a program as LLVM IR: every operation one vector instruction, one row per lane."""

from __future__ import annotations

import math
import struct
from collections.abc import Sequence

from hitjoints.kernels.tape.trace import Operand, Tape

# pi in two parts (Cody, Waite): with fused products, x - k pi loses nothing for any sensible angle.
PI_PARTS = (math.pi, 1.2246467991473532e-16)
SINE = tuple((-1.0) ** j / math.factorial(2 * j + 1) for j in range(12))
COSINE = tuple((-1.0) ** j / math.factorial(2 * j) for j in range(12))

INSTRUCTIONS = {"add": "fadd", "sub": "fsub", "mul": "fmul", "div": "fdiv"}
INTRINSICS = {"abs": "fabs", "sqrt": "sqrt"}


class Writer:
    """Lines of IR over vectors of `lanes` doubles.

    Args:
        lanes: rows per instruction.
        fused: products and sums may become one instruction, rounded once.
    """

    def __init__(self, lanes: int, fused: bool = True) -> None:
        self.lanes, self.fused = lanes, fused
        self.type = f"<{lanes} x double>"
        self.suffix = f"v{lanes}f64"
        self.lines: list[str] = []
        self.reduced: dict[str, tuple[str, str]] = {}

    @property
    def declarations(self) -> str:
        """The intrinsics that may be called."""
        t, s = self.type, self.suffix
        return (
            f"declare {t} @llvm.fma.{s}({t}, {t}, {t})\n"
            f"declare {t} @llvm.rint.{s}({t})\n"
            f"declare {t} @llvm.fabs.{s}({t})\n"
            f"declare {t} @llvm.sqrt.{s}({t})\n"
            f"declare {t} @llvm.floor.{s}({t})\n"
            f"declare {t} @llvm.ceil.{s}({t})\n"
        )

    def constant(self, value: float) -> str:
        """The same double in every lane."""
        bits = struct.unpack(">Q", struct.pack(">d", value))[0]
        return "<" + ", ".join([f"double 0x{bits:016X}"] * self.lanes) + ">"

    def let(self, expression: str) -> str:
        """A new name for the value of an expression."""
        name = f"%v{len(self.lines)}"
        self.lines.append(f"  {name} = {expression}")
        return name

    def raw(self, line: str) -> None:
        """A line that defines nothing numbered: a label, a branch, a store."""
        self.lines.append(line)

    def binary(self, name: str, a: str, b: str) -> str:
        """A (name) b."""
        contract = "contract " if self.fused else ""
        return self.let(f"{name} {contract}{self.type} {a}, {b}")

    def call(self, name: str, *arguments: str) -> str:
        """Call an intrinsic."""
        listed = ", ".join(f"{self.type} {a}" for a in arguments)
        return self.let(f"call {self.type} @llvm.{name}.{self.suffix}({listed})")

    def less(self, a: str, b: str) -> str:
        """A < b, a vector of bits."""
        return self.let(f"fcmp olt {self.type} {a}, {b}")

    def select(self, condition: str, yes: str, no: str) -> str:
        """`yes` where the condition holds, else `no`."""
        bits = f"<{self.lanes} x i1>"
        return self.let(f"select {bits} {condition}, {self.type} {yes}, {self.type} {no}")

    def gather(self, pointer: str, stride: str, row: str) -> str:
        """`lanes` doubles, `stride` apart, from pointer + row stride."""
        first = self.let(f"mul i64 {row}, {stride}")
        at = self.let(f"getelementptr double, ptr {pointer}, i64 {first}")
        vector = "undef"
        for lane in range(self.lanes):
            value = self.let(f"load double, ptr {at}, align 8")
            vector = self.let(f"insertelement {self.type} {vector}, double {value}, i32 {lane}")
            if lane + 1 < self.lanes:
                at = self.let(f"getelementptr double, ptr {at}, i64 {stride}")
        return vector

    def program(self, program: Tape, inputs: Sequence[str]) -> list[str]:
        """Write the operations; returns the names of the outputs."""
        self.reduced.clear()
        values = list(inputs)

        def name(operand: Operand) -> str:
            return values[operand] if isinstance(operand, int) else self.constant(operand)

        for operation in program.operations:
            values.append(self.operation(operation.name, [name(o) for o in operation.operands]))
        return [name(output) for output in program.outputs]

    def operation(self, name: str, operands: list[str]) -> str:
        """Write one operation."""
        if name in INSTRUCTIONS:
            return self.binary(INSTRUCTIONS[name], *operands)
        if name == "neg":
            return self.let(f"fneg {self.type} {operands[0]}")
        if name in INTRINSICS:
            return self.call(INTRINSICS[name], *operands)
        if name in {"sin", "cos"}:
            return self.circular(name, operands[0])
        a, b = operands[:2]
        if name == "select":
            return self.select(self.less(a, b), *operands[2:])
        return self.select(self.less(*((a, b) if name == "min" else (b, a))), a, b)

    def circular(self, name: str, x: str) -> str:
        """Sine or cosine: x - k pi in [-pi/2, pi/2], a Taylor polynomial, the sign of (-1)^k."""
        if x not in self.reduced:
            turns = self.call("rint", self.binary("fmul", x, self.constant(1.0 / math.pi)))
            rest = x
            for part in PI_PARTS:
                rest = self.call("fma", turns, self.constant(-part), rest)
            half = self.binary("fmul", turns, self.constant(0.5))
            parity = self.binary("fsub", half, self.call("rint", half))
            square = self.binary("fmul", parity, parity)
            sign = self.call("fma", square, self.constant(-8.0), self.constant(1.0))
            self.reduced[x] = rest, sign
        rest, sign = self.reduced[x]
        square = self.binary("fmul", rest, rest)
        series = SINE if name == "sin" else COSINE
        value = self.constant(series[-1])
        for coefficient in reversed(series[:-1]):
            value = self.call("fma", value, square, self.constant(coefficient))
        if name == "sin":
            sign = self.binary("fmul", sign, rest)
        return self.binary("fmul", value, sign)


def run_function(program: Tape, lanes: int, rows_only: int, states: int) -> str:
    """IR of run(inputs, strides, out, rows, start, stop, iterations).

    With states, the first outputs feed back into the first inputs and the last output says which
    lanes still move (positive); the loop ends when none does. What comes out is what went into the
    last evaluation.

    Args:
        program: what to run.
        lanes: rows per instruction.
        rows_only: this many inputs always differ per row; a later one with stride 0 is shared.
        states: number of values fed back, 0 for a plain evaluation.
    """
    w = Writer(lanes)
    t = w.type
    pointers: list[tuple[str, str]] = []
    for i in range(program.inputs):
        slot = w.let(f"getelementptr ptr, ptr %inputs, i64 {i}")
        stride = w.let(f"getelementptr i64, ptr %strides, i64 {i}")
        pointers.append((w.let(f"load ptr, ptr {slot}"), w.let(f"load i64, ptr {stride}")))
    last = w.let(f"sub i64 %stop, {lanes}")
    w.raw("  br label %loop\nloop:\n  %i = phi i64 [ %start, %entry ], [ %next, %done ]")
    # The last rows overlap the ones before instead of needing a loop of their own.
    row = w.let(f"call i64 @llvm.smin.i64(i64 %i, i64 {last})")
    values = [w.gather(*pointers[i], row) for i in range(rows_only)]
    for i in range(rows_only, program.inputs):
        pointer, stride = pointers[i]
        shared = w.let(f"icmp eq i64 {stride}, 0")
        w.raw(f"  br i1 {shared}, label %one{i}, label %many{i}\none{i}:")
        first = w.let(f"load double, ptr {pointer}, align 8")
        single = w.let(f"insertelement {t} undef, double {first}, i32 0")
        splat = w.let(f"shufflevector {t} {single}, {t} undef, <{lanes} x i32> zeroinitializer")
        w.raw(f"  br label %given{i}\nmany{i}:")
        each = w.gather(pointer, stride, row)
        w.raw(f"  br label %given{i}\ngiven{i}:")
        values.append(w.let(f"phi {t} [ {splat}, %one{i} ], [ {each}, %many{i} ]"))
    w.raw("  br label %ready\nready:\n  br label %step\nstep:")
    if states:
        w.raw("  %round = phi i64 [ 0, %ready ], [ %round_next, %step ]")
    first_phi, initial = len(w.lines), values[:states]
    for k in range(states):
        w.raw("")  # the phi, once the value fed back has a name
        values[k] = f"%state{k}"
    results = w.program(program, values)
    if states:
        for k in range(states):
            w.lines[first_phi + k] = (
                f"  %state{k} = phi {t} [ {initial[k]}, %ready ], [ {results[k]}, %step ]"
            )
            results[k] = values[k]
        bits = w.let(f"fcmp ogt {t} {results.pop()}, zeroinitializer")
        mask = w.let(f"bitcast <{lanes} x i1> {bits} to i{lanes}")
        moving = w.let(f"icmp ne i{lanes} {mask}, 0")
        w.raw("  %round_next = add i64 %round, 1")
        more = w.let("icmp slt i64 %round_next, %iterations")
        again = w.let(f"and i1 {moving}, {more}")
        w.raw(f"  br i1 {again}, label %step, label %done\ndone:")
    else:
        w.raw("  br label %done\ndone:")
    for k, result in enumerate(results):
        offset = w.let(f"mul i64 %rows, {k}")
        place = w.let(f"add i64 {offset}, {row}")
        at = w.let(f"getelementptr double, ptr %out, i64 {place}")
        w.raw(f"  store {t} {result}, ptr {at}, align 8")
    w.raw(f"  %next = add i64 %i, {lanes}")
    more = w.let("icmp slt i64 %next, %stop")
    w.raw(f"  br i1 {more}, label %loop, label %end\nend:\n  ret void")
    arguments = (
        "ptr noalias %inputs, ptr noalias %strides, ptr noalias %out, "
        "i64 %rows, i64 %start, i64 %stop, i64 %iterations"
    )
    body = "\n".join(w.lines)
    return (
        f"declare i64 @llvm.smin.i64(i64, i64)\n{w.declarations}"
        f"define void @run({arguments}) {{\nentry:\n{body}\n}}\n"
    )


def scalar_function(program: Tape, fused: bool = True) -> str:
    """IR of run(inputs, outputs) for one row: two arrays of doubles, nothing else.

    Args:
        program: what to run.
        fused: as `Writer`.
    """
    w = Writer(1, fused)

    def at(array: str, i: int) -> str:
        return w.let(f"getelementptr double, ptr %{array}, i64 {i}")

    values = []
    for i in range(program.inputs):
        place = at("inputs", i)
        values.append(w.let(f"load {w.type}, ptr {place}, align 8"))
    for k, result in enumerate(w.program(program, values)):
        place = at("outputs", k)
        w.raw(f"  store {w.type} {result}, ptr {place}, align 8")
    body = "\n".join(w.lines)
    arguments = "ptr noalias %inputs, ptr noalias %outputs"
    return f"{w.declarations}define void @run({arguments}) {{\nentry:\n{body}\n  ret void\n}}\n"
