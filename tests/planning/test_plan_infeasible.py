"""A no has a reason and the nearest value that would do."""

import numpy as np
import pytest
from tasks import task

import hitjoints as hj
from hitjoints.model.robot import Contact
from hitjoints.planning.planner import plan
from hitjoints.planning.proof.exclusion import exclude

POSITION, DIRECTION, MASS = [0.5, 0.3, 0.5], [0, 1, 0], 2.0


def refuse(robot, position=POSITION, direction=DIRECTION, **options):
    found = plan(robot, position, direction, MASS, **options)
    assert found.best is None
    return found.candidates


def test_out_of_reach_is_certified(arm):
    for one in refuse(arm("iiwa14"), [1.5, 0.3, 0.5]):
        assert one.evidence["certified"]
        assert "unreachable" in one.reason
        # Stretched out, the joint is as far as this from the shoulder at (0, 0, 0.36).
        stretched = np.linalg.norm(hj.position(arm("iiwa14"), np.zeros(7), one.joint)[2] - 0.36)
        away = np.linalg.norm([1.5, 0.3, 0.14])
        assert away - stretched - 0.01 < one.position_error < away
        q = one.evidence["nearest"]["q"]
        error = np.linalg.norm(hj.position(arm("iiwa14"), q, one.joint) - [1.5, 0.3, 0.5])
        assert error == pytest.approx(one.position_error)


def test_too_close_is_excluded_box_by_box(arm):
    (one,) = refuse(arm("iiwa14"), [0, 0, 0.36], joints=[5])
    assert "boxes" in one.reason
    assert one.evidence["certified"]
    (one,) = refuse(arm("iiwa14"), [0, 0, 0.36], joints=[5], certificate=False)
    assert "inverse kinematics" in one.reason
    assert not one.evidence["certified"]


def test_nothing_that_exists_is_excluded(arm):
    robot, rng = arm("iiwa14"), np.random.default_rng(0)
    for q in rng.uniform(robot.lower, robot.upper, (10, robot.n)):
        h = hj.position(robot, q, 5) - hj.position(robot, q, 6)
        h /= np.linalg.norm(h)
        asked = task(robot, Contact(5), h, 2.0, hj.position(robot, q, 5), True)
        assert not exclude(asked, away=True).proved
        assert not exclude(asked, away=False).proved


def test_a_joint_that_does_not_move(arm):
    (one,) = refuse(arm("iiwa14"), joints=[1])
    assert "cannot move at all" in one.reason


def test_infeasible_direction(arm):
    # The elbow turns on a sphere about the shoulder: not along the line through both.
    robot = arm("iiwa14")
    elbow = hj.position(robot, [0.4, 0.8, 0, -1.0, 0, 0, 0], 4)
    radial = elbow - [0, 0, 0.36]
    (one,) = refuse(robot, elbow, radial, joints=[4], away=False)
    assert "infeasible direction" in one.reason
    assert "rank 2" in one.reason
    tangent = np.cross(radial, [0, 0, 1]) + 0.3 * radial
    best = plan(robot, elbow, tangent, MASS, joints=[4], away=False).best
    assert best is not None


def test_away_condition_of_two_joints_at_one_point(arm):
    """Nothing of the xArm 7 lies beyond its last joint: its flange is where that is."""
    robot = arm("xarm7")
    (one,) = refuse(robot, [0.4, 0.2, 0.4], joints=[7])
    assert "the origins of joint 7 and the flange coincide" in one.reason
    assert one.evidence["certified"]


def test_least_gap_is_the_least(arm):
    robot = arm("iiwa14")
    (one,) = refuse(robot, joints=[5])
    assert one.evidence["certified"]
    gap, h = one.evidence["nearest"]["away_gap"], np.array(DIRECTION)
    q = hj.place_joint(robot, 5, np.tile(POSITION, (500, 1)), seed=5).q
    gaps = [h @ (hj.position(robot, x, 6) - hj.position(robot, x, 5)) for x in q]
    assert 0 < gap <= min(gaps) + 1e-9
    assert gap > min(gaps) - 0.02


def test_flux_beyond_the_maximum(arm):
    robot = arm("iiwa14")
    most = plan(robot, POSITION, DIRECTION, MASS, joints=[6], objective="flux").best.flux
    (one,) = refuse(robot, joints=[6], objective="rebound", flux=1.01 * most)
    assert "flux beyond the maximum" in one.reason
    assert one.evidence["nearest"]["flux"] == pytest.approx(most, rel=1e-4)
    assert plan(
        robot, POSITION, DIRECTION, MASS, joints=[6], objective="rebound", flux=0.999 * most
    ).best
