"""Directions and points from outside."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from hitjoints.errors import InputError
from hitjoints.vectors import points, unit

NUMBERS = st.floats(allow_nan=False, allow_infinity=False)


@given(st.tuples(NUMBERS, NUMBERS, NUMBERS))
def test_unit_has_length_one_at_any_scale(vector):
    assume(any(vector))
    h = unit(vector)
    assert np.linalg.norm(h) == pytest.approx(1, abs=1e-15)
    assert (np.sign(h) * np.sign(vector) >= 0).all()


@given(st.tuples(*[st.floats(-10, 10)] * 3), st.floats(1e-3, 1e3))
def test_unit_ignores_the_length(vector, scale):
    assume(np.linalg.norm(vector) > 1e-3)
    np.testing.assert_allclose(unit(np.multiply(vector, scale)), unit(vector), rtol=0, atol=1e-14)


def test_rows():
    rows = unit([[0, 0, 2], [3, 0, 4]])
    np.testing.assert_allclose(rows, [[0, 0, 1], [0.6, 0, 0.8]], rtol=1e-15)
    assert unit(np.empty((0, 3))).shape == (0, 3)


@pytest.mark.parametrize(
    ("value", "message"),
    [
        ([0, 0, 0], "a direction must not be zero"),
        ([[0, 0, 1], [0, 0, 0]], "a direction must not be zero"),
        ([0, 1], "three numbers x,y,z"),
        (np.zeros((1, 1, 3)), "three numbers x,y,z"),
        (1.0, "three numbers x,y,z"),
        ("up", "three numbers x,y,z"),
        (None, "three numbers x,y,z"),
        ([0, np.nan, 1], "every number must be finite"),
        ([0, np.inf, 1], "every number must be finite"),
    ],
)
def test_refused(value, message):
    with pytest.raises(InputError) as caught:
        unit(value, "h")
    assert str(caught.value).startswith("h = ")
    assert message in str(caught.value)
    if "zero" not in message:
        with pytest.raises(InputError):
            points(value, "object")
