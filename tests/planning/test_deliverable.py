"""The flux that a motion from rest to rest can deliver, as a quantity, an objective, a demand."""

import dataclasses

import numpy as np
import pytest
from scipy.optimize import linprog
from tasks import task

import hitjoints as hj
from hitjoints.hitting.drive_limits import drive_limits
from hitjoints.planning.objectives.hit_problem import HitProblem
from hitjoints.planning.objectives.registry import objective_named
from hitjoints.planning.planner import plan
from hitjoints.planning.search.climb import feasible

HIT = ([0.5, 0.3, 0.5], [0, 1, 0], 2.0)


def box(robot, q):
    """The greatest velocities by bisection: the way to full speed and the way to a stop fit."""
    limits = drive_limits(robot)
    a, j = limits.acceleration, limits.jerk
    room = np.minimum(q - robot.lower, robot.upper - q) * 0.98
    low, high = np.zeros(robot.n), np.array(robot.velocity_upper)
    for _ in range(60):
        middle = 0.5 * (low + high)
        fits = middle**2 / a + middle * a / j <= 2 * room
        low, high = np.where(fits, middle, low), np.where(fits, high, middle)
    return low


def referee(robot, q, joint, h, mass):
    """The deliverable flux by HiGHS."""
    J, h = hj.jacobian(robot, q, joint), np.array(h) / np.linalg.norm(h)
    across = np.linalg.svd(h[None])[2][1:]
    most = box(robot, q)
    found = linprog(-(h @ J), A_eq=across @ J, b_eq=[0, 0], bounds=np.column_stack((-most, most)))
    return -found.fun / (1 + mass / hj.directional_inertia(robot, q, joint, h))


def sluggish(robot, share=0.05):
    """The arm with drives so weak that the room to stop matters nearly everywhere."""
    return dataclasses.replace(robot, acceleration=share * robot.acceleration)


@pytest.mark.parametrize("name", ["iiwa14", "panda"])
def test_every_candidate_tells_what_can_be_delivered(arm, name):
    robot = arm(name)
    for one in plan(robot, *HIT, certificate=False).candidates:
        if one.feasible:
            expected = referee(robot, one.q, one.joint, HIT[1], HIT[2])
            assert one.deliverable_flux == pytest.approx(expected, rel=1e-6)
            assert one.deliverable_flux <= one.straight_flux
            assert one.deliverable_reason is None


@pytest.mark.parametrize("name", ["iiwa14", "panda"])
def test_derivatives(arm, name):
    robot = sluggish(arm(name))
    rng = np.random.default_rng(3)
    low, high = np.maximum(robot.lower, -3), np.minimum(robot.upper, 3)
    q = rng.uniform(low, high, (12, robot.n))
    h = np.array([0.48, 0.6, 0.64])
    asked = task(robot, robot.contact(robot.n), h, 1.7, np.array([0.4, 0.2, 0.5]), True)
    for objective, options in (("deliverable", {}), ("inertia", {"flux": 0.1})):
        problem = HitProblem(asked, objective_named(objective), deliverable=True, **options)
        x = problem.start(q)
        x[:, robot.n :] = rng.uniform(0.1, 0.5, q.shape) * np.where(x[:, robot.n :] < 0, -1, 1)
        now = problem.evaluate(x)
        for wanted, got in (("value", "gradient"), ("residual", "slope")):
            columns = []
            for i in range(x.shape[1]):
                step = np.zeros(x.shape[1])
                step[i] = 1e-6
                ends = (getattr(problem.evaluate(x + s * step), wanted) for s in (1, -1))
                columns.append((next(ends) - next(ends)) / 2e-6)
            usable = np.isfinite(now.value)
            expected = np.stack(columns, axis=-1)[usable]
            exact = getattr(now, got)[usable]
            scale = 1 + np.abs(exact).max(axis=-1, keepdims=True)
            np.testing.assert_allclose(exact / scale, expected / scale, atol=1e-7)


@pytest.mark.parametrize("name", ["iiwa14", "panda"])
def test_the_velocities_searched_are_those_of_the_program(arm, name):
    """The inequalities say what the box says, and start where the linear program ends."""
    robot = sluggish(arm(name))
    asked = task(robot, robot.contact(7), [0, 1, 0], 2.0, None, False)
    problem = HitProblem(asked, objective_named("deliverable"))
    q = np.random.default_rng(1).uniform(robot.lower, robot.upper, (40, robot.n))
    value, excess = problem.screen(q)
    at_start = problem.evaluate(problem.start(q))
    usable = (excess == 0) & np.isfinite(value)
    assert usable.sum() > 30
    assert feasible(problem, at_start.take(usable)).mean() > 0.9
    np.testing.assert_allclose(at_start.value[usable], value[usable], rtol=1e-7)
    for row, log in zip(q[usable], value[usable], strict=True):
        assert np.exp(log) == pytest.approx(referee(robot, row, 7, [0, 1, 0], 2.0), rel=1e-6)


@pytest.mark.parametrize(("name", "joint"), [("iiwa14", 7), ("panda", 6)])
def test_the_optimum_beats_every_sample_and_any_seed(arm, name, joint):
    robot = sluggish(arm(name))
    options = {"joints": [joint], "objective": "deliverable", "certificate": False}
    best = [plan(robot, *HIT, seed=seed, **options).best.deliverable_flux for seed in range(2)]
    assert best[1] == pytest.approx(best[0], rel=2e-4)
    straight = plan(robot, *HIT, **(options | {"objective": "straight-flux"})).best
    assert straight.deliverable_flux <= best[0] * (1 + 1e-6)
    assert straight.straight_flux > 1.1 * best[0]  # it is another question
    placed = hj.place_joint(robot, joint, np.tile(HIT[0], (300, 1)), seed=5)
    behind = [
        q
        for q in placed.q[placed.solved]
        if (hj.position(robot, q, robot.beyond(robot.contact(joint))) - HIT[0]) @ HIT[1] < 0
    ]
    most = max(referee(robot, q, joint, HIT[1], HIT[2]) for q in behind)
    assert most <= best[0] * (1 + 1e-6)


@pytest.mark.parametrize("objective", ["inertia", "rebound", "straight-flux", "deliverable"])
def test_a_flux_that_a_motion_can_deliver(arm, objective):
    robot = arm("iiwa14")
    options = {"joints": [7], "certificate": False}
    most = plan(robot, *HIT, objective="deliverable", **options).best.deliverable_flux
    for flux in (0.9 * most, most):
        one = plan(robot, *HIT, objective=objective, flux=flux, deliverable=True, **options).best
        assert one.deliverable_flux >= flux * (1 - 1e-6)
    refused = plan(
        robot, *HIT, objective=objective, flux=1.001 * most, deliverable=True, **options
    ).candidates[0]
    assert "from rest to rest" in refused.reason
    assert refused.evidence["nearest"]["flux"] == pytest.approx(most, rel=1e-4)


def test_unknown_accelerations_are_said(arm):
    robot = arm("xarm7")
    one = plan(robot, *HIT, joints=[6], certificate=False).candidates[0]
    assert one.deliverable_flux is None
    assert "xarm7 are not known" in one.deliverable_reason
    for options in ({"objective": "deliverable"}, {"flux": 0.2, "deliverable": True}):
        with pytest.raises(hj.InputError, match="acceleration"):
            plan(robot, *HIT, joints=[6], **options)
