import numpy as np
import program_corpus as corpus
import pytest
from scipy.optimize import linprog

from hitjoints.errors import InfeasibleError, InputError
from hitjoints.programs.hitting_speed import (
    box_speed,
    build_hitting_speed,
    solve_hitting_speed,
    step_bounds,
)

COUNT = 2000
ONE, J3 = np.ones(3), np.diag([1.0, 2.0, 3.0])


def highs_speed(J, h, lower, upper, straight):
    """The same optimum by HiGHS, from rows found another way: the range of (I - h h^T) J."""
    rows = {}
    if straight:
        _, s, Vt = np.linalg.svd(J - np.outer(h, h @ J), full_matrices=False)
        rows = {"A_eq": Vt[s > 1e-9], "b_eq": np.zeros((s > 1e-9).sum())}
    found = linprog(
        -(h @ J),
        **rows,
        bounds=np.column_stack([lower, upper]),
        method="highs",
        options={"primal_feasibility_tolerance": 1e-10, "dual_feasibility_tolerance": 1e-10},
    )
    assert found.status == 0
    return -found.fun


@pytest.mark.parametrize("straight", [False, True])
def test_the_speed_agrees_with_highs_and_the_closed_form(straight):
    rng = np.random.default_rng(31)
    for _ in range(COUNT):
        J, h = corpus.jacobian(rng), corpus.direction(rng)
        lower, upper = corpus.velocity_box(rng, J.shape[1])
        found = solve_hitting_speed(J, h, lower, upper, straight)
        reach = np.abs(h @ J) @ np.maximum(-lower, upper)
        expected = highs_speed(J, h, lower, upper, straight)
        # where h J nearly vanishes the speed is round-off of the terms that cancel
        np.testing.assert_allclose(found.speed, expected, rtol=1e-6, atol=1e-10 * reach)
        assert ((lower <= found.qd) & (found.qd <= upper)).all()
        np.testing.assert_allclose(found.speed, h @ J @ found.qd, atol=1e-14 * (1 + reach))
        closed, qd = box_speed(h @ J, lower, upper)
        np.testing.assert_allclose(h @ J @ qd, closed, rtol=1e-12, atol=1e-14)
        if straight:
            sideways = J @ found.qd - h * found.speed
            assert (
                np.abs(sideways).max() <= 1e-8 * np.linalg.norm(J) * np.abs(found.qd).max() + 1e-14
            )
            assert found.speed <= closed + 1e-9 * reach
        else:
            np.testing.assert_allclose(found.speed, closed, rtol=1e-9, atol=1e-15)


@pytest.mark.parametrize("size", 10.0 ** np.arange(-14, -5))
def test_a_jacobian_however_near_to_singular_is_not_called_infeasible(size):
    rng = np.random.default_rng(32)
    for _ in range(40):
        U, s, Vt = np.linalg.svd(rng.normal(size=(3, 7)), full_matrices=False)
        s[2] = size
        found = solve_hitting_speed(
            U * s @ Vt, corpus.direction(rng), -ONE[0] * np.ones(7), np.ones(7), True
        )
        assert found.residuals.worst <= 1e-8


def test_the_closed_form_with_asymmetric_and_zero_limits():
    speed, qd = box_speed([2.0, -1.0, 0.0, 3.0], [-1, -4, 0.5, 0], [0.5, 1, 1, 0])
    assert speed == 2 * 0.5 + 4
    np.testing.assert_array_equal(qd, [0.5, -4, 0.5, 0])


def test_a_planar_arm_hits_straight_with_both_joints():
    # two links of 1 m, elbow at 90 degrees, tip at (1, 1): straight along x takes qd1 = 0
    J = np.array([[-1.0, -1.0], [1.0, 0.0], [0.0, 0.0]])
    found = solve_hitting_speed(J, [1, 0, 0], [-2, -3], [2, 1], straight=True)
    assert found.speed == pytest.approx(3.0)
    np.testing.assert_allclose(found.qd, [0, -3], atol=1e-12)
    assert solve_hitting_speed(J, [1, 0, 0], [-2, -3], [2, 1]).speed == pytest.approx(5.0)


def test_an_infeasible_direction_has_speed_zero():
    J = np.array([[-1.0, -1.0], [1.0, 0.0], [0.0, 0.0]])
    for straight in (False, True):
        assert solve_hitting_speed(J, [0, 0, 1], -ONE[:2], ONE[:2], straight).speed == 0.0


def test_locked_arms_do_not_move():
    found = solve_hitting_speed(J3, [1, 2, 3], 0 * ONE, 0 * ONE, straight=True)
    assert found.speed == 0.0


def test_limits_that_force_a_motion_sideways_are_infeasible():
    with pytest.raises(InfeasibleError, match="equality"):
        solve_hitting_speed(J3, [1, 0, 0], 0.5 * ONE, ONE, straight=True)
    with pytest.raises(InfeasibleError, match="variable 1"):
        solve_hitting_speed(J3, [1, 0, 0], [0, 1, 0], [1, 0.5, 1])
    with pytest.raises(InfeasibleError, match="variable 1"):
        box_speed(ONE, [0, 1, 0], [1, 0.5, 1])
    assert solve_hitting_speed(J3, [-1, 0, 0], 0.5 * ONE, ONE).speed == pytest.approx(-0.5)


def test_the_direction_is_normalised_and_the_rows_are_sideways():
    p = build_hitting_speed(J3, [0, 0, 2], -ONE, ONE, straight=True)
    np.testing.assert_allclose(p.c, [0, 0, -3])
    assert p.A.shape == (2, 3)
    np.testing.assert_allclose(p.A.T @ p.A, J3.T @ np.diag([1, 1, 0]) @ J3, atol=1e-14)
    assert build_hitting_speed(J3, [0, 0, 2], -ONE, ONE).A.shape == (0, 3)


def test_step_bounds_intersect_velocity_and_position_limits():
    lower, upper = step_bounds(
        [0, 0.95, -1, 0], [-1, -1, -1, -np.inf], [1, 1, 1, np.inf], [-2] * 4, [2, 2, 2, 0], 0.1
    )
    np.testing.assert_allclose(lower, [-2, -2, 0, -2])
    np.testing.assert_allclose(upper, [2, 0.5, 2, 0])


def test_a_joint_that_stopped_at_its_limit_may_stay_there():
    lower, upper = step_bounds([1 + 1e-12], [-1], [1], [-1], [1], 1e-3)
    assert (lower[0], upper[0]) == (-1.0, 0.0)


def test_a_joint_outside_its_limits_is_an_error_with_both_bounds():
    with pytest.raises(InputError, match=r"joint 2 at 1\.5.*\[-1\.0, 1\.0\]"):
        step_bounds([0, 1.5], [-1, -1], [1, 1], [-1, -1], [1, 1], 0.1)


@pytest.mark.parametrize("bad", [np.inf, np.nan])
@pytest.mark.parametrize("name", ["pull", "lower", "upper", "jacobian", "direction"])
def test_numbers_that_are_not_finite_name_their_argument(name, bad):
    first = {"pull": ONE.copy()} if name == "pull" else {"jacobian": J3, "direction": ONE.copy()}
    arguments = first | {"lower": -ONE, "upper": ONE.copy()}
    arguments[name] = arguments[name].copy()
    arguments[name].flat[0] = bad
    with pytest.raises(InputError) as error:
        (box_speed if name == "pull" else solve_hitting_speed)(**arguments)
    assert error.value.argument == name


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("q", [0, np.nan]),
        ("position_lower", [-1]),
        ("velocity_lower", [-np.inf, -1]),
        ("velocity_upper", [1, np.inf]),
        ("dt", 0.0),
        ("dt", np.nan),
    ],
)
def test_step_bounds_refuses_what_it_cannot_use(name, value):
    arguments = {
        "q": [0, 0],
        "position_lower": [-1, -1],
        "position_upper": [1, 1],
        "velocity_lower": [-1, -1],
        "velocity_upper": [1, 1],
        "dt": 0.1,
    }
    with pytest.raises(InputError) as error:
        step_bounds(**arguments | {name: value})
    assert error.value.argument == name


@pytest.mark.parametrize(
    ("name", "change"),
    [
        ("jacobian", {"jacobian": np.ones((2, 3))}),
        ("direction", {"direction": np.ones((2, 3))}),
        ("direction", {"direction": np.zeros(3)}),
        ("lower", {"lower": np.ones(2)}),
    ],
)
def test_shapes_that_do_not_fit_name_their_argument(name, change):
    arguments = {"jacobian": J3, "direction": ONE, "lower": -ONE, "upper": ONE} | change
    with pytest.raises(InputError) as error:
        solve_hitting_speed(**arguments)
    assert error.value.argument == name
