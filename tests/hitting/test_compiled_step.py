"""The compiled control step against the controller without it, and its programs against ProxQP."""

import numpy as np
import pytest

import hitjoints as hj
from hitjoints.hitting import compiled_step
from hitjoints.hitting.step import Gains
from hitjoints.hitting.step_tape import EXACT
from hitjoints.kernels.formulas.bounded import (
    Guess,
    along_the_field,
    nearest_velocity,
    with_the_flux,
)
from hitjoints.programs.following import PROGRESS, following_terms
from hitjoints.programs.joint_velocity import RHO, WITHIN_REACH, flux_terms, most_flux_terms
from hitjoints.programs.problem import Program
from hitjoints.programs.solver import solve
from hitjoints.programs.torque_rows import with_impulses

OPTIONS = (
    {},
    {"weighting": "gradient"},
    {"reference": "constant"},
    {"speed_profile": "paper"},
    {"gains": Gains(posture=2.0, inertia=0.1)},
)


def cases(robot, count, seed):
    """Hits from random configurations, some beyond what the arm can do, and starts behind them."""
    rng = np.random.default_rng(seed)
    while count:
        joint, q = int(rng.choice([5, 6, 7])), rng.uniform(robot.lower, robot.upper)
        at, h, mass = hj.position(robot, q, joint), rng.normal(size=3), rng.uniform(0.5, 3.0)
        h /= np.linalg.norm(h)
        start = hj.place_joint(robot, joint, at - 0.12 * h, start=q)
        inertia = hj.directional_inertia(robot, q, joint, h)
        most = hj.hitting_flux(inertia, mass, hj.hitting_speed(robot, q, joint, h, straight=True))
        if start.solved[0] and most > 1e-3:
            count -= 1
            yield hj.Hit(joint, at, h, mass, rng.uniform(0.2, 1.2) * most), q, start.q[0]


@pytest.mark.parametrize("name", ["iiwa14", "panda", "xarm7"])
def test_steps_are_those_of_the_controller_without_it(name):
    robot, steps, compiled = hj.load_robot(name), 0, 0
    for k, (hit, posture, start) in enumerate(cases(robot, 8, 3)):
        given = {"dt": 0.004, "posture": posture, **OPTIONS[k % len(OPTIONS)]}
        fast = hj.Controller(robot, hit, posture, **given)
        slow = hj.Controller(robot, hit, posture, compiled=False, **given)
        q = start
        for _ in range(60):
            compiled += fast._compiled(q) is not None
            steps += 1
            np.testing.assert_allclose(fast.step(q), slow.step(q), atol=2e-9)
            for a, b in zip(fast.last, slow.last, strict=True):
                np.testing.assert_allclose(a, b, rtol=1e-9, atol=1e-9)
            qd = fast.last.qd
            assert ((qd >= robot.velocity_lower) & (qd <= robot.velocity_upper)).all()
            ahead = q + 0.004 * qd
            assert ((ahead >= robot.lower - 1e-12) & (ahead <= robot.upper + 1e-12)).all()
            q = fast.follow(q, qd)
            if fast.arrived:
                break
    assert compiled >= 0.99 * steps


def random_case(rng):
    J = 0.5 * rng.normal(size=(3, 7))
    lower, upper = -rng.uniform(0.2, 2.0, 7), rng.uniform(0.2, 2.0, 7)
    return J, rng.normal(size=3), lower, upper


def iterate(step, sides):
    """Follow guesses to an answer, or None."""
    for guess in range(24):
        found = step(Guess(sides, float(guess > 5)))
        if found.changed == 0.0:
            return np.array(found.x) if found.miss < EXACT else None
        sides = found.sides
    return None


def test_the_law_is_that_of_the_certifying_solver():
    rng, answered = np.random.default_rng(71), 0
    for _ in range(150):
        J, f, lower, upper = random_case(rng)
        wish = rng.normal(size=7)
        columns, bounds = [tuple(c) for c in J.T], (list(lower), list(upper))
        x = iterate(
            lambda guess, given=(columns, tuple(f), list(wish), bounds): along_the_field(
                *given, guess, PROGRESS
            ),
            [0.0] * 7 + [1.0],
        )
        if x is None:
            continue
        answered += 1
        H, c, A, b = following_terms(J, f, wish)
        limits = np.append(lower, 0.0), np.append(upper, 1.0)
        expected = solve(Program(c, *limits, H=H, A=A, b=b))
        np.testing.assert_allclose(x, expected.x, atol=1e-6)
    assert answered >= 130


def test_equation_12_is_that_of_the_certifying_solver():
    rng, answered = np.random.default_rng(72), 0
    for _ in range(150):
        J, f, lower, upper = random_case(rng)
        h = rng.normal(size=3)
        h /= np.linalg.norm(h)
        pull = h @ J
        speed = rng.uniform(0.1, 0.95) * pull @ np.where(pull > 0, upper, lower)
        weights, columns = rng.uniform(0.1, 1.1, 7), [tuple(c) for c in J.T]
        nearest, regular = nearest_velocity(columns, tuple(f))
        assert regular > 0
        np.testing.assert_allclose(nearest, np.linalg.pinv(J) @ f, atol=1e-9)
        given = (columns, tuple(f), tuple(h), speed, nearest, list(RHO * weights))
        bounds = list(lower), list(upper)
        x = iterate(
            lambda guess, given=given, bounds=bounds: with_the_flux(*given, bounds, guess),
            [0.0] * 7,
        )
        if x is None:
            continue
        answered += 1
        H, c, A, b = flux_terms(J, f, pull, speed, weights, RHO)
        expected = solve(Program(c, lower, upper, H=H, A=A, b=b))
        np.testing.assert_allclose(x, expected.x, atol=2e-5)
        assert pull @ x == pytest.approx(speed, abs=1e-9)
    assert answered >= 145


def test_the_same_hit_gives_the_same_bits():
    robot = hj.load_robot("iiwa14")
    (hit, posture, start), *_ = cases(robot, 1, 5)
    runs = []
    for _ in range(2):
        control, q, steps = hj.Controller(robot, hit, posture, posture=posture), start, []
        for _ in range(40):
            steps.append(control.step(q))
            q = control.follow(q, steps[-1])
        runs.append(np.array(steps))
    np.testing.assert_array_equal(*runs)


def test_bad_input_is_refused_as_ever():
    robot = hj.load_robot("iiwa14")
    (hit, posture, start), *_ = cases(robot, 1, 5)
    control = hj.Controller(robot, hit, posture, posture=posture)
    for q in (np.full(7, np.nan), robot.upper + 0.1, np.zeros(6), "q"):
        with pytest.raises(hj.InputError):
            control.step(q)
    with pytest.raises(hj.InputError, match="qd"):
        control.step(start, np.full(7, np.nan))
    assert control.step(start.tolist()) == pytest.approx(control.step(start), abs=1e-9)


def within_torques(robot, reference):
    """Steps with torque limits that were compiled: the controller, q, qd, its step and bounds."""
    for hit, posture, start in cases(robot, 4, 3):
        given = {"dt": 0.004, "posture": posture, "torque_limits": True, "reference": reference}
        fast = hj.Controller(robot, hit, posture, **given)
        slow = hj.Controller(robot, hit, posture, compiled=False, **given)
        q, qd = start, np.zeros(7)
        for _ in range(40):
            impulses = fast.torques.impulses(q, qd)
            bounds = fast.torques.bounds(q, qd, impulses, *fast.bounds(q))
            taken = fast._compiled.within_torques(q, *bounds, impulses)
            fast.step(q, qd)
            assert (np.abs(impulses.M @ fast.last.qd + impulses.b) <= impulses.limit + 2e-7).all()
            if taken is not None and fast.torques.can_stop(fast.follow(q, taken.qd), taken.qd):
                np.testing.assert_array_equal(fast.last.qd, taken.qd)
                yield fast, slow, q, qd, bounds
            qd = fast.last.qd
            q = fast.follow(q, qd)
            if fast.arrived:
                break


@pytest.mark.parametrize("name", ["iiwa14", "panda"])
def test_steps_within_torques_are_those_of_the_controller_without_it(name):
    robot, compiled = hj.load_robot(name), 0
    for fast, slow, q, qd, _ in within_torques(robot, "constant"):
        compiled += 1
        np.testing.assert_allclose(slow.step(q, qd), fast.last.qd, atol=1e-8)
        for a, b in zip(fast.last, slow.last, strict=True):
            np.testing.assert_allclose(a, b, rtol=1e-8, atol=1e-8)
    assert compiled > 40


def test_equation_12_within_torques_is_that_of_the_certifying_solver():
    """With torque rows: the other way knows it to 1e-7 of a cost of 1e3, which is not enough."""
    robot, compiled = hj.load_robot("panda"), 0
    for fast, _, q, qd, (lower, upper) in within_torques(robot, "optimised"):
        state, impulses = fast.point.observe(q, fast.direction), fast.torques.impulses(q, qd)
        pull = fast.direction @ state.J
        reach = pull @ np.where(pull > 0, upper, lower)
        speed = min(fast.hit.speed(state.inertia), reach)
        asked = speed if speed < reach else WITHIN_REACH * reach
        f = fast._field(state.position, speed)
        terms = most_flux_terms(state.J, f, pull, asked, np.ones(7), RHO)
        H, c, A, b = with_impulses(terms, impulses)
        low = np.concatenate((lower, [-10.0], -impulses.limit))
        high = np.concatenate((upper, [1.0], impulses.limit))
        if compiled % 10 == 0:
            best = solve(Program(c, low, high, H=H, A=A, b=b)).x
            np.testing.assert_allclose(fast._compiled._asked, best[:7], atol=1e-7)
        compiled += 1
    assert compiled > 40


def test_without_llvm_and_with_acceleration_limits_it_is_left_out(monkeypatch):
    robot = hj.load_robot("iiwa14")
    (hit, posture, start), *_ = cases(robot, 1, 5)
    assert hj.Controller(robot, hit, posture, acceleration_limits=True)._compiled is None
    assert hj.Controller(robot, hit, posture, law="paper")._compiled is None
    fast = hj.Controller(robot, hit, posture, posture=posture)
    monkeypatch.setattr(compiled_step, "choose", lambda: "numpy")
    plain = hj.Controller(robot, hit, posture, posture=posture)
    assert plain._compiled is None
    np.testing.assert_allclose(plain.step(start), fast.step(start), atol=1e-9)
