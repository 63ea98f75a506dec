"""Eq. 12 and the programs of the control loop against SciPy and against the certifying solver."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import linprog, minimize

from hitjoints.errors import InfeasibleError, InputError
from hitjoints.hitting.laws import QpLaw, law_named, paper_law
from hitjoints.programs.joint_velocity import (
    RHO,
    build_joint_velocity,
    gradient_weights,
    least_norm,
    solve_joint_velocity,
    unbounded_flux,
)
from hitjoints.programs.problem import Program
from hitjoints.programs.solver import solve
from hitjoints.programs.warm import WarmProgram
from hitjoints.vectors import unit

H = np.array([0.0, 0.6, 0.8])
MASS, INERTIA, LIMIT = 2.0, 5.0, np.array([1.7, 1.7, 1.7, 2.2, 2.4, 3.0, 3.0])


def jacobian(seed):
    return 0.5 * np.random.default_rng(seed).standard_normal((3, 7))


@pytest.mark.parametrize("seed", range(8))
def test_equation_12_against_slsqp(seed):
    J, f = jacobian(seed), 0.4 * H + [0.05, 0.0, -0.02]
    weights = np.random.default_rng(seed).uniform(0.1, 1.0, 7)
    lower, upper = -0.3 * LIMIT, 0.3 * LIMIT
    found = solve_joint_velocity(J, f, H, INERTIA, MASS, 0.25, lower, upper, weights)
    shortest = np.linalg.pinv(J) @ f

    def cost(qd):
        away = qd - shortest
        return 1e4 * (np.sum((J @ qd - f) ** 2) + RHO * away @ (weights * away))

    flux = {"type": "eq", "fun": lambda qd: INERTIA / (INERTIA + MASS) * (H @ J @ qd) - 0.25}
    bounds = list(zip(lower, upper, strict=True))
    options = {"ftol": 1e-14, "maxiter": 500}
    reference = minimize(
        cost, np.zeros(7), method="SLSQP", bounds=bounds, constraints=flux, options=options
    )
    assert not found.saturated
    assert found.flux == pytest.approx(0.25, abs=1e-9)
    assert cost(found.qd) <= cost(reference.x) + 1e-7
    np.testing.assert_allclose(found.qd, reference.x, atol=2e-3)


def test_a_flux_out_of_reach_becomes_the_greatest_one():
    J, lower, upper = jacobian(3), -0.2 * LIMIT, 0.1 * LIMIT
    found = solve_joint_velocity(J, 5 * H, H, INERTIA, MASS, 4.0, lower, upper)
    top = linprog(-(H @ J), bounds=list(zip(lower, upper, strict=True)))
    assert found.saturated
    assert found.flux == pytest.approx(INERTIA / (INERTIA + MASS) * -top.fun, rel=1e-5)
    assert ((found.qd >= lower) & (found.qd <= upper)).all()


def test_the_program_can_be_looked_at():
    program = build_joint_velocity(jacobian(0), H, H, INERTIA, MASS, 0.2, -LIMIT, LIMIT)
    assert np.linalg.eigvalsh(program.H)[0] > 0  # strictly convex: one answer
    assert program.b[0] == pytest.approx(0.2 * (INERTIA + MASS) / INERTIA)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("jacobian", np.zeros((2, 7))),
        ("velocity", [1.0, 2.0]),
        ("direction", [0.0, 0.0, 0.0]),
        ("inertia", 0.0),
        ("mass", np.nan),
        ("flux", -1.0),
        ("lower", [0.0]),
        ("weights", np.zeros(7)),
        ("rho", 0.0),
    ],
)
def test_bad_input_is_named(name, value):
    good = {
        "jacobian": jacobian(0),
        "velocity": H,
        "direction": H,
        "inertia": 5.0,
        "mass": 2.0,
        "flux": 0.2,
        "lower": -LIMIT,
        "upper": LIMIT,
    }
    with pytest.raises(InputError) as caught:
        solve_joint_velocity(**good | {name: value})
    assert caught.value.argument == name


def test_bounds_without_room_are_infeasible():
    with pytest.raises(InfeasibleError):
        solve_joint_velocity(jacobian(0), H, H, 5.0, 2.0, 0.2, LIMIT, 1.1 * LIMIT)


def test_gradient_weights():
    np.testing.assert_allclose(gradient_weights(np.array([-4.0, 0.0, 2.0])), [1.1, 0.1, 0.6])
    np.testing.assert_allclose(gradient_weights(np.zeros(2)), 1.0)


@pytest.mark.parametrize("rank", [1, 2, 3])
def test_least_norm_is_the_pseudo_inverse(rank):
    rng = np.random.default_rng(rank)
    J = rng.standard_normal((3, rank)) @ rng.standard_normal((rank, 7))
    v = rng.standard_normal(3)
    np.testing.assert_allclose(least_norm(J, v), np.linalg.pinv(J, rcond=1e-9) @ v, atol=1e-8)


@pytest.mark.parametrize("rank", [1, 2, 3])
def test_closed_form_of_equation_12_against_its_optimality_conditions(rank):
    """Against one linear system in extended precision, where no limit is in the way."""
    rng = np.random.default_rng(20 + rank)
    certified = 0
    for _ in range(200):
        J = rng.standard_normal((3, rank)) @ rng.standard_normal((rank, 7))
        f, speed = rng.standard_normal(3), float(rng.uniform(0.1, 1.0))
        h, weights = unit(rng.standard_normal(3)), rng.uniform(0.1, 1.1, 7)
        found = unbounded_flux(J, f, h, speed, weights, RHO)
        if found is None:
            continue
        certified += 1
        assert h @ J @ found == pytest.approx(speed, abs=1e-9)
        shortest = np.linalg.pinv(J, rcond=1e-9) @ f
        K = np.zeros((8, 8), dtype=np.longdouble)
        K[:7, :7] = J.T @ J + RHO * np.diag(weights)
        K[:7, 7], K[7, :7] = h @ J, h @ J
        right = np.append(J.T @ f + RHO * weights * shortest, speed)
        x = np.linalg.solve(K.astype(float), right)
        for _ in range(3):  # the system is stiff: residuals in 80 bits mend the answer
            x += np.linalg.solve(K.astype(float), (right - K @ x).astype(float))
        np.testing.assert_allclose(found, x[:7], atol=1e-6 * max(1.0, np.abs(x[:7]).max()))
    assert certified > (0 if rank < 3 else 190)


def test_closed_form_of_equation_12_is_that_of_the_certifying_solver():
    for seed in range(20):
        J, f = jacobian(seed), 0.4 * H + [0.05, 0.0, -0.02]
        found = unbounded_flux(J, f, H, 0.3, np.ones(7), RHO)
        wide = 100 * LIMIT
        flux = INERTIA / (INERTIA + MASS) * 0.3
        program = solve_joint_velocity(J, f, H, INERTIA, MASS, flux, -wide, wide)
        np.testing.assert_allclose(found, program.qd, atol=1e-5)


def slowly_changing(count, rng):
    """Yield programs along a smooth path, with bounds that become active and free again."""
    A0, A1 = rng.standard_normal((2, 2, 6))
    c0, c1 = 3 * rng.standard_normal((2, 6))
    x = 0.3 * rng.uniform(-1, 1, 6)
    for t in np.linspace(0, 3, count):
        A = A0 + np.sin(t) * A1
        H = np.diag(1 + 0.5 * np.sin(t + np.arange(6)))
        yield H, c0 + np.sin(2 * t) * c1, A, A @ x, np.full(6, -0.6), np.full(6, 0.5)


def test_warm_answers_are_those_of_the_certifying_solver():
    program = WarmProgram(6, 2)
    active = 0
    for H6, c, A, b, lower, upper in slowly_changing(300, np.random.default_rng(1)):
        x = program.solve(H6, c, A, b, lower, upper)
        exact = solve(Program(c, lower, upper, H=H6, A=A, b=b)).x
        np.testing.assert_allclose(x, exact, atol=1e-5)
        assert ((x >= lower) & (x <= upper)).all()
        active += bool(((x == lower) | (x == upper)).any())
    assert active > 50
    assert program.cold == 0


def test_equalities_that_depend_on_each_other_and_a_locked_variable():
    program, rng = WarmProgram(6, 3), np.random.default_rng(3)
    for H6, c, A, _, lower, upper in slowly_changing(60, rng):
        lower[0] = upper[0] = 0.0
        rows = np.vstack([A, A[0] + A[1]])
        b = rows @ np.array([0.0, 0.1, -0.2, 0.1, 0.2, -0.1])
        x = program.solve(H6, c, rows, b, lower, upper)
        exact = solve(Program(c, lower, upper, H=H6, A=A, b=b[:2])).x
        np.testing.assert_allclose(x, exact, atol=1e-5)
        assert x[0] == 0.0


def test_no_answer_is_given_without_a_certificate():
    one = np.ones(2)
    program = WarmProgram(2, 1)
    assert program.solve(np.eye(2), one, one[None], np.array([5.0]), -one, one) is None
    assert program.solve(np.eye(2), np.nan * one, one[None], np.zeros(1), -one, one) is None
    np.testing.assert_allclose(
        program.solve(np.eye(2), 0 * one, one[None], one[:1], -one, one), 0.5, atol=1e-7
    )


def test_the_bits_do_not_depend_on_where_the_numbers_lie():
    def moved(array, by):
        whole = np.empty(array.size + 16)
        skip = (-whole.ctypes.data % 64) // 8 + by
        copy = whole[skip : skip + array.size].reshape(array.shape)
        copy[...] = array
        return copy

    given = next(slowly_changing(1, np.random.default_rng(4)))
    answers = {
        WarmProgram(6, 2).solve(*(moved(part, by) for part in given)).tobytes() for by in range(8)
    }
    assert len(answers) == 1


@pytest.mark.parametrize("seed", range(6))
def test_both_laws_are_equation_7_within_the_limits(seed):
    J, f = jacobian(seed), np.array([0.02, 0.1, 0.05])
    posture = 0.2 * np.random.default_rng(seed).standard_normal(7)
    pinv = np.linalg.pinv(J)
    expected = pinv @ f + (np.eye(7) - pinv @ J) @ posture
    for law in (QpLaw(7), paper_law):
        motion = law(J, f, posture, -3 * LIMIT, 3 * LIMIT)
        np.testing.assert_allclose(motion.qd, expected, atol=1e-9)
        assert motion.scaling == 1.0


@pytest.mark.parametrize("seed", range(12))
def test_the_default_law_slows_down_no_more_than_it_must(seed):
    rng = np.random.default_rng(seed)
    J, f, posture = jacobian(seed), rng.standard_normal(3), rng.standard_normal(7)
    lower, upper = -rng.uniform(0.0, 0.5) * LIMIT, rng.uniform(0.05, 0.5) * LIMIT
    motion = QpLaw(7)(J, f, posture, lower, upper)
    rows = np.hstack([J, -f[:, None]])
    bounds = [*zip(lower, upper, strict=True), (0, 1)]
    top = linprog([*np.zeros(7), -1], A_eq=rows, b_eq=np.zeros(3), bounds=bounds)
    assert motion.scaling == pytest.approx(-top.fun, abs=2e-2)
    np.testing.assert_allclose(J @ motion.qd, motion.scaling * f, atol=1e-6)
    assert ((motion.qd >= lower) & (motion.qd <= upper)).all()


def test_the_paper_law_scales_into_the_limits():
    J, f, posture = jacobian(2), 3 * H, np.ones(7)
    motion = paper_law(J, f, posture, -0.1 * LIMIT, 0.1 * LIMIT)
    full = paper_law(J, f, posture, -1e3 * LIMIT, 1e3 * LIMIT).qd
    assert 0 < motion.scaling < 1
    np.testing.assert_allclose(motion.qd, motion.scaling * full, atol=1e-12)
    assert np.abs(motion.qd / (0.1 * LIMIT)).max() == pytest.approx(1)


def test_unknown_laws_are_refused():
    with pytest.raises(InputError, match="paper, qp"):
        law_named("pid", 7)
