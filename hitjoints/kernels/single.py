"""Outputs of one contact for one configuration at a time, compiled and checked as a kernel is."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import pinocchio as pin

from hitjoints.errors import InputError
from hitjoints.kernels.formulas.chain import Chain, Triple
from hitjoints.kernels.formulas.hit_formulas import HitFormulas
from hitjoints.kernels.formulas.links import TracedArm, dot
from hitjoints.kernels.formulas.speeds import product
from hitjoints.kernels.outputs import LIMITS, OUTPUTS, factor_for, known_outputs
from hitjoints.kernels.tape.scalar import ScalarProgram
from hitjoints.kernels.tape.trace import Scalar, Tape, Tracer, absolute, square_root, where_less
from hitjoints.kernels.verify import check, samples

UNUSABLE, INFEASIBLE, FINE = 0.0, 1.0, 2.0
"""The status: a number is not finite or the direction has no sane length; or the contact cannot
move along it, so that outputs hold their limits; or neither."""
TINY, HUGE = 1e-290, 1e290
"""Squares of lengths that are safe to divide by."""


def record_single(chain: Chain, contact: tuple[int, Triple], outputs: Sequence[str]) -> Tape:
    """Record outputs behind a status; the direction may have any length.

    Inputs: q (n), direction (3), the object's mass.

    Args:
        chain: the arm.
        contact: as `Chain.attach` returns it.
        outputs: names from `OUTPUTS`.

    Raises:
        InputError: an output needs a joint speed limit that the model does not have.
    """
    wanted, n = known_outputs(outputs), chain.size
    if any(LIMITS in output.needs for output in wanted) and not chain.has_speed_limits:
        raise InputError("outputs", tuple(outputs), "speeds need a velocity limit for every joint")
    tracer = Tracer(n + 4)
    q, mass = tracer.inputs[:n], tracer.inputs[n + 3]
    x, y, z = tracer.inputs[n : n + 3]
    square = dot((x, y, z), (x, y, z))
    scale = 1.0 / square_root(square)
    arm = TracedArm(chain, q)
    hit = HitFormulas(
        arm, factor_for(wanted, arm), contact, (scale * x, scale * y, scale * z), mass
    )
    total: Scalar = 0.0
    for value in (*q, mass):
        total = total + value
    # A number that is not finite makes the sum so, and no comparison with it holds.
    usable = where_less(absolute(total), math.inf, where_less(square, HUGE, 1.0, 0.0), 0.0)
    usable = where_less(TINY, square, usable, 0.0)
    moves = where_less(hit.floor, product(hit.g, hit.g), FINE, INFEASIBLE)
    status = where_less(0.0, usable, moves, UNUSABLE)
    return tracer.program([status, *(value for output in wanted for value in output.formula(hit))])


class SingleKernel:
    """A compiled program for one contact and some outputs; made by `build_single`.

    Args:
        program: as `record_single` records it, compiled.
        joints: number of joints n.
        outputs: names of the results.
    """

    def __init__(self, program: ScalarProgram, joints: int, outputs: tuple[str, ...]) -> None:
        self.program, self.joints, self.outputs = program, joints, outputs
        sizes = {"": (), "n": (joints,), "3": (3,), "3n": (3, joints)}
        self.shapes = [sizes[OUTPUTS[name].shape] for name in outputs]


def build_single(
    model: pin.Model, contact: tuple[int, Triple], outputs: tuple[str, ...]
) -> SingleKernel:
    """Compile outputs for one configuration at a time and check them against Pinocchio.

    Raises:
        ImportError: llvmlite is missing.
        InputError, ModelError, KernelMismatchError: as `build_kernel`.
    """
    chain = Chain.from_model(model)
    program = ScalarProgram(record_single(chain, chain.attach(*contact), outputs))
    kernel = SingleKernel(program, chain.size, outputs)
    inputs, bound = samples(model), program.bind()
    rows = []
    for q, h, mass in zip(*inputs, strict=True):
        bound.inputs[:] = (*q, *h, mass)
        bound.run()
        rows.append(bound.outputs[1:].copy())
    ends = np.cumsum([math.prod(shape) for shape in kernel.shapes])[:-1]
    parts = np.split(np.array(rows), ends, axis=1)
    results = {
        name: part.reshape(1, len(rows), *shape)
        for name, part, shape in zip(outputs, parts, kernel.shapes, strict=True)
    }
    check(model, [contact], inputs, results)
    return kernel
