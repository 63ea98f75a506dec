"""Tracing: folding, sharing, dropping."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hitjoints.kernels.tape.llvm_backend import LlvmProgram
from hitjoints.kernels.tape.numpy_backend import NumpyProgram
from hitjoints.kernels.tape.trace import Tracer, absolute, cos, maximum, minimum, sin, where_less


def test_constants_fold():
    tracer = Tracer(1)
    (x,) = tracer.inputs
    assert 0.0 * x == 0.0
    minus = -x
    assert (x * 1.0).index == (x + 0.0).index == (-minus).index == x.index
    assert x - x == 0.0
    assert 0.0 / x == 0.0
    assert tracer.program([2.0 * x]).count == 1


def test_shared_work_is_recorded_once_and_dead_work_not_at_all():
    tracer = Tracer(2)
    x, y = tracer.inputs
    sin(x * y)
    program = tracer.program([x * y + y * x, -x * y])
    assert sorted(operation.name for operation in program.operations) == ["add", "mul", "neg"]


def build(choices, tracer):
    values = list(tracer.inputs)
    for kind, i, j in choices:
        a, b = values[i % len(values)], values[j % len(values)]
        values.append(
            [
                lambda a, b: a + b,
                lambda a, b: a - b,
                lambda a, b: a * b,
                lambda a, b: a / (2.0 + absolute(b)),
                lambda a, b: sin(a),
                lambda a, b: cos(b),
                lambda a, b: -a,
                minimum,
                maximum,
                lambda a, b: where_less(a, b, 1.5 * a, -b),
                lambda a, b: 0.5 - a,
            ][kind](a, b)
        )
    return values


@settings(max_examples=60, deadline=None, derandomize=True)
@given(st.lists(st.tuples(st.integers(0, 10), st.integers(0, 50), st.integers(0, 50)), max_size=25))
def test_backends_compute_what_python_does(choices):
    tracer = Tracer(3)
    program = tracer.program(build(choices, tracer))
    rows = np.random.default_rng(0).normal(size=(3, 9))
    results = []
    for run in (NumpyProgram(program), LlvmProgram(program, 3)):
        out = np.empty((len(program.outputs), 9))
        run.bind(list(rows), out)(0, 9)
        results.append(out)

    class Plain:
        inputs = ()

    for k in range(9):
        Plain.inputs = tuple(map(float, rows[:, k]))
        expected = [float(v) for v in build(choices, Plain)]
        if all(math.isfinite(v) and abs(v) < 1e3 for v in expected):
            for out in results:
                assert out[:, k] == pytest.approx(expected, rel=1e-9, abs=1e-9)
