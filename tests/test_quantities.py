"""The public quantities: one configuration through Pinocchio, rows through the kernels."""

import numpy as np
import pytest

import hitjoints as hj

H = np.array([0.3, -0.8, 0.5])


@pytest.fixture(scope="module", params=["iiwa14", "panda"])
def robot(request):
    return hj.load_robot(request.param)


@pytest.fixture(scope="module")
def rows(robot):
    return np.random.default_rng(0).uniform(robot.lower, robot.upper, (23, robot.n))


@pytest.mark.parametrize("contact", [5, 7, hj.Contact(6, (0.02, 0.05, -0.03))])
@pytest.mark.parametrize("per_row", [False, True])
def test_rows_agree_with_single_configurations(robot, rows, contact, per_row):
    h = np.random.default_rng(1).normal(size=(23, 3)) if per_row else H
    each = h if per_row else [H] * 23
    for function, tolerance in (
        (hj.directional_inertia, 1e-11),
        (hj.directional_inertia_gradient, 1e-9),
        (hj.hitting_speed, 1e-12),
        (lambda *a: hj.hitting_speed(*a, straight=True), 1e-9),
    ):
        batch = function(robot, rows, contact, h)
        single = np.array([function(robot, q, contact, d) for q, d in zip(rows, each, strict=True)])
        assert batch.shape == single.shape
        scale = np.abs(single).max(axis=-1, keepdims=True)
        assert (np.abs(batch - single) / scale).max() < tolerance


def test_scalars_for_one_configuration(robot):
    assert isinstance(hj.directional_inertia(robot, robot.home, 6, H), float)
    assert isinstance(hj.hitting_speed(robot, robot.home, 6, H), float)
    assert isinstance(hj.hitting_speed(robot, robot.home, 6, H, straight=True), float)
    assert hj.directional_inertia_gradient(robot, robot.home, 6, H).shape == (robot.n,)


def test_infeasible_rows_hold_the_limits():
    robot = hj.load_robot("iiwa14")
    rows = np.array([robot.home, np.zeros(7)])
    up = [0, 0, 1]
    inertia = hj.directional_inertia(robot, rows, 4, up)
    assert np.isfinite(inertia[0])
    assert inertia[1] == np.inf
    gradient = hj.directional_inertia_gradient(robot, rows, 4, up)
    assert np.isnan(gradient[1]).all()
    speed = hj.hitting_speed(robot, rows, 4, up)
    assert speed[1] == 0
    assert hj.hitting_flux(inertia, 2.0, speed)[1] == 0
    with pytest.raises(hj.InfeasibleError, match="infeasible direction"):
        hj.directional_inertia(robot, rows[1], 4, up)


@pytest.mark.parametrize(
    ("q", "direction", "message"),
    [
        (np.zeros((4, 6)), H, "7 joint positions"),
        (np.zeros((2, 2, 7)), H, "shape"),
        (np.full((4, 7), np.nan), H, "finite"),
        (np.zeros((4, 7)), np.ones((3, 3)), "direction = 3 rows: one direction, or 4"),
        (np.zeros(7), np.ones((1, 3)), "one direction"),
        (np.zeros((4, 7)), np.zeros((4, 3)), "must not be zero"),
    ],
)
def test_bad_rows(q, direction, message):
    robot = hj.load_robot("iiwa14")
    for function in (hj.directional_inertia, hj.directional_inertia_gradient, hj.hitting_speed):
        with pytest.raises(hj.InputError, match=message):
            function(robot, q, 6, direction)


def test_place_joint(robot):
    targets = np.array([hj.position(robot, robot.home, 6), [3.0, 0, 0]])
    placed = hj.place_joint(robot, 6, targets, seed=4)
    assert placed.solved.tolist() == [True, False]
    assert placed.error[0] <= 1e-9
    assert placed.error[1] > 1
    np.testing.assert_allclose(hj.position(robot, placed.q[0], 6), targets[0], atol=1e-9)
    assert (placed.q >= robot.lower).all()
    assert (placed.q <= robot.upper).all()
    again = hj.place_joint(robot, 6, targets, seed=4, threads=1)
    np.testing.assert_array_equal(placed.q, again.q)
    other = hj.place_joint(robot, 6, targets, seed=5)
    assert not np.array_equal(placed.q[0], other.q[0])


def test_place_joint_starts_where_it_is_told(robot):
    target = hj.position(robot, robot.home, 6) + np.array([0.01, 0, 0])
    near = hj.place_joint(robot, 6, target, start=robot.home)
    assert np.abs(near.q[0] - robot.home).max() < 0.1
    np.testing.assert_array_equal(near.q[0, 5:], robot.home[5:])


@pytest.mark.parametrize(
    ("targets", "options", "message"),
    [
        ([0.5, 0.3], {}, "positions"),
        ([0.5, np.inf, 0.3], {}, "finite"),
        ([0.5, 0.3, 0.4], {"start": np.zeros(3)}, "start"),
        ([0.5, 0.3, 0.4], {"start": np.zeros((2, 7))}, "start = 2 rows"),
        ([0.5, 0.3, 0.4], {"threads": 0}, "threads"),
    ],
)
def test_place_joint_bad_input(robot, targets, options, message):
    with pytest.raises(hj.InputError, match=message):
        hj.place_joint(robot, 6, targets, **options)


def test_numpy_back_end_by_environment(robot, rows, monkeypatch):
    from hitjoints import built

    fast = hj.directional_inertia(robot, rows, 6, H)
    monkeypatch.setenv("HITJOINTS_BACKEND", "numpy")
    built._kernel.cache_clear()
    plain = hj.directional_inertia(robot, rows, 6, H)
    built._kernel.cache_clear()
    np.testing.assert_allclose(plain, fast, rtol=1e-12)
