"""Interval bounds: never wrong, and sharp enough to be of use."""

import itertools

import arms
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hitjoints.errors import InputError
from hitjoints.kernels import Interval, bisect, build_bounds, build_kernel
from hitjoints.kernels.tape import interval_backend as ia
from hitjoints.kernels.tape.backends import VARIABLE

OUTPUTS = ("inertia", "gradient", "speed", "straight_speed", "flux", "position", "jacobian")
ANGLE = st.floats(-20.0, 20.0)


@settings(max_examples=200, deadline=None, derandomize=True)
@given(middle=ANGLE, width=st.floats(0.0, 8.0), share=st.floats(0.0, 1.0))
def test_circular_functions_are_enclosed(middle, width, share):
    x = Interval(np.array([middle]), np.array([middle + width]))
    t = np.append(np.linspace(0.0, 1.0, 200), share) * width + middle
    for enclose, function in ((ia.sine, np.sin), (ia.cosine, np.cos)):
        bounds, values = enclose(x), function(t)
        assert np.all((bounds.lower <= values) & (values <= bounds.upper))
        assert bounds.upper - bounds.lower <= values.max() - values.min() + 1e-2


@pytest.mark.skipif(np.finfo(np.longdouble).nmant < 60, reason="needs extended precision")
def test_rounding_of_circular_functions_is_enclosed():
    x = np.random.default_rng(0).uniform(-20.0, 20.0, 10_000)
    for enclose, function in ((ia.sine, np.sin), (ia.cosine, np.cos)):
        bounds, exact = enclose(Interval(x, x)), function(x.astype(np.longdouble))
        assert np.all((bounds.lower < exact) & (exact < bounds.upper))


@settings(max_examples=300, deadline=None, derandomize=True)
@given(*[st.floats(-5.0, 5.0)] * 2, *[st.floats(0.0, 3.0)] * 2, *[st.floats(0.0, 1.0)] * 2)
def test_arithmetic_is_enclosed(a, b, wide_a, wide_b, s, t):
    A, B = (Interval(np.array([x]), np.array([x + w])) for x, w in ((a, wide_a), (b, wide_b)))
    x, y = min(a + s * wide_a, a + wide_a), min(b + t * wide_b, b + wide_b)
    pairs = [
        (ia.add(A, B), x + y),
        (ia.subtract(A, B), x - y),
        (ia.multiply(A, B), x * y),
        (ia.multiply(A, A), x * x),
        (ia.absolute(A), abs(x)),
        (ia.minimum(A, B), min(x, y)),
        (ia.maximum(A, B), max(x, y)),
        (ia.select(A, B, A, B), x if x < y else y),
    ]
    if y != 0.0 and abs(y) > 1e-300:
        pairs.append((ia.divide(A, B), x / y))
    for bounds, value in pairs:
        assert not (bounds.lower > value).any()
        assert not (bounds.upper < value).any()


@pytest.mark.parametrize("backend", ["llvm", "numpy"])
@pytest.mark.parametrize("make", [arms.iiwa14, arms.panda, lambda: arms.random_chain(3, 5)])
def test_no_sample_is_ever_outside(make, backend, monkeypatch):
    monkeypatch.setenv(VARIABLE, backend)
    model, boxes = make(), 1200
    contacts, h = [(model.nv - 1, (0.02, 0, 0)), (model.nv, (0, 0.05, 0.1))], arms.directions(1)[0]
    bounds = build_bounds(model, contacts, OUTPUTS)
    kernel = build_kernel(model, contacts, OUTPUTS)
    random = np.random.default_rng(0)
    width = 10.0 ** random.uniform(-9.0, 0.8, (boxes, 1)) * random.uniform(
        0.0, 1.0, (boxes, model.nv)
    )
    lower = arms.configurations(model, boxes) - 0.5 * width
    upper = lower + width
    found = bounds(lower, upper, h, mass=2.0)
    for share in (0.0, 1.0, *random.uniform(size=(5, boxes, model.nv))):
        q = np.clip(lower + share * width, lower, upper)
        for name, values in kernel(q, h, 2.0).items():
            assert np.all(values >= found[name].lower), name
            assert np.all(values <= found[name].upper), name


def test_bounds_converge_under_subdivision():
    model, h = arms.iiwa14(), np.array([0.0, 1.0, 0.0])
    contacts = [(6, (0, 0, 0))]
    bounds, kernel = build_bounds(model, contacts), build_kernel(model, contacts)
    middle = arms.configurations(model, 200)
    exact = kernel(middle, h)["inertia"][0]
    excess, shortfall = [], []
    for width in (1e-1, 1e-2, 1e-3, 1e-4):
        found = bounds(middle - width / 2, middle + width / 2, h)["inertia"]
        excess.append(np.median(found.upper[0] / exact - 1.0))
        shortfall.append(np.median(1.0 - found.lower[0] / exact))
    assert excess[0] < 0.5
    assert all(later < 0.2 * earlier for earlier, later in itertools.pairwise(excess))
    assert excess[3] < 1e-3
    assert shortfall[3] < 1e-3


def test_bisect_covers_the_box():
    lower, upper = np.array([[0.0, 0.0], [1.0, 1.0]]), np.array([[1.0, 2.0], [4.0, 2.0]])
    halves = bisect(lower, upper)
    assert halves.lower.tolist() == [[0, 0], [1, 1], [0, 1], [2.5, 1]]
    assert halves.upper.tolist() == [[1, 1], [2.5, 2], [1, 2], [4, 2]]
    assert bisect(lower[:1], upper[:1], np.array([3.0, 1.0])).upper.tolist() == [[0.5, 2], [1, 2]]


def test_infeasible_points_are_not_bounded_away():
    bounds = build_bounds(arms.iiwa14(), [(7, (0, 0, 0))])
    found = bounds(np.full((1, 7), -0.01), np.full((1, 7), 0.01), np.array([0.0, 0.0, 1.0]))
    assert np.isinf(found["inertia"].upper).all()


def test_wrong_boxes_are_refused():
    bounds = build_bounds(arms.iiwa14(), [(7, (0, 0, 0))])
    h = np.array([0.0, 1.0, 0.0])
    for lower, upper in ((np.zeros((1, 6)),) * 2, (np.ones((1, 7)), np.zeros((1, 7)))):
        with pytest.raises(InputError):
            bounds(lower, upper, h)
