"""Objectives, constraints and the climb: exact derivatives, exact bounds."""

import dataclasses

import numpy as np
import pytest
from tasks import task

import hitjoints as hj
from hitjoints.built import chain_of
from hitjoints.errors import KernelMismatchError
from hitjoints.kernels.formulas.links import TracedArm
from hitjoints.kernels.tape.backends import VARIABLE
from hitjoints.model.robot import Contact
from hitjoints.planning.objectives import problem_program
from hitjoints.planning.objectives.farthest_away import FarthestAway
from hitjoints.planning.objectives.hit_problem import HitProblem
from hitjoints.planning.objectives.registry import objective_named
from hitjoints.planning.objectives.straight import straight_velocities
from hitjoints.planning.objectives.traced_hit import bend
from hitjoints.planning.search.climb import climb, feasible, pull_back

H = np.array([0.48, 0.6, 0.64])
STEP = 1e-6


def objective_of(name):
    return FarthestAway() if name == "away" else objective_named(name)


# Central differences: cancellation eps / step, curvature step^2.
CLOSE = 1e-7


def sliding_arm(urdf):
    """A spatial arm with a prismatic and two continuous joints, asymmetric velocity limits."""
    turning = '<limit effort="3" velocity="2"/>'
    axes = ("0 0 1", "0 1 0", "0 0 1", "1 0 0", "0 1 0")
    kinds = ("continuous", "revolute", "prismatic", "continuous", "revolute")
    parts = [urdf.base]
    for i, (axis, kind) in enumerate(zip(axes, kinds, strict=True)):
        more = turning if kind == "continuous" else urdf.limit
        parts.append(urdf.link(f"l{i}", mass=1.0 + i, products=(0.001, 0, 0.002)))
        before = "base" if i == 0 else f"l{i - 1}"
        parts.append(
            urdf.joint(f"j{i}", before, f"l{i}", kind, at="0.2 0.03 0.25", axis=axis, more=more)
        )
    return urdf.load(*parts)


def differences(function, x):
    columns = []
    for j in range(x.shape[1]):
        d = np.zeros(x.shape[1])
        d[j] = STEP
        columns.append((function(x + d) - function(x - d)) / (2 * STEP))
    return np.stack(columns, axis=-1)


@pytest.mark.parametrize("objective", ["inertia", "flux", "straight-flux", "away"])
@pytest.mark.parametrize("name", ["iiwa14", "panda", "sliding"])
def test_derivatives(arm, urdf, name, objective):
    robot = sliding_arm(urdf) if name == "sliding" else arm(name)
    rng = np.random.default_rng(3)
    low, high = np.maximum(robot.lower, -3), np.minimum(robot.upper, 3)
    q = rng.uniform(low, high, (12, robot.n))
    for contact in (Contact(robot.n - 1), Contact(robot.n, (0.03, -0.02, 0.1))):
        asked = task(robot, contact, H, 1.7, np.array([0.4, 0.2, 0.5]), True)
        flux = 0.5 if objective == "inertia" else None
        problem = HitProblem(asked, objective_of(objective), flux=flux)
        x = problem.start(q)
        if objective == "straight-flux":
            x[:, robot.n :] = rng.uniform(0.1, 1, q.shape) * np.sign(x[:, robot.n :])
        now = problem.evaluate(x)
        usable = np.isfinite(now.value)
        assert usable.sum() > 5
        x, now = x[usable], now.take(usable)
        expected = differences(lambda x, problem=problem: problem.evaluate(x).value, x)
        scale = 1 + np.abs(now.gradient).max(axis=1, keepdims=True)
        np.testing.assert_allclose(now.gradient / scale, expected / scale, atol=CLOSE)
        expected = differences(lambda x, problem=problem: problem.evaluate(x).residual, x)
        scale = 1 + np.abs(now.slope).max(axis=2, keepdims=True)
        np.testing.assert_allclose(now.slope / scale, expected / scale, atol=CLOSE)


@pytest.mark.parametrize("name", ["iiwa14", "sliding"])
def test_bending_is_the_derivative_of_the_velocity(arm, urdf, name):
    robot = sliding_arm(urdf) if name == "sliding" else arm(name)
    rng = np.random.default_rng(0)
    q, qd = rng.uniform(-1, 1, (2, 6, robot.n))
    contact = Contact(robot.n, (0.1, 0.05, -0.2))

    def velocity(q):
        return np.array([hj.jacobian(robot, a, contact) @ b for a, b in zip(q, qd, strict=True)])

    chain = chain_of(robot)
    bent = np.array(
        [
            bend(TracedArm(chain, tuple(a)).axes(), hj.jacobian(robot, a, contact).T, list(b))
            for a, b in zip(q, qd, strict=True)
        ]
    )
    np.testing.assert_allclose(bent.transpose(0, 2, 1), differences(velocity, q), atol=CLOSE)


def test_screen_and_evaluate_agree(arm):
    robot = arm("panda")
    q = np.random.default_rng(1).uniform(robot.lower, robot.upper, (50, robot.n))
    for objective in ("inertia", "flux", "straight-flux"):
        asked = task(robot, Contact(7), H, 2.0, None, True)
        problem = HitProblem(asked, objective_of(objective))
        value, excess = problem.screen(q)
        now = problem.evaluate(problem.start(q))
        np.testing.assert_allclose(now.value, value, rtol=1e-9)
        np.testing.assert_allclose(np.maximum(now.residual[:, -1], 0), excess, atol=1e-12)


def test_straight_velocities_are_the_linear_program(arm):
    robot, h = arm("iiwa7"), H
    across = np.linalg.svd(h[None])[2][1:]
    for q in np.random.default_rng(2).uniform(robot.lower, robot.upper, (30, robot.n)):
        jacobian = hj.jacobian(robot, q, 7)
        qd = straight_velocities(
            (h @ jacobian)[None],
            (across @ jacobian)[None],
            robot.velocity_lower,
            robot.velocity_upper,
        )[0]
        assert np.abs(across @ jacobian @ qd).max() < 1e-12
        best = hj.hitting_speed(robot, q, 7, h, straight=True)
        assert h @ jacobian @ qd == pytest.approx(best, rel=1e-8)


def test_pulled_back_onto_the_manifold_and_into_the_bounds(arm):
    robot = arm("iiwa14")
    target = np.array([0.5, 0.3, 0.5])
    asked = task(robot, Contact(6), H, 2.0, target, True)
    problem = HitProblem(asked, objective_named("inertia"))
    rng = np.random.default_rng(4)
    q = hj.place_joint(robot, 6, np.tile(target, (60, 1))).q
    x, now = pull_back(problem, q + 0.05 * rng.standard_normal(q.shape), steps=10)
    assert (robot.lower <= x).all()
    assert (x <= robot.upper).all()
    ok = feasible(problem, now)
    assert ok.sum() > 40
    for good in x[ok]:
        assert np.linalg.norm(hj.position(robot, good, 6) - target) < 1e-9


def test_climb_ends_at_a_maximum(arm):
    robot = arm("iiwa14")
    target = np.array([0.5, 0.3, 0.5])
    problem = HitProblem(task(robot, Contact(6), H, 2.0, target, True), objective_named("inertia"))
    placed = hj.place_joint(robot, 6, np.tile(target, (40, 1))).q
    before = problem.screen(placed)
    starts = placed[before[1] == 0]
    x, now = climb(problem, starts, 60)
    ok = feasible(problem, now)
    assert ok.all()
    assert (now.value >= problem.screen(starts)[0]).all()
    # No admissible neighbour is better.
    rng = np.random.default_rng(0)
    for top, value in zip(x[:5], now.value[:5], strict=True):
        near = pull_back(problem, top + 1e-3 * rng.standard_normal((200, robot.n)))
        assert near[1].value[feasible(problem, near[1])].max() < value + 1e-7


def test_a_program_that_disagrees_with_pinocchio_is_refused(arm, monkeypatch):
    robot = arm("iiwa14")
    chain = chain_of(robot)
    heavy = dataclasses.replace(chain.links[3], armature=0.01)
    wrong = dataclasses.replace(chain, links=(*chain.links[:3], heavy, *chain.links[4:]))
    monkeypatch.setattr(problem_program, "chain_of", lambda robot: wrong)
    problem_program.program_for.cache_clear()
    asked = task(robot, Contact(6), H, 2.0, None, True)
    with pytest.raises(KernelMismatchError, match="mobility at joint 6"):
        HitProblem(asked, objective_named("inertia"))


@pytest.mark.parametrize("count", [0, 1, 3, 50])
def test_any_number_of_points(arm, count):
    robot = arm("iiwa14")
    problem = HitProblem(task(robot, Contact(6), H, 2.0, None, True), objective_named("flux"))
    q = np.random.default_rng(6).uniform(robot.lower, robot.upper, (50, robot.n))
    whole, part = problem.evaluate(q), problem.evaluate(q[:count])
    for name in ("value", "gradient", "residual", "slope"):
        np.testing.assert_array_equal(getattr(part, name), getattr(whole, name)[:count])


def test_numpy_gives_the_same(arm, monkeypatch):
    robot = arm("panda")
    q = np.random.default_rng(7).uniform(robot.lower, robot.upper, (20, robot.n))
    asked, found = task(robot, Contact(7), H, 2.0, np.array([0.4, 0.2, 0.5]), True), []
    for backend in ("llvm", "numpy"):
        monkeypatch.setenv(VARIABLE, backend)
        problem_program.program_for.cache_clear()
        problem = HitProblem(asked, objective_named("deliverable"))
        x = problem.start(q)
        found.append(problem.evaluate(x))
    for name in ("value", "gradient", "residual", "slope"):
        np.testing.assert_allclose(*(getattr(one, name) for one in found), rtol=1e-9, atol=1e-9)
    problem_program.program_for.cache_clear()
