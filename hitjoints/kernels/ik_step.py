"""One step of inverse kinematics over abstract numbers, and the same repeated on a back end."""

from __future__ import annotations

import math
from typing import Protocol

import numpy as np

from hitjoints.kernels.formulas.chain import Chain
from hitjoints.kernels.formulas.hit_formulas import Attachment
from hitjoints.kernels.formulas.links import TracedArm, cross, dot, minus
from hitjoints.kernels.tape.backends import Array, choose, evaluate
from hitjoints.kernels.tape.numpy_backend import NumpyProgram
from hitjoints.kernels.tape.trace import (
    Number,
    Scalar,
    Tape,
    Tracer,
    Vector,
    maximum,
    minimum,
    where_less,
)

SQUARE_TOLERANCE = 1e-20  # m^2: the iteration rests a decade below what callers are promised
DAMPING = 0.1  # times the squared error: large steps far away, Newton's near the solution
LEAST_DAMPING = 1e-12  # keeps a straight arm solvable


def record_step(chain: Chain, contact: Attachment) -> Tape:
    """Record one projected Levenberg-Marquardt step.

    Inputs: q (n) and the target (3, world). Outputs: the next q (n), the squared error at q (m^2),
        and a
    number that is positive while the error is too large. A joint on a bound that the error pushes
    outward is left out of the step.
    """
    n = chain.size
    tracer = Tracer(n + 3)
    q = list(tracer.inputs[:n])
    arm = TracedArm(chain, tuple(q))
    last, point = contact
    reaches = arm.reaches(last - 1, point)
    target = minus(
        (tracer.inputs[n], tracer.inputs[n + 1], tracer.inputs[n + 2]), chain.base_position
    )
    error = minus(arm.outward(0, minus(arm.in_base(target), arm.shifts[0])), reaches[0])
    square = dot(error, error)
    columns = [
        _unless_blocked(column, dot(column, error), value, link.lower, link.upper)
        for column, value, link in zip(arm.columns(reaches), q, chain.links, strict=False)
    ]
    force = _solve(columns, DAMPING * square + LEAST_DAMPING, error)
    moved: list[Scalar] = []
    for i, value in enumerate(q):
        step = value + dot(columns[i], force) if i < len(columns) else value
        inside = _clamp(step, chain.links[i].lower, chain.links[i].upper)
        moved.append(where_less(SQUARE_TOLERANCE, square, inside, value))
    return tracer.program([*moved, square, square - SQUARE_TOLERANCE])


def _unless_blocked(column: Vector, push: Scalar, q: Number, lower: float, upper: float) -> Vector:
    if math.isinf(lower) and math.isinf(upper):
        return column
    room = where_less(0.0, push, upper - q, q - lower)
    gate = where_less(0.0, room, 1.0, 0.0)
    return gate * column[0], gate * column[1], gate * column[2]


def _clamp(value: Scalar, lower: float, upper: float) -> Scalar:
    if not math.isinf(lower):
        value = maximum(value, lower)
    return value if math.isinf(upper) else minimum(value, upper)


def _solve(columns: list[Vector], damping: Scalar, e: Vector) -> Vector:
    """(J J^T + damping 1)^-1 e by the adjugate."""
    rows = tuple(zip(*columns, strict=True))

    def product(i: int, j: int) -> Scalar:
        total: Scalar = 0.0
        for a, b in zip(rows[i], rows[j], strict=True):
            total = total + a * b
        return total

    xy, xz, yz = product(0, 1), product(0, 2), product(1, 2)
    a: Vector = (product(0, 0) + damping, xy, xz)
    b: Vector = (xy, product(1, 1) + damping, yz)
    c: Vector = (xz, yz, product(2, 2) + damping)
    bc, ca, ab = cross(b, c), cross(c, a), cross(a, b)
    scale = 1.0 / dot(a, bc)
    x, y, z = ((bc[k] * e[0] + ca[k] * e[1] + ab[k] * e[2]) * scale for k in range(3))
    return x, y, z


class Iteration(Protocol):
    """Repeats the step on many targets."""

    def __call__(
        self, q: Array, targets: Array, iterations: int, threads: int | None
    ) -> tuple[Array, Array]:
        """From q (n, N) towards targets (3, N): the new q (n, N) and its squared errors (N,)."""


class NumpyIteration:
    """Steps all rows still moving, then drops those that arrived.

    Args:
        program: one step.
    """

    def __init__(self, program: Tape) -> None:
        self.step = NumpyProgram(program)

    def __call__(
        self, q: Array, targets: Array, iterations: int, threads: int | None
    ) -> tuple[Array, Array]:
        """See `Iteration`."""
        q, square = q.copy(), np.empty(q.shape[1])
        active = np.arange(q.shape[1])
        for remaining in reversed(range(iterations)):
            inputs = [*q[:, active], *targets[:, active]]
            out = evaluate(self.step, len(q) + 2, inputs, len(active), threads)
            square[active] = out[-2]
            moving = out[-1] > 0.0
            active = active[moving]
            if remaining == 0 or not len(active):
                break
            q[:, active] = out[:-2, moving]
        return q, square


class LlvmIteration:
    """Loops inside the compiled code, until the last of the rows in a vector arrives.

    Args:
        program: one step.
    """

    def __init__(self, program: Tape) -> None:
        from hitjoints.kernels.tape.llvm_backend import LlvmProgram

        self.joints = program.inputs - 3
        self.run = LlvmProgram(program, program.inputs, states=self.joints)

    def __call__(
        self, q: Array, targets: Array, iterations: int, threads: int | None
    ) -> tuple[Array, Array]:
        """See `Iteration`."""
        inputs = [*q, *targets]
        out = evaluate(self.run, self.joints + 1, inputs, q.shape[1], threads, iterations)
        return out[:-1], out[-1]


def iteration(program: Tape, backend: str | None) -> Iteration:
    """Make the step ready on a back end, see `choose`."""
    return LlvmIteration(program) if choose(backend) == "llvm" else NumpyIteration(program)
