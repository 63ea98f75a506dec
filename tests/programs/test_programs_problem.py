import numpy as np
import pytest

from hitjoints.errors import InputError
from hitjoints.programs.problem import (
    Program,
    dual_residual,
    duality_gap,
    primal_residual,
    residuals,
)

# min x0 + 2 x1, x0 + x1 = 1, x1 - x0 <= 0, box [0, 2]^2: x = (1, 0), y = -1, w = (0, -1)
SMALL = Program(
    c=np.array([1.0, 2.0]),
    lower=np.zeros(2),
    upper=np.full(2, 2.0),
    A=np.array([[1.0, 1.0]]),
    b=np.array([1.0]),
    C=np.array([[-1.0, 1.0]]),
    d=np.array([0.0]),
)
X, Y, Z, W = np.array([1.0, 0.0]), np.array([-1.0]), np.zeros(1), np.array([0.0, -1.0])


def test_the_optimum_has_no_residuals():
    assert residuals(SMALL, X, Y, Z, W).worst <= 1e-15
    assert SMALL.objective(X) == 1.0
    np.testing.assert_allclose(SMALL.bound_multipliers(X, Y, Z), W, atol=1e-15)


def test_the_optimum_of_a_quadratic_program_has_no_residuals():
    # min 1/2 |x|^2 + x0, x0 + x1 = 1 on [0, 2]^2: x = (0, 1), y = -1, w = (0, 0)
    p = Program(np.array([1.0, 0.0]), SMALL.lower, SMALL.upper, np.eye(2), SMALL.A, SMALL.b)
    x, y, z = np.array([0.0, 1.0]), np.array([-1.0]), np.zeros(0)
    assert residuals(p, x, y, z, p.bound_multipliers(x, y, z)).worst <= 1e-15
    assert p.objective(x) == 0.5
    moved = np.array([1e-3, 1 - 1e-3])
    assert duality_gap(p, moved, y, z, p.bound_multipliers(moved, y, z)) > 1e-8


@pytest.mark.parametrize("x", [[1 + 1e-6, 0], [1, 1e-6], [1, -1e-6], [0.5 - 1e-6, 0.5 + 1e-6]])
def test_the_primal_residual_sees_a_violated_row_or_bound(x):
    assert 1e-7 < primal_residual(SMALL, np.array(x)) < 1e-5


@pytest.mark.parametrize("bad", ["y", "z", "w"])
def test_the_dual_residual_sees_a_wrong_multiplier(bad):
    y, z, w = Y + 1e-6 * (bad == "y"), Z + 1e-6 * (bad == "z"), W + 1e-6 * (bad == "w")
    assert dual_residual(SMALL, X, y, z, w) > 1e-7


def test_the_dual_residual_sees_a_multiplier_of_the_wrong_sign():
    z = np.array([-1e-6])
    assert dual_residual(SMALL, X, Y, z, SMALL.bound_multipliers(X, Y, z)) > 0.1


def test_the_gap_sees_a_worse_point_and_a_bound_paid_for_that_is_not_touched():
    worse = np.array([1 - 1e-6, 1e-6])
    assert primal_residual(SMALL, worse) == 0.0
    assert duality_gap(SMALL, worse, Y, Z, W) > 1e-8
    y = Y + 1e-6
    assert duality_gap(SMALL, X, y, Z, SMALL.bound_multipliers(X, y, Z)) > 1e-8


def test_a_perturbed_answer_is_seen_whatever_the_scale_of_its_row():
    for size in (1e-4, 1.0, 1e4):
        p = Program(SMALL.c, SMALL.lower, SMALL.upper, A=size * SMALL.A, b=size * SMALL.b)
        assert primal_residual(p, np.array([1 + 1e-6, 0.0])) > 1e-7


def test_round_off_rows_are_no_violation():
    p = Program(SMALL.c, SMALL.lower, SMALL.upper, A=np.array([[1e-17, -3e-18]]), b=np.zeros(1))
    assert primal_residual(p, X) == 0.0


@pytest.mark.parametrize("name", ["c", "lower", "upper", "H", "A", "b", "C", "d"])
@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_numbers_that_are_not_finite_are_refused_by_name(name, bad):
    parts = {k: getattr(SMALL, k).copy() for k in ("c", "lower", "upper", "A", "b", "C", "d")}
    parts["H"] = np.eye(2)
    parts[name].flat[0] = bad
    with pytest.raises(InputError) as error:
        Program(**parts)
    assert error.value.argument == name


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("lower", np.zeros(3)),
        ("A", np.ones((1, 3))),
        ("A", np.ones((2, 2))),
        ("C", np.ones(2)),
        ("H", np.ones((2, 3))),
        ("H", np.array([[1.0, 1.0], [0.0, 1.0]])),
        ("H", -np.eye(2)),
    ],
)
def test_shapes_that_do_not_fit_and_costs_that_are_not_convex_are_refused(name, value):
    parts = {k: getattr(SMALL, k) for k in ("c", "lower", "upper", "A", "b", "C", "d")}
    with pytest.raises(InputError) as error:
        Program(**parts | {name: value})
    assert error.value.argument == name


def test_a_program_without_rows_has_empty_rows_of_the_right_width():
    p = Program(np.ones(3), -np.ones(3), np.ones(3))
    assert p.A.shape == p.C.shape == (0, 3)
