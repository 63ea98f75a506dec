"""A back end is one file with two names, and its answers are certified whatever they are."""

import numpy as np
import pytest
from scipy.optimize import minimize

from hitjoints.errors import SolverError
from hitjoints.programs import proxqp, solver
from hitjoints.programs.problem import Program
from hitjoints.programs.warm import WarmProgram


class Slsqp:
    """SciPy's SLSQP as a back end: approximate answers without multipliers."""

    called = 0

    @classmethod
    def attempts(cls, unit):
        cls.called += 1
        rows = {"type": "eq", "fun": lambda u: unit.A @ u - unit.b, "jac": lambda u: unit.A}
        found = minimize(
            unit.objective,
            np.zeros(unit.n),
            jac=lambda u: unit.curvature(u) + unit.c,
            bounds=[(-1, 1)] * unit.n,
            constraints=[rows] if unit.b.size else [],
            method="SLSQP",
            options={"ftol": 1e-14, "maxiter": 200},
        )
        free = np.abs(found.x) < 1 - 1e-6
        slope = unit.curvature(found.x) + unit.c
        y = np.linalg.lstsq(unit.A[:, free].T, -slope[free])[0]
        yield found.x, y, np.zeros(unit.d.size)

    class WarmStart:
        def __init__(self, n, m):
            self.n, self.m = n, m

        def __call__(self, H, c, A, b, lower, upper):
            Slsqp.called += 1
            return np.zeros(self.n), np.zeros(self.m)


class Liar:
    """Answers that have nothing to do with the question."""

    @staticmethod
    def attempts(unit):
        yield np.full(unit.n, 0.3), np.full(unit.b.size, 1e9), np.zeros(unit.d.size)

    WarmStart = Slsqp.WarmStart


def programs(count):
    rng = np.random.default_rng(5)
    for _ in range(count):
        root = rng.normal(size=(7, 7))
        A = rng.normal(size=(2, 7))
        inside = rng.uniform(-0.5, 0.5, 7)
        bounds = -rng.uniform(0.5, 1.0, 7), rng.uniform(0.5, 1.0, 7)
        H = root @ root.T + 0.1 * np.eye(7)
        yield Program(5.0 * rng.normal(size=7), *bounds, H=H, A=A, b=A @ inside)


def test_another_back_end_gives_the_same_certified_answers(monkeypatch):
    given = list(programs(20))
    expected = [solver.solve(program).x for program in given]
    monkeypatch.setattr(solver, "BACK_END", Slsqp)
    monkeypatch.setattr(solver, "certified_minimum", lambda program: None)  # which asks none
    before = Slsqp.called
    for program, x in zip(given, expected, strict=True):
        found = solver.solve(program)
        assert found.residuals.worst <= solver.CERTIFIED
        np.testing.assert_allclose(found.x, x, atol=1e-7)
        warm = WarmProgram(7, 2)
        again = warm.solve(program.H, program.c, program.A, program.b, program.lower, program.upper)
        np.testing.assert_allclose(again, x, atol=1e-6)
    assert Slsqp.called > before


def test_a_back_end_that_lies_is_found_out(monkeypatch):
    given = list(programs(10))
    expected = [solver.solve(program).x for program in given]
    monkeypatch.setattr(solver, "BACK_END", Liar)
    monkeypatch.setattr(solver, "certified_minimum", lambda program: None)  # which asks none
    refused = 0
    for program, x in zip(given, expected, strict=True):
        try:
            np.testing.assert_allclose(solver.solve(program).x, x, atol=1e-7)
        except SolverError:
            refused += 1
    assert refused > 0


def test_proxqp_is_a_back_end():
    (u, y, z), *_ = proxqp.attempts(Program(np.ones(2), -np.ones(2), np.ones(2)))
    np.testing.assert_allclose(u, [-1, -1], atol=1e-6)
    assert y.size == z.size == 0


@pytest.mark.parametrize("name", ["attempts", "WarmStart"])
def test_a_back_end_is_these_two_names(name):
    assert callable(getattr(proxqp, name))
