"""The authors' stack, written again, is an independent check of the controller too."""

import numpy as np
import pytest

import hitjoints as hj
from benchmarks.control import walk
from benchmarks.peers.control_step import PyBulletStep
from benchmarks.peers.osqp import OsqpInPlace, QpSolvers
from hitjoints.rollouts.prepare import prepare

pytest.importorskip("pybullet")
pytest.importorskip("qpsolvers")
pytest.importorskip("osqp")


@pytest.mark.parametrize("solver", [QpSolvers, OsqpInPlace])
@pytest.mark.parametrize("share", [0.5, 1.05])
def test_the_authors_stack_makes_the_same_steps(arm, solver, share):
    """Beyond the straight maximum (share > 1) limits are active: both programs matter."""
    robot, mass, rng = arm("iiwa14"), 2.0, np.random.default_rng(0)
    at, h = np.array([0.5, 0.3, 0.5]), np.array([0.0, 1.0, 0.0])
    found = prepare(robot, hj.Hit(6, at, h, mass, 0.3))
    most = hj.hitting_speed(robot, found.q_hit, 6, h, straight=True)
    flux = hj.hitting_flux(hj.directional_inertia(robot, found.q_hit, 6, h), mass, most)
    controller = hj.Controller(robot, hj.Hit(6, at, h, mass, share * flux), found.q_hit, dt=0.005)
    # Beside the line too, where the field has its other term.
    path = [q + rng.normal(0, 0.02, robot.n) for q in walk(controller, found.q0)[0]]
    ours = np.array([controller.step(q) for q in path])
    limited = ((ours <= robot.velocity_lower) | (ours >= robot.velocity_upper)).any()
    assert limited == (share > 1)
    step = PyBulletStep(robot, controller.hit, 6, controller.posture, 0.005, solver)
    np.testing.assert_allclose([step(q) for q in path], ours, atol=1e-4)


def test_the_steps_are_the_same_where_the_inertia_is_steep(arm):
    """There the gain is cut, so that one step does not overshoot."""
    robot, h = arm("iiwa14"), np.array([0.0, 1.0, 0.0])
    drawn = np.random.default_rng(5).uniform(robot.lower, robot.upper, (20, robot.n))
    gradients = hj.directional_inertia_gradient(robot, drawn, 6, h)
    steep = drawn[(gradients**2).sum(axis=1) > 200]
    assert len(steep) > 3
    hit = hj.Hit(6, np.array([0.5, 0.3, 0.5]), h, 2.0, 0.05)
    controller = hj.Controller(robot, hit, robot.home, dt=0.005)
    step = PyBulletStep(robot, hit, 6, controller.posture, 0.005, QpSolvers)
    for q in steep:
        np.testing.assert_allclose(step(q), controller.step(q), atol=1e-4)
