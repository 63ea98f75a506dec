"""LLVM IR of a machine that runs any program over boxes: compiled once, for all programs.

A compiled interval program would have twenty instructions for every operation, and take seconds to
compile; a machine that looks operations up in a table loses little where every step works on a
register of several boxes.
"""

from __future__ import annotations

import math

from hitjoints.kernels.tape.interval_text import Bounds, IntervalWriter

OPERANDS = {
    "add": 2, "sub": 2, "mul": 2, "square": 1, "div": 2, "neg": 1, "abs": 1,
    "min": 2, "max": 2, "select": 4, "sqrt": 1, "sin": 1, "cos": 1,
}  # fmt: skip
"""What the machine can do, and with how many operands."""
OPERATIONS = tuple(OPERANDS)
"""The place of an operation is its number."""
FIELDS = 6
"""Numbers of an instruction: operation, result, four operands; registers by their offset."""


class MachineWriter(IntervalWriter):
    """Registers, rows of bounds, and the loops over them."""

    def load(self, place: str) -> str:
        """A vector from memory."""
        return self.let(f"load {self.type}, ptr {place}, align 8")

    def number(self, array: str, index: str) -> str:
        """A whole number from an array."""
        place = self.let(f"getelementptr i64, ptr {array}, i64 {index}")
        return self.let(f"load i64, ptr {place}, align 8")

    def at(self, array: str, index: str) -> str:
        """The place of a double."""
        return self.let(f"getelementptr double, ptr {array}, i64 {index}")

    def register(self, offset: str) -> Bounds:
        """The interval in a register."""
        low = self.at("%bank", offset)
        return self.load(low), self.load(self.at(low, str(self.lanes)))

    def keep(self, place: str, gap: str, value: Bounds) -> None:
        """Write lower bounds, and the upper ones a gap behind them."""
        self.raw(f"  store {self.type} {value[0]}, ptr {place}, align 8")
        self.raw(f"  store {self.type} {value[1]}, ptr {self.at(place, gap)}, align 8")

    def row(self, array: str, number: str) -> str:
        """Where this group's lower bounds are in a row of all boxes."""
        start = self.let(f"mul i64 {number}, %twice")
        return self.at(array, self.let(f"add i64 {start}, %box"))

    def branch(self, condition: str, yes: str, no: str) -> None:
        """Go on at one of two labels."""
        bit = self.let(condition)
        self.raw(f"  br i1 {bit}, label %{yes}, label %{no}")


def interval_machine(lanes: int) -> str:
    """IR of run(code, steps, bank, in, inputs, places, outputs, out, boxes).

    Args:
        lanes: boxes per register. A register is a vector of lower bounds and one of upper ones;
            `bank` has the constants already, `in` the inputs and `out` the outputs, rows of
            `boxes` lower bounds and as many upper ones, `boxes` a multiple of the lanes. `places`
            are the offsets of the outputs' registers.
    """
    w = MachineWriter(lanes, fused=False)
    w.raw("  %twice = mul i64 %boxes, 2\n  br label %group")
    w.raw("group:\n  %box = phi i64 [ 0, %entry ], [ %box_next, %done ]\n  br label %fill")
    w.raw("fill:\n  %i = phi i64 [ 0, %group ], [ %i_next, %fill ]")
    source = w.row("%in", "%i")
    given = w.load(source), w.load(w.at(source, "%boxes"))
    w.keep(w.at("%bank", w.let(f"mul i64 %i, {2 * lanes}")), str(lanes), given)
    w.raw("  %i_next = add i64 %i, 1")
    w.branch("icmp slt i64 %i_next, %inputs", "fill", "begin")
    w.raw("begin:")
    w.branch("icmp slt i64 0, %steps", "step", "ready")
    _write_steps(w)
    w.raw("ready:\n  br label %drain\ndrain:\n  %k = phi i64 [ 0, %ready ], [ %k_next, %drain ]")
    low, high = w.register(w.number("%places", "%k"))
    # What is unknown has no bounds.
    low = w.select(w.unknown(low, low), w.constant(-math.inf), low)
    high = w.select(w.unknown(high, high), w.constant(math.inf), high)
    w.keep(w.row("%out", "%k"), "%boxes", (low, high))
    w.raw("  %k_next = add i64 %k, 1")
    w.branch("icmp slt i64 %k_next, %outputs", "drain", "done")
    w.raw(f"done:\n  %box_next = add i64 %box, {lanes}")
    w.branch("icmp slt i64 %box_next, %boxes", "group", "end")
    w.raw("end:\n  ret void")
    arguments = (
        "ptr %code, i64 %steps, ptr %bank, ptr %in, i64 %inputs, "
        "ptr %places, i64 %outputs, ptr %out, i64 %boxes"
    )
    body = "\n".join(w.lines)
    return f"{w.declarations}define void @run({arguments}) {{\nentry:\n{body}\n}}\n"


def _write_steps(w: MachineWriter) -> None:
    """Write the loop over the instructions, from the label `step`; it leaves for `ready`."""
    w.raw("step:\n  %pc = phi i64 [ 0, %begin ], [ %pc_next, %stored ]")
    first = w.let(f"mul i64 %pc, {FIELDS}")
    line = w.let(f"getelementptr i64, ptr %code, i64 {first}")
    operation, result, *operands = (w.number(line, str(k)) for k in range(FIELDS))
    common = [w.register(place) for place in operands[:2]]
    cases = " ".join(f"i64 {k}, label %op{k}" for k in range(len(OPERATIONS)))
    w.raw(f"  switch i64 {operation}, label %op0 [ {cases} ]")
    results: list[Bounds] = []
    for k, (name, count) in enumerate(OPERANDS.items()):
        w.raw(f"op{k}:")
        w.reduced.clear()
        more = [w.register(place) for place in operands[2:count]]
        results.append(w.write(name, [*common[:count], *more]))
        w.raw("  br label %stored")
    w.raw("stored:")
    low, high = (
        w.let(f"phi {w.type} " + ", ".join(f"[ {r[end]}, %op{k} ]" for k, r in enumerate(results)))
        for end in (0, 1)
    )
    w.keep(w.at("%bank", result), str(w.lanes), (low, high))
    w.raw("  %pc_next = add i64 %pc, 1")
    w.branch("icmp slt i64 %pc_next, %steps", "step", "ready")
