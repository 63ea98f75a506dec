"""Of many equal angles the one near home is answered, and far limits are no place to look."""

import re

import numpy as np
import pytest

import hitjoints as hj
from hitjoints.dynamics.kinematics import position
from hitjoints.kernels.ik_starts import start_range
from hitjoints.loading.load import load_robot
from hitjoints.model.turns import TURN, middle, nearest_turn, search_range

UR5 = "ur5_robot"


def test_the_nearest_turn_is_the_nearest_that_the_limits_allow():
    rng = np.random.default_rng(0)
    for _ in range(300):
        lower = rng.uniform(-40, 0)
        upper = lower + rng.uniform(0.1, 60)
        home, q = rng.uniform(lower, upper, 2)
        found = nearest_turn(*(np.array([v]) for v in (q, lower, upper, home)), np.array([True]))
        every = q + TURN * np.arange(-20, 21)
        allowed = every[(every >= lower) & (every <= upper)]
        nearest = allowed[np.abs(allowed - home).argmin()]
        assert abs(found[0] - home) == pytest.approx(abs(nearest - home), abs=1e-9)
        assert lower <= found[0] <= upper


def test_what_slides_and_what_turns_less_than_once_stays():
    q = np.array([[5.0, -3.0], [0.1, 3.0]])
    ends = np.array([-8.0, -3.1]), np.array([8.0, 3.1])
    same = nearest_turn(q, *ends, np.zeros(2), np.array([False, True]))
    np.testing.assert_array_equal(same, q)
    free = np.full(2, -np.inf), np.full(2, np.inf)
    turned = nearest_turn(q, *free, np.zeros(2), np.array([True, True]))
    np.testing.assert_allclose(turned, [[5 - TURN, -3], [0.1, 3]])


LIMITS = [
    # lower, upper, home, where to look
    (-np.inf, np.inf, 0, (-np.pi, np.pi)),
    (-np.inf, np.inf, 2, (2 - np.pi, 2 + np.pi)),
    (-1e6, 1e6, 0, (-np.pi, np.pi)),
    (-1.7976931348623157e308, 1.7976931348623157e308, 0, (-np.pi, np.pi)),
    (-0.5, 1e6, 0, (-0.5, TURN - 0.5)),
    (-1e6, 0.5, 0, (0.5 - TURN, 0.5)),
    (-TURN, TURN, 0, (-TURN, TURN)),
    (-2, 3, 1, (-2, 3)),
]


@pytest.mark.parametrize(("lower", "upper", "home", "expected"), LIMITS)
def test_one_turn_around_home_is_looked_at_where_limits_are_far(lower, upper, home, expected):
    ends = [np.array([float(v)]) for v in (lower, upper, home)]
    low, high = search_range(*ends, np.array([True]))
    np.testing.assert_allclose([low[0], high[0]], expected, atol=1e-9)
    if home == 0:
        np.testing.assert_allclose(start_range(lower, upper, False), expected, atol=1e-9)


def test_the_usual_home_is_near_zero_where_limits_are_far():
    lower, upper = np.array([-1e6, 5, -np.inf, -1.0, 0]), np.array([2e6, 1e5, np.inf, 2.0, 3])
    turning = np.array([True, True, True, True, False])
    np.testing.assert_array_equal(middle(lower, upper, turning), [0, 5, 0, 0.5, 1.5])


@pytest.mark.parametrize("limit", ["1e6", "1e3", "12.6"])
def test_far_limits_place_a_joint_as_near_limits_do(urdf, limit):
    text = load_robot(UR5).xml
    far = f'upper="{limit}" lower="-{limit}"'
    wide = re.sub(r'lower="[^"]*" upper="[^"]*"', far, text)
    assert wide != text
    robot, usual = load_robot(wide), load_robot(UR5)
    rng = np.random.default_rng(0)
    q = rng.uniform(-np.pi, np.pi, (50, 6))
    targets = np.array([position(usual, row, 6) for row in q])
    placed = hj.place_joint(robot, 6, targets)
    assert placed.solved.all()
    assert np.abs(placed.q - robot.home).max() <= np.pi + 1e-9
    for row, target in zip(placed.q, targets, strict=True):
        np.testing.assert_allclose(position(robot, row, 6), target, atol=2e-9)


def test_plans_answer_the_turn_nearest_to_home():
    robot = load_robot(UR5)
    for at in ([0.4, 0.2, 0.4], [0.3, -0.4, 0.5]):
        planned = hj.plan(robot, at, [0, 1, 0], 1.0, joints=[5], certificate=False)
        q = planned.best.q
        assert np.abs(q - robot.home).max() <= np.pi + 1e-9
        posture = hj.posture(robot, q, 5, [0, 1, 0])
        assert np.abs(posture.q - robot.home).max() <= np.pi + 1e-9
        np.testing.assert_array_equal(posture.q[:4], q[:4])


def test_a_start_is_left_where_it_is():
    """Who gives a start wants to move from there: it is not turned away from it."""
    robot = load_robot(UR5)
    start = np.array([4.5, -1.0, 1.2, 4.0, 0.8, 0.0])
    target = position(robot, start, 6) + np.array([0.01, 0, 0])
    placed = hj.place_joint(robot, 6, target, start=start)
    assert np.abs(placed.q[0] - start).max() < 1


def test_the_origin_beyond_is_the_next_that_does_not_coincide(arm):
    iiwa, panda, xarm = arm("iiwa14"), arm("panda"), arm("xarm7")
    assert [iiwa.beyond(hj.Contact(k)).joint for k in (5, 6)] == [6, 7]
    assert iiwa.beyond(hj.Contact(7)) == iiwa.flange
    # Joints 1 and 2, and 5 and 6, of the Panda have their origins in one place each.
    assert [panda.beyond(hj.Contact(k)).joint for k in range(1, 7)] == [3, 3, 4, 5, 7, 7]
    assert panda.beyond(hj.Contact(7)) == panda.flange
    for robot in (iiwa, panda, xarm):
        rng = np.random.default_rng(0)
        for k in range(1, robot.n):
            beyond = robot.beyond(hj.Contact(k))
            for q in rng.uniform(robot.lower, robot.upper, (5, robot.n)):
                here = position(robot, q, k)
                assert np.linalg.norm(position(robot, q, beyond) - here) > 1e-3
                for between in range(k + 1, beyond.joint):
                    assert np.linalg.norm(position(robot, q, between) - here) < 1e-9


def test_a_sliding_joint_does_not_coincide(urdf):
    robot = urdf.load(
        urdf.base, urdf.link("link_1"), urdf.link("link_2"),
        urdf.joint("joint_1", "base", "link_1"),
        urdf.joint("joint_2", "link_1", "link_2", "prismatic", at="0 0 0"),
    )  # fmt: skip
    assert robot.beyond(hj.Contact(1)) == hj.Contact(2)
    np.testing.assert_array_equal(robot.turning, [True, False])


def test_the_panda_hits_with_joint_5_pointing_away(arm):
    """Its origins 5 and 6 coincide, which once left no posture that points away."""
    planned = hj.plan(arm("panda"), [0.45, 0.1, 0.5], [0, 1, 0], 1.0, joints=[5], certificate=False)
    assert planned.best.away
    q = planned.best.q
    gap = position(arm("panda"), q, 7) - position(arm("panda"), q, 5)
    assert gap @ [0, 1, 0] == pytest.approx(planned.best.away_gap)
    assert planned.best.away_gap < 0
