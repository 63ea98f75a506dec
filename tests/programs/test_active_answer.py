"""Strictly convex programs answered by formulas: against the solver, and to the last bit."""

import numpy as np
import pytest

from hitjoints.kernels.formulas.straight_motion import straight_motion_of
from hitjoints.kernels.tape import counted
from hitjoints.kernels.tape.backends import llvm_works
from hitjoints.kernels.tape.counted import CountedProgram
from hitjoints.programs import active_answer, solver
from hitjoints.programs.active_answer import certified_minimum
from hitjoints.programs.problem import Program, residuals

COUNT = 200


def programs(seed, count=COUNT):
    """J^T J and a small diagonal, rows that the box can meet, some bounds equal."""
    rng = np.random.default_rng(seed)
    for _ in range(count):
        n, m = int(rng.integers(2, 9)), int(rng.integers(0, 3))
        J = rng.normal(size=(3, n)) * rng.uniform(0.05, 1)
        H = J.T @ J + 10.0 ** rng.uniform(-3, 0) * np.diag(rng.uniform(0.5, 2, n))
        lower, upper = -rng.uniform(0.1, 3, n), rng.uniform(0.1, 3, n)
        locked = rng.random(n) < 0.1
        lower, upper = np.where(locked, 0.0, lower), np.where(locked, 0.0, upper)
        A = rng.normal(size=(min(m, n - 1), n))
        b = A @ rng.uniform(lower, upper)
        yield Program(rng.normal(size=n), lower, upper, H=H, A=A, b=b)


def test_most_are_answered_and_as_the_solver_does(monkeypatch):
    answers = [(program, certified_minimum(program)) for program in programs(1)]
    found = [(program, answer) for program, answer in answers if answer is not None]
    assert len(found) > 0.9 * COUNT
    monkeypatch.setattr(solver, "certified_minimum", lambda program: None)
    for program, answer in found:
        expected = solver.solve(program)
        np.testing.assert_allclose(answer.x, expected.x, atol=1e-8)
        assert answer.objective == pytest.approx(expected.objective, abs=1e-10)
        # The residuals are those that anyone finds for the answer.
        own = residuals(program, answer.x, answer.y, answer.z, answer.w)
        assert max(own.worst, answer.residuals.worst) <= 1e-11
        assert ((program.lower <= answer.x) & (answer.x <= program.upper)).all()


@pytest.mark.parametrize(
    "program",
    [
        Program(np.ones(2), -np.ones(2), np.ones(2)),  # linear
        Program(np.ones(2), -np.ones(2), np.ones(2), H=np.diag([1.0, 0.0])),
        Program(np.ones(2), np.ones(2), -np.ones(2), H=np.eye(2)),
        Program(np.ones(2), -np.ones(2), np.ones(2), H=np.eye(2), A=np.ones((1, 2)), b=[3.0]),
        Program(np.ones(9), -np.ones(9), np.ones(9), H=np.eye(9)),
        Program(np.ones(2), -np.ones(2), np.ones(2), H=np.eye(2), C=np.ones((1, 2)), d=[0.0]),
    ],
)
def test_what_is_not_for_it_is_left_to_the_solver(program):
    assert certified_minimum(program) is None


def quadratic(given):
    size, n = len(given), next(n for n in range(1, 9) if n * n + 4 * n + n + 1 == len(given))
    assert size == n * n + 5 * n + 1
    return active_answer._formulas(n, 1).formula(given)


@pytest.mark.skipif(not llvm_works(), reason="needs llvmlite")
@pytest.mark.parametrize(("formula", "size"), [(straight_motion_of, 38), (quadratic, 85)])
def test_compiled_formulas_have_the_bits_of_floats(formula, size, monkeypatch):
    rng, floats = np.random.default_rng(3), CountedProgram(formula, size, 10**9)
    compiled = CountedProgram(formula, size, 1)
    compared = 0
    for _ in range(COUNT):
        given = rng.normal(size=size)
        if formula is quadratic:
            F = rng.normal(size=(7, 7))
            given[:49] = (F @ F.T + 0.1 * np.eye(7)).ravel()
        given[-14:-7] = -np.abs(given[-14:-7])
        given[-7:] = np.abs(given[-7:]) if formula is not quadratic else rng.integers(-1, 2, 7)
        if formula is quadratic:
            given[-14:-7] = 1.0 + np.abs(given[-14:-7])
        expected = floats(given)
        if expected:
            compared += 1
            np.testing.assert_array_equal(compiled(given), expected)
    assert compared > 0.9 * COUNT
    monkeypatch.setattr(counted, "choose", lambda: "numpy")
    assert CountedProgram(formula, size, 1)(given) == expected
