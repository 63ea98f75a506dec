from dataclasses import replace

import numpy as np
import program_corpus as corpus
import pytest
from scipy.optimize import brentq, linprog

from hitjoints.errors import InfeasibleError, SolverError
from hitjoints.programs import proxqp
from hitjoints.programs.problem import Program, residuals
from hitjoints.programs.solver import CERTIFIED, solve

TOLERANCES = {"primal_feasibility_tolerance": 1e-10, "dual_feasibility_tolerance": 1e-10}


def certified(program):
    """Solve, and check everything the solution promises."""
    found = solve(program)
    assert (found.x >= program.lower).all()
    assert (found.x <= program.upper).all()
    assert (found.z >= 0).all()
    again = residuals(program, found.x, found.y, found.z, found.w)
    assert again == found.residuals
    assert again.worst <= CERTIFIED
    assert found.objective == program.objective(found.x)
    return found


def highs(p):
    rows = {"A_eq": p.A, "b_eq": p.b} if p.b.size else {}
    rows |= {"A_ub": p.C, "b_ub": p.d} if p.d.size else {}
    bounds = np.column_stack([p.lower, p.upper])
    found = linprog(p.c, **rows, bounds=bounds, method="highs", options=TOLERANCES)
    assert found.status == 0
    return found.fun


def rescaled(rng, p):
    """The same program with rows of 1e-4 .. 1e4, one of them twice, a zero row and one of 1e-17."""
    rows, bounds = 10 ** rng.uniform(-4, 4, p.b.size), 10 ** rng.uniform(-4, 4, p.d.size)
    A, b = p.A * rows[:, None], p.b * rows
    A = np.vstack([A, 3 * A[:1], np.zeros(p.n), 1e-17 * rng.normal(size=p.n)])
    b = np.concatenate([b, 3 * b[:1], np.zeros(2)])
    return replace(p, A=A, b=b, C=p.C * bounds[:, None], d=p.d * bounds)


def test_linear_programs_agree_with_highs():
    rng = np.random.default_rng(21)
    for _ in range(500):
        p = corpus.feasible(rng)
        assert certified(p).objective == pytest.approx(highs(p), rel=1e-6, abs=1e-9)


@pytest.mark.parametrize("quadratic", [False, True])
def test_scale_duplicates_and_empty_rows_do_not_matter(quadratic):
    rng = np.random.default_rng(22)
    for _ in range(300):
        p = corpus.feasible(rng, quadratic=quadratic)
        same = certified(rescaled(rng, p))
        assert same.objective == pytest.approx(certified(p).objective, rel=1e-6, abs=1e-7)


def test_degenerate_linear_programs_agree_with_highs():
    rng = np.random.default_rng(23)
    for _ in range(300):
        n = int(rng.integers(2, 9))
        A, C = rng.integers(-1, 2, (2, n)), rng.integers(-1, 2, (4, n))
        d = rng.integers(0, 2, 4)
        c, one = rng.integers(-1, 2, n), np.ones(n)
        p = Program(c, -one, one, A=A, b=np.zeros(2), C=C, d=d)
        assert certified(p).objective == pytest.approx(highs(p), rel=1e-6, abs=1e-9)


@pytest.mark.parametrize("near", [None, 0.0, 1e-6])
def test_a_small_hessian_with_one_row_agrees_with_its_closed_form(near):
    """H = h I, a x = b: x = clip(-(c + y a) / h), a x(y) falls monotonically in y."""
    rng = np.random.default_rng(24)
    small = 1e-2
    for _ in range(200):
        n = int(rng.integers(6, 9))
        lower, upper = -rng.uniform(0.5, 3, n), rng.uniform(0.5, 3, n)
        a, c = rng.normal(size=n), rng.normal(size=n)
        most = np.maximum(a * lower, a * upper).sum()
        b = rng.uniform(-0.5, 0.9) * most if near is None else (1 - near) * most
        p = Program(c, lower, upper, small * np.eye(n), a[None], np.array([b]))
        found = certified(p)
        if near == 0.0:
            expected = np.where(a > 0, upper, lower)
        else:
            at = lambda y: np.clip(-(c + y * a) / small, lower, upper)  # noqa: E731, B023
            y = brentq(lambda y: a @ at(y) - b, -1e4, 1e4, xtol=1e-13)  # noqa: B023
            expected = at(y)
        np.testing.assert_allclose(found.x, expected, atol=1e-6)


def test_quadratic_programs_are_certified_and_no_feasible_point_is_better():
    rng = np.random.default_rng(25)
    for _ in range(300):
        p = corpus.feasible(rng, quadratic=True)
        found = certified(p)
        # the step towards a linear program's vertex along the gradient: Frank and Wolfe's bound
        slope = p.H @ found.x + p.c
        assert slope @ found.x - highs(replace(p, c=slope, H=None)) <= 1e-7


def test_the_velocity_program_of_a_hit_is_solved_up_to_the_reachable_flux():
    rng = np.random.default_rng(26)
    for i in range(300):
        J = corpus.jacobian(rng)
        lower, upper = corpus.velocity_box(rng, J.shape[1])
        h, f = corpus.direction(rng), rng.normal(size=3)
        row = 0.4 * h @ J
        most, least = np.maximum(row * lower, row * upper), np.minimum(row * lower, row * upper)
        share = (1.0, 0.999, rng.random())[i % 3]
        b = np.array([share * most.sum() + (1 - share) * least.sum()])
        H = J.T @ J + 1e-4 * np.eye(J.shape[1])
        found = certified(Program(-J.T @ f, lower, upper, H, row[None], b))
        np.testing.assert_allclose(row @ found.x, b[0], rtol=1e-8, atol=1e-8)


def test_boxes_without_width_have_one_answer():
    x = np.array([0.3, -2.0, 1e-9])
    p = Program(np.ones(3), x, x, np.eye(3), np.ones((1, 3)), np.array([x.sum()]))
    np.testing.assert_array_equal(certified(p).x, x)
    with pytest.raises(InfeasibleError, match="equality 0 is missed by 1 or more"):
        solve(replace(p, b=p.b + 1))


def test_a_program_without_cost_gives_a_feasible_point():
    one = np.ones(3)
    found = certified(Program(0 * one, -one, one, A=one[None], b=np.array([2.5])))
    assert found.x.sum() == pytest.approx(2.5)


def test_the_same_program_gives_the_same_answer_to_the_last_bit():
    p = corpus.feasible(np.random.default_rng(27), quadratic=True)
    np.testing.assert_array_equal(solve(p).x, solve(p).x)


def garbage(value):
    def attempt(unit, settings):
        return tuple(np.full(k, value) for k in (unit.n, unit.b.size, unit.d.size))

    return attempt


@pytest.mark.parametrize("value", [np.nan, np.inf, 0.37, -5.0])
def test_an_answer_that_is_not_certified_is_never_returned(monkeypatch, value):
    rng = np.random.default_rng(28)
    programs = [corpus.feasible(rng, quadratic=True) for _ in range(30)]
    right = [solve(p).objective for p in programs]
    monkeypatch.setattr(proxqp, "_attempt", garbage(value))
    failures = []
    for program, objective in zip(programs, right, strict=True):
        try:
            assert certified(program).objective == pytest.approx(objective, rel=1e-6, abs=1e-6)
        except SolverError as error:
            failures.append("no certified solution" in str(error))
    assert all(failures)
    assert len(failures) > 5


def test_a_failed_first_attempt_is_repaired_by_the_next(monkeypatch):
    p = corpus.feasible(np.random.default_rng(29), quadratic=True)
    expected, honest = solve(p), proxqp._attempt

    def first_fails(unit, settings):
        return (garbage(np.nan) if settings == proxqp.ATTEMPTS[0] else honest)(unit, settings)

    monkeypatch.setattr(proxqp, "_attempt", first_fails)
    assert certified(p).objective == pytest.approx(expected.objective, rel=1e-9)
