"""Printed numbers say no more than is known."""

import math

import numpy as np

from hitjoints.planning.words import at_most, told_apart


def test_a_printed_maximum_is_never_more():
    for value in 10.0 ** np.random.default_rng(0).uniform(-6, 4, 2000):
        for digits in (3, 4, 6):
            printed = float(at_most(value, digits))
            assert printed <= value
            assert printed > value * (1 - 10.0 ** (1 - digits) * 1.001)
    assert at_most(1.14) == "1.14"
    assert at_most(1.1399999) == "1.13"
    assert at_most(0.0) == "0"
    assert at_most(math.inf) == "inf"


def test_two_numbers_that_differ_are_printed_differently():
    rng = np.random.default_rng(1)
    for value, share in zip(
        rng.uniform(0.1, 3, 500), 10.0 ** rng.uniform(-14, 0, 500), strict=True
    ):
        less, more = told_apart(value, value * (1 + share))
        assert float(less) < float(more)
        assert float(less) <= value
