"""Where a contact can move: rank, feasible directions, manipulability, infeasible directions."""

from itertools import product

import numpy as np
import pytest

from hitjoints.dynamics.inertia import inertia_along, inertia_and_gradient_along, inverse_inertia
from hitjoints.dynamics.kinematics import (
    feasible_directions,
    jacobian,
    manipulability,
    position,
)
from hitjoints.errors import HitjointsError, InfeasibleError
from hitjoints.model.robot import Contact
from hitjoints.tolerances import MOBILITY_FLOOR, rank_floor

BENT = np.array([0.3, 0.7, 0.2, -1.3, 0.4, 0.9, 0.1])
Z = np.array([0.0, 0.0, 1.0])


def test_straight_arm_cannot_move_its_elbow_along_itself(arm):
    robot = arm("iiwa14")
    with pytest.raises(InfeasibleError) as caught:
        inertia_along(robot, np.zeros(7), Contact(4), Z)
    error = caught.value
    assert isinstance(error, HitjointsError)
    expected = "infeasible direction: joint 4 cannot move along (0, 0, 1) in this configuration"
    assert str(error) == error.reason == expected
    assert error.data["joint"] == 4
    assert error.data["direction"] == [0, 0, 1]
    assert 0 <= error.data["mobility"] < MOBILITY_FLOOR
    with pytest.raises(InfeasibleError):
        inertia_and_gradient_along(robot, np.zeros(7), Contact(4), Z)


def test_elbow_moves_on_a_sphere(arm):
    """Joint 4 of the iiwa turns about joint 2: never along the radius, whatever the arm does."""
    robot = arm("iiwa14")
    rng = np.random.default_rng(4)
    for q in rng.uniform(robot.lower, robot.upper, (100, 7)):
        radius = position(robot, q, 4) - position(robot, q, 2)
        assert np.linalg.norm(radius) == pytest.approx(0.42, abs=1e-12)
        radius /= np.linalg.norm(radius)
        with pytest.raises(InfeasibleError, match="joint 4 cannot move"):
            inertia_along(robot, q, Contact(4), radius)
        found = feasible_directions(robot, q, 4)
        assert (found.rank, found.description) == (2, "a plane")
        np.testing.assert_allclose(radius @ found.basis, 0, atol=1e-9)
        assert not found.contain(radius)
        assert found.contain(found.basis @ [0.3, -0.8])
        assert manipulability(robot, q, 4) == pytest.approx(0, abs=1e-9)


def test_second_joint_does_not_move(arm):
    found = feasible_directions(arm("iiwa14"), BENT, 2)
    assert (found.rank, found.description) == (0, "none")
    assert found.basis.shape == (3, 0)
    assert found.speed.shape == (0,)
    assert not found.contain([1, 0, 0])
    with pytest.raises(InfeasibleError):
        inertia_along(arm("iiwa14"), BENT, Contact(2), Z)


@pytest.mark.parametrize("joint", [5, 6, 7])
def test_joints_behind_a_bent_elbow_move_everywhere(arm, joint):
    found = feasible_directions(arm("iiwa14"), BENT, joint)
    assert (found.rank, found.description) == (3, "all")
    np.testing.assert_allclose(found.basis.T @ found.basis, np.eye(3), atol=1e-14)
    assert found.contain([1, 2, 3])
    assert manipulability(arm("iiwa14"), BENT, joint) > 1e-3


def test_straight_elbow_takes_a_direction_from_joint_five(arm):
    q = BENT.copy()
    q[3] = 0
    found = feasible_directions(arm("iiwa14"), q, 5)
    assert found.rank == 2
    along = position(arm("iiwa14"), q, 5) - position(arm("iiwa14"), q, 2)
    assert not found.contain(along)


def test_a_line(arm):
    """Upright, joint 3 moves by joint 2 alone."""
    found = feasible_directions(arm("iiwa14"), np.zeros(7), 3)
    assert (found.rank, found.description) == (1, "a line")
    np.testing.assert_allclose(abs(found.basis[:, 0]), [1, 0, 0], atol=1e-12)
    assert found.speed[0] == pytest.approx(0.2045 * np.deg2rad(85), rel=1e-12)


@pytest.mark.parametrize("name", ["iiwa14", "panda", "xarm7"])
def test_speeds_are_those_of_the_best_corner_of_the_velocity_box(arm, name):
    robot = arm(name)
    found = feasible_directions(robot, robot.home, 6)
    corners = np.array(list(product((-1, 1), repeat=robot.n))) * robot.velocity_upper
    velocities = corners @ jacobian(robot, robot.home, 6).T
    np.testing.assert_allclose(found.speed, (velocities @ found.basis).max(axis=0), rtol=1e-12)
    assert (found.speed > 0).all()


@pytest.mark.parametrize("name", ["iiwa14", "iiwa7", "panda", "xarm7"])
def test_manipulability_is_yoshikawas(arm, name):
    robot = arm(name)
    rng = np.random.default_rng(6)
    for q in rng.uniform(robot.lower, robot.upper, (50, 7)):
        for contact in (5, 7, Contact(7, (0, 0, 0.1))):
            jac = jacobian(robot, q, contact)
            expected = np.sqrt(np.linalg.det(jac @ jac.T))
            assert manipulability(robot, q, contact) == pytest.approx(expected, rel=1e-7)


def test_inverse_inertia_is_singular_where_the_rank_is_short(arm):
    found = inverse_inertia(arm("iiwa14"), BENT, 4)
    values = np.linalg.eigvalsh(found)
    assert values[0] == pytest.approx(0, abs=1e-15)
    assert values[1] > 1e-3
    np.testing.assert_array_equal(found, found.T)


def test_directional_inertia_is_not_that_of_lambda(arm):
    """1 / (h^T Li h) is at most h^T Li^-1 h, and usually less: they are two quantities."""
    h = np.array([0.0, 1.0, 0.0])
    inverse = inverse_inertia(arm("iiwa14"), BENT, 6)
    inertia = inertia_along(arm("iiwa14"), BENT, Contact(6), h)
    assert inertia == pytest.approx(1 / inverse[1, 1], rel=1e-13)
    assert inertia < 0.99 * np.linalg.inv(inverse)[1, 1]


def test_an_arm_written_with_rounded_angles_has_the_rank_it_is_meant_to_have(arm):
    """xarm7's file writes pi/2 as 1.5708: its elbow leaves the sphere by 5e-7 of its motion."""
    robot = arm("xarm7")
    rng = np.random.default_rng(12)
    for q in rng.uniform(-np.pi, np.pi, (300, 7)):
        found = feasible_directions(robot, q, 4)
        assert found.rank == 2
        third = np.linalg.svd(jacobian(robot, q, 4), compute_uv=False)[2]
        assert third < rank_floor(jacobian(robot, q, 4))


def test_the_rank_is_relative_to_the_jacobian_and_the_same_for_rows():
    rng = np.random.default_rng(13)
    rows = rng.normal(size=(50, 3, 7))
    for size in (1e-2, 1.0, 1e2):
        floors = rank_floor(size * rows)
        np.testing.assert_allclose(floors, [rank_floor(size * J) for J in rows], rtol=1e-15)
        np.testing.assert_allclose(floors, 1e-6 * size * np.linalg.norm(rows, axis=(1, 2)))
    assert rank_floor(1e-16 * rows[0]) > np.linalg.norm(1e-16 * rows[0])
