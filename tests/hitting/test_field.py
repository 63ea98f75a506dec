from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad, solve_ivp

from hitjoints.errors import InfeasibleError, InputError
from hitjoints.hitting.field import HittingField

TARGET, VELOCITY = np.array([0.5, 0.1, 0.4]), np.array([0.3, 0.8, -0.2])
TILTED = np.array([[-12.0, 3.0, 1.0], [3.0, -20.0, 2.0], [1.0, 2.0, -8.0]])
numbers = st.floats(-1.0, 1.0)
vectors = st.tuples(numbers, numbers, numbers).map(np.array)


def across(field):
    return np.linalg.svd(field.direction[None, :])[2][1]


@pytest.fixture(params=["paper", "constant"])
def profile(request):
    return request.param


def test_on_the_line_it_is_the_desired_velocity(profile):
    field = HittingField(TARGET, VELOCITY, speed_profile=profile)
    np.testing.assert_allclose(field(TARGET - 0.3 * VELOCITY), VELOCITY, atol=1e-12)


def test_equation_5_written_out():
    field = HittingField(TARGET, VELOCITY, 0.05, TILTED)
    x = np.array([0.45, -0.2, 0.5])
    s = (x - TARGET) @ VELOCITY / (VELOCITY @ VELOCITY)
    virtual = TARGET + s * VELOCITY
    alpha = np.exp(-np.linalg.norm(x - virtual) / 0.05)
    np.testing.assert_allclose(field.virtual(x), virtual)
    np.testing.assert_allclose(field(x), alpha * VELOCITY + (1 - alpha) * TILTED @ (x - virtual))
    assert field.lateral_error(x) == pytest.approx(np.linalg.norm(x - virtual))


@given(vectors, vectors)
def test_the_lateral_error_decreases_everywhere_off_the_line(x, v):
    if np.linalg.norm(v) < 1e-3:
        return
    for profile in ("paper", "constant"):
        field = HittingField(TARGET, v, 0.05, TILTED, profile)
        error = x - field.virtual(x)
        if np.linalg.norm(error) > 1e-6:
            assert error @ field(x) < 0


@given(vectors)
def test_the_constant_profile_has_one_speed(x):
    field = HittingField(TARGET, VELOCITY, 0.05, TILTED, "constant")
    assert np.linalg.norm(field(x)) == pytest.approx(np.linalg.norm(VELOCITY), rel=1e-12)


def test_trajectories_converge_to_the_line_and_reach_the_plane(profile):
    field = HittingField(TARGET, VELOCITY, 0.05, TILTED, profile)
    start = TARGET - 2.0 * VELOCITY + 0.2 * across(field)
    path = solve_ivp(lambda _, x: field(x), (0, 20), start, rtol=1e-9, atol=1e-12).y.T
    errors = np.array([field.lateral_error(x) for x in path])
    assert (np.diff(errors) < 1e-12).all()
    assert errors[-1] < 2e-3


def test_the_error_obeys_its_own_equation():
    a, sigma, e0 = 15.0, 0.04, 0.1
    field = HittingField(TARGET, VELOCITY, sigma, -a * np.eye(3))
    start = TARGET - VELOCITY + e0 * across(field)
    times = np.linspace(0, 1.5, 40)

    def solved(rate, at, size):
        options = {"rtol": 1e-11, "atol": 1e-13}
        return solve_ivp(rate, (0, 1.5), at, t_eval=times, **options).y.T.reshape(-1, size)

    path = solved(lambda _, x: field(x), start, 3)
    alone = solved(lambda _, e: -a * (1 - np.exp(-e / sigma)) * e, [e0], 1)[:, 0]
    measured = [field.lateral_error(x) for x in path]
    np.testing.assert_allclose(measured, alone, rtol=1e-6)


def test_the_predicted_miss_is_where_the_streamline_crosses(profile):
    field = HittingField(TARGET, VELOCITY, 0.03, TILTED, profile)
    start = TARGET - 0.4 * VELOCITY + 0.05 * across(field)

    def crossing(_, x):
        return (x - TARGET) @ VELOCITY

    crossing.terminal = True
    end = solve_ivp(lambda _, x: field(x), (0, 50), start, events=crossing, rtol=1e-10, atol=1e-12)
    assert field.predicted_miss(start) == pytest.approx(
        field.lateral_error(end.y_events[0][0]), abs=2e-6
    )


def test_a_start_on_the_line_does_not_miss():
    field = HittingField(TARGET, VELOCITY)
    assert field.predicted_miss(TARGET - 0.3 * VELOCITY) < 1e-12
    assert field.predicted_miss(TARGET) == 0.0


@pytest.mark.parametrize(("sigma", "lateral"), [(0.01, 0.02), (0.05, 0.03), (0.01, 0.4)])
def test_the_settling_distance_is_what_the_streamline_needs(sigma, lateral):
    field = HittingField(TARGET, VELOCITY, sigma, -20 * np.eye(3))
    distance = field.distance_to_settle(lateral, 2e-3)
    integral = quad(lambda e: 1 / (e * np.expm1(e / sigma)), 2e-3, lateral, epsrel=1e-10)[0]
    assert distance == pytest.approx(field.speed / 20 * integral, rel=1e-8)
    if lateral < 0.1:  # from far away the paper's field all but stands still along the line
        start = TARGET - distance * field.direction + lateral * across(field)
        assert field.predicted_miss(start) == pytest.approx(2e-3, rel=1e-4)
    assert field.distance_to_settle(1e-3, 2e-3) == 0.0


def test_a_slow_direction_of_A_decides_the_settling_distance():
    even = HittingField(TARGET, [0, 1, 0], A=np.diag([-5.0, -5.0, -5.0]))
    mixed = HittingField(TARGET, [0, 1, 0], A=np.diag([-50.0, -1.0, -5.0]))
    slowest = even.distance_to_settle(0.02, 2e-3)
    assert mixed.distance_to_settle(0.02, 2e-3) == pytest.approx(slowest)


@pytest.mark.parametrize(
    ("name", "change"),
    [
        ("target", {"target": [0, 0]}),
        ("target", {"target": [[0, 0, 0]]}),
        ("target", {"target": [0, np.nan, 0]}),
        ("velocity", {"velocity": [0, 0, 0]}),
        ("sigma", {"sigma": 0.0}),
        ("sigma", {"sigma": np.inf}),
        ("sigma", {"sigma": "wide"}),
        ("A", {"A": np.eye(3)}),
        ("A", {"A": -np.eye(2)}),
        ("A", {"A": [[-1, 0.1, 0], [0, -1, 0], [0, 0, -1]]}),
        ("A", {"A": np.diag([-1.0, -1.0, 0.0])}),
        ("speed_profile", {"speed_profile": "fast"}),
    ],
)
def test_bad_arguments_are_named(name, change):
    with pytest.raises(InputError) as caught:
        HittingField(**({"target": TARGET, "velocity": VELOCITY} | change))
    assert caught.value.argument == name


def test_questions_without_an_answer():
    field = HittingField(TARGET, VELOCITY)
    with pytest.raises(InputError, match="beyond the target"):
        field.predicted_miss(TARGET + 0.1 * VELOCITY)
    with pytest.raises(InputError, match="tolerance"):
        field.distance_to_settle(0.1, 0.0)
    with pytest.raises(InputError, match="lateral"):
        field.distance_to_settle(-0.1, 1e-3)
    with pytest.raises(InputError, match="position"):
        field([0, 0, np.inf])
    leaning = np.array([[-1.0, 0.0, 0.0], [0.0, -1.0, 0.95], [0.0, 0.95, -1.0]])
    backward = HittingField([0, 0, 0], [0, 0, 1e-3], 1e-3, leaning)
    with pytest.raises(InfeasibleError, match="does not bring"):
        backward.predicted_miss([0.0, -50.0, -1e-3])


@pytest.mark.parametrize("aside", [0.0, 0.02])
def test_a_start_on_the_plane_of_the_target_misses_by_where_it_is(aside):
    field = HittingField((0.0, 0.0, 0.0), (0.0, 1.0, 0.0))
    assert field.predicted_miss((aside, 0.0, 0.0)) == pytest.approx(aside)
