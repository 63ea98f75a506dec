"""The compiled machine for boxes: bounds that hold exactly, as sharp as the NumPy ones."""

import threading
from fractions import Fraction

import numpy as np
import pytest

from hitjoints.kernels.tape.backends import llvm_works, over_boxes
from hitjoints.kernels.tape.interval_backend import Interval, IntervalProgram
from hitjoints.kernels.tape.trace import (
    Tracer,
    absolute,
    cos,
    maximum,
    minimum,
    sin,
    square_root,
    where_less,
)

pytestmark = pytest.mark.skipif(not llvm_works(), reason="needs llvmlite")
COUNT = 4000
ULPS = 4


def pair(build, inputs):
    """A program on the machine and in NumPy."""
    from hitjoints.kernels.tape.interval_machine import MachineProgram

    tracer = Tracer(inputs)
    program = tracer.program(build(*tracer.inputs))
    return MachineProgram(program), IntervalProgram(program)


def intervals(rng, count):
    """Boxes of every size: huge and subnormal, points, around zero, touching it."""
    middle = rng.choice([-1.0, 1.0], count) * 10.0 ** rng.uniform(-12, 12, count)
    middle[::7] *= 1e-300
    middle[::11] = 0.0
    width = np.abs(middle) * 10.0 ** rng.uniform(-17, 1, count) * (rng.random(count) < 0.8)
    lower, upper = middle - width, middle + width
    lower[::13] = 0.0 * lower[::13]
    return Interval(np.minimum(lower, upper), np.maximum(lower, upper))


def exact(operation, a, b):
    """Least and greatest of an operation over two intervals, in fractions."""
    (la, ua), (lb, ub) = (tuple(map(Fraction, x)) for x in (a, b))
    if operation == "add":
        return la + lb, ua + ub
    if operation == "sub":
        return la - ub, ua - lb
    if operation == "square":
        ends = [la * la, ua * ua, *([Fraction(0)] if la <= 0 <= ua else [])]
    elif operation == "mul":
        ends = [x * y for x in (la, ua) for y in (lb, ub)]
    else:
        ends = [x / y for x in (la, ua) for y in (lb, ub)]
    return min(ends), max(ends)


@pytest.mark.parametrize("operation", ["add", "sub", "mul", "square", "div"])
def test_arithmetic_encloses_the_exact_result_within_a_few_ulps(operation):
    rng = np.random.default_rng(1)
    build = {
        "add": lambda a, b: [a + b],
        "sub": lambda a, b: [a - b],
        "mul": lambda a, b: [a * b],
        "square": lambda a, b: [a * a + 0.0 * b],
        "div": lambda a, b: [a / b],
    }[operation]
    machine, numpy = pair(build, 2)
    a, b = intervals(rng, COUNT), intervals(rng, COUNT)
    found, known = machine([a, b], COUNT), numpy([a, b], COUNT)
    around = (b.lower <= 0) & (b.upper >= 0)
    for i in range(COUNT):
        low, high = found.lower[0, i], found.upper[0, i]
        if operation == "div" and around[i]:
            assert (low, high) == (-np.inf, np.inf)
            continue
        least, most = exact(operation, (a.lower[i], a.upper[i]), (b.lower[i], b.upper[i]))
        if not np.isinf(low):
            assert Fraction(low) <= least
        if not np.isinf(high):
            assert Fraction(high) >= most
    finite = np.isfinite(known.lower[0]) & (np.abs(known.lower[0]) < 1e300)
    sharp = np.spacing(np.abs(known.lower[0, finite])) * ULPS + 1e-300
    assert (known.lower[0, finite] - found.lower[0, finite] <= sharp).all()
    finite = np.isfinite(known.upper[0]) & (np.abs(known.upper[0]) < 1e300)
    sharp = np.spacing(np.abs(known.upper[0, finite])) * ULPS + 1e-300
    assert (found.upper[0, finite] - known.upper[0, finite] <= sharp).all()


def test_the_rest_is_as_in_numpy():
    def build(a, b, c):
        root = square_root(absolute(c))
        least, most = minimum(a, b / c), maximum(a, b / c)
        return [-a, absolute(a), root, least, most, where_less(a, b, c, root), 2.5 + 0.0 * a]

    rng = np.random.default_rng(2)
    machine, numpy = pair(build, 3)
    given = [intervals(rng, COUNT) for _ in range(3)]
    found, known = machine(given, COUNT), numpy(given, COUNT)
    for ours, theirs, sign in ((found.lower, known.lower, 1), (found.upper, known.upper, -1)):
        np.testing.assert_array_equal(np.isinf(ours), np.isinf(theirs))
        fine = np.isfinite(theirs)
        wider, ulp = sign * (theirs[fine] - ours[fine]), np.spacing(np.abs(theirs[fine]))
        assert (wider <= ULPS * ulp + 1e-300).all()
        assert (wider >= -ulp).all()


@pytest.mark.skipif(np.finfo(np.longdouble).nmant < 60, reason="needs extended precision")
def test_sines_are_enclosed_and_reach_their_extrema():
    rng = np.random.default_rng(3)
    machine, numpy = pair(lambda x: [sin(x), cos(x)], 1)
    middle, width = rng.uniform(-30, 30, COUNT), 10.0 ** rng.uniform(-12, 1, COUNT)
    width[::2] = 0.0
    box = Interval(middle, middle + width)
    found, known = machine([box], COUNT), numpy([box], COUNT)
    for share in np.linspace(0, 1, 9):
        x = np.clip(middle + share * width, *box).astype(np.longdouble)
        for k, function in enumerate((np.sin, np.cos)):
            assert (found.lower[k] < function(x)).all()
            assert (found.upper[k] > function(x)).all()
    np.testing.assert_allclose(found.lower, known.lower, rtol=0, atol=1e-15)
    np.testing.assert_allclose(found.upper, known.upper, rtol=0, atol=1e-15)


@pytest.mark.parametrize("boxes", [1, 7, 8, 9, 65])
def test_any_number_of_boxes_and_shared_inputs(boxes):
    machine, numpy = pair(lambda a, b: [a * b + a, 3.0 + 0.0 * a], 2)
    rng = np.random.default_rng(boxes)
    a = rng.uniform(-1, 1, boxes)
    given = [Interval(a, a + 0.5), Interval(np.array([0.5]), np.array([0.75]))]
    found, known = machine(given, boxes), numpy(given, boxes)
    assert found.lower.shape == (2, boxes)
    np.testing.assert_allclose(found.lower, known.lower, rtol=1e-15)
    np.testing.assert_allclose(found.upper, known.upper, rtol=1e-15)


def test_threads_share_a_program():
    tracer = Tracer(1)
    (x,) = tracer.inputs
    run = over_boxes(tracer.program([sin(x) * x]))
    a = np.linspace(-3, 3, 5000)
    box, results = Interval(a, a + 0.01), []
    alone = run([box], len(a))
    threads = [
        threading.Thread(target=lambda: results.append(run([box], len(a)))) for _ in range(4)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert all((found.lower == alone.lower).all() for found in results)
