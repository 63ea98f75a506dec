from __future__ import annotations

import numpy as np
import pytest

import hitjoints as hj
from hitjoints.dynamics.kinematics import jacobian, position
from hitjoints.errors import InfeasibleError, InputError
from hitjoints.hitting.field import HittingField
from hitjoints.model.robot import Contact
from hitjoints.planning.start import (
    OFF_THE_LINE,
    SETTLED,
    approach_path,
    fastest_start,
    plan_start,
)

Y = np.array([0.0, 1.0, 0.0])


@pytest.mark.parametrize("name", ["iiwa14", "panda", "xarm7"])
@pytest.mark.parametrize("joint", [5, 6, 7])
def test_the_path_is_straight_timed_and_within_the_limits(arm, name, joint):
    robot = arm(name)
    start = plan_start(robot, robot.home, joint, Y, 0.6, lateral=0.02)
    assert start.feasible
    assert start.reason == ""
    assert (start.path >= robot.lower).all()
    assert (start.path <= robot.upper).all()
    np.testing.assert_array_equal(start.path[-1], robot.home)
    np.testing.assert_array_equal(start.path[0], start.q)
    points = np.array([position(robot, q, joint) for q in start.path])
    expected = points[-1] - 0.6 * (start.times[-1] - start.times)[:, None] * Y
    assert np.abs(points - expected).max() < OFF_THE_LINE
    np.testing.assert_allclose(points[0], start.position)
    assert start.run_up == pytest.approx(0.6 * start.times[-1])
    rates = np.diff(start.path, axis=0) / np.diff(start.times)[:, None]
    ratio = np.max(np.where(rates > 0, rates / robot.velocity_upper, rates / robot.velocity_lower))
    assert ratio <= 1.0
    assert start.velocity_ratio_max == pytest.approx(ratio, rel=1e-6)
    last = jacobian(robot, robot.home, joint) @ rates[-1]
    np.testing.assert_allclose(last, 0.6 * Y, atol=0.02)


def test_the_default_run_up_settles_the_lateral_error(arm):
    robot = arm("iiwa14")
    start = plan_start(robot, robot.home, 7, Y, 0.7, lateral=0.015)
    here = position(robot, robot.home, 7)
    field = HittingField(here, 0.7 * Y)
    assert start.run_up == pytest.approx(field.distance_to_settle(0.015, 0.99 * SETTLED))
    assert start.lateral_miss <= SETTLED
    aside = start.position + 0.015 * np.array([0.6, 0.0, 0.8])
    assert field.predicted_miss(aside) == pytest.approx(start.lateral_miss, rel=1e-3)
    assert plan_start(robot, robot.home, 7, Y, 0.7).lateral_miss < 1e-9


def test_a_run_up_too_short_for_the_lateral_error(arm):
    robot = arm("iiwa14")
    start = plan_start(robot, robot.home, 7, Y, 0.7, run_up=0.03, lateral=0.02)
    assert not start.feasible
    assert start.run_up == pytest.approx(0.03)
    assert SETTLED < start.lateral_miss < 0.02
    assert "lateral error of 0.02 m" in start.reason


def test_it_ends_where_the_arm_is_stretched(urdf):
    # x = 0.3 + 0.6 cos a with q = (a, -2 a): backwards the arm stretches. a' = v / (0.6 sin a)
    # reaches 1 rad/s (2 rad/s of joint 2, its limit) at sin a = v / 0.6.
    robot, tip, speed = urdf.load(urdf.two_links()), Contact(2, (0.3, 0, 0)), 0.06
    start = plan_start(robot, [0.5, -1.0], tip, [-1, 0, 0], speed, run_up=0.2, dt=0.001)
    longest = 0.6 * (np.sqrt(1 - (speed / 0.6) ** 2) - np.cos(0.5))
    assert not start.feasible
    assert start.run_up == pytest.approx(longest, abs=2 * speed * 0.001)
    assert "too little to go on at 0.06 m/s" in start.reason
    assert 0.98 < start.velocity_ratio_max <= 1.0


def test_it_ends_at_a_position_limit_and_names_the_joint(urdf):
    # Backwards is inwards here: joint 2 folds until it stands at -1 rad, its limit, exactly.
    robot, tip = urdf.load(urdf.two_links()), Contact(2, (0.3, 0, 0))
    start = plan_start(robot, [0.4, -0.8], tip, [1, 0, 0], 0.05, run_up=0.2, dt=0.001)
    assert not start.feasible
    assert start.run_up == pytest.approx(0.6 * (np.cos(0.4) - np.cos(0.5)), abs=2 * 0.05 * 0.001)
    assert "joint 2 at" in start.reason
    assert (np.abs(start.path) <= 1.0).all()


def test_a_speed_out_of_reach_leaves_no_run_up(arm):
    robot = arm("iiwa14")
    start = plan_start(robot, robot.home, 7, Y, 50.0)
    assert not start.feasible
    assert start.run_up == 0.0
    assert start.path.shape == (1, 7)
    assert start.velocity_ratio_max == 0.0
    assert "too little to go on at 50 m/s" in start.reason


def test_a_direction_the_arm_cannot_move_in(urdf):
    start = plan_start(urdf.load(urdf.two_links()), [0.5, -1.0], 2, [0, 0, 1], 0.1)
    assert not start.feasible
    assert start.run_up == 0.0


def test_the_null_space_keeps_joints_in_the_middle(arm):
    robot = arm("iiwa14")
    q = robot.home.copy()
    path, reason = approach_path(robot, q, robot.contact(5), Y, 0.2)
    assert not reason
    q_far = robot.home.copy()
    q_far[6] = 3.0  # joint 7 does not move the point: it is free to return
    path, _ = approach_path(robot, q_far, robot.contact(5), Y, 0.2)
    assert abs(path[0, 6]) < 2.6


@pytest.mark.parametrize(
    ("argument", "change"),
    [
        ("speed", {"speed": 0.0}),
        ("speed", {"speed": np.nan}),
        ("dt", {"dt": 0.0}),
        ("run_up", {"run_up": -0.1}),
        ("lateral", {"lateral": -0.1}),
        ("lateral", {"lateral": np.inf}),
        ("direction", {"direction": [0, 0, 0]}),
        ("q", {"q": np.full(7, 4.0)}),
        ("joint", {"contact": 0}),
    ],
)
def test_bad_arguments_are_named(arm, argument, change):
    robot = arm("iiwa14")
    given = {"q": robot.home, "contact": 7, "direction": Y, "speed": 0.5} | change
    with pytest.raises(InputError) as caught:
        plan_start(robot, **given)
    assert caught.value.argument == argument


def test_fastest_start_cannot_be_made_much_faster(arm):
    robot = arm("iiwa14")
    start = fastest_start(robot, robot.home, 6, [0, 1, 0])
    assert start.feasible
    assert start.velocity_ratio_max <= 1
    top = hj.hitting_speed(robot, robot.home, 6, [0, 1, 0], straight=True)
    assert 0 < start.speed < top
    faster = plan_start(robot, robot.home, 6, [0, 1, 0], start.speed + 0.2 * top)
    assert not faster.feasible


def test_no_start_where_the_joint_cannot_move(arm):
    with pytest.raises(InfeasibleError, match="joint 2"):
        fastest_start(arm("iiwa14"), arm("iiwa14").home, 2, [0, 1, 0])


def test_continuous_joints_have_no_middle():
    """Infinite limits must not be averaged: no warning, no nan."""
    import warnings

    with warnings.catch_warnings():
        warnings.simplefilter("error")
        robot = hj.load_robot("kinova")
        start = fastest_start(robot, robot.home, robot.n, [0, 1, 0])
    assert np.isfinite(start.path).all()
