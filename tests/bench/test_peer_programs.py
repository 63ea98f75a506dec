"""Every solver that is installed finds the optimum that ours certifies."""

import numpy as np
import pytest

from benchmarks.peers import osqp, programs
from benchmarks.programs import (
    LINEAR,
    QUADRATIC,
    REPEATED,
    arguments,
    eq12,
    optimal,
    straight_speed,
)
from hitjoints.programs.solver import solve

MODULES = {
    programs.Highs: "scipy",
    programs.Daqp: "daqp",
    programs.Quadprog: "quadprog",
    programs.Clarabel: "clarabel",
    programs.ProxQP: "proxsuite",
    programs.ProxQPInPlace: "proxsuite",
    osqp.QpSolvers: "qpsolvers",
    osqp.OsqpInPlace: "osqp",
}


@pytest.fixture
def configurations(arm):
    robot = arm("iiwa14")
    return np.random.default_rng(2).uniform(robot.lower, robot.upper, (10, robot.n))


def answers(solver, many):
    pytest.importorskip(MODULES[solver])
    run = solver()
    return [run(*arguments(program)) for program in many]


@pytest.mark.parametrize("solver", LINEAR.values())
def test_linear_programs(arm, configurations, solver):
    many = [straight_speed(arm("iiwa14"), q) for q in configurations]
    assert optimal(many)(answers(solver, many)) == ""


@pytest.mark.parametrize("solver", [*QUADRATIC.values(), programs.ProxQPInPlace])
def test_quadratic_programs(arm, configurations, solver):
    if solver is programs.ProxQPInPlace:  # made for programs that differ little
        configurations = configurations[0] + 1e-3 * configurations
    many = [eq12(arm("iiwa14"), q) for q in configurations]
    assert optimal(many)(answers(solver, many)) == ""


def test_all_solvers_are_tested():
    named = {*LINEAR.values(), *QUADRATIC.values(), *REPEATED.values()}
    assert named == set(MODULES)


def test_what_is_not_optimal_is_refused(arm, configurations):
    many = [straight_speed(arm("iiwa14"), q) for q in configurations]
    right = [solve(program).x for program in many]
    check = optimal(many)
    assert check(right) == ""
    assert check([None, *right[1:]]) == "a program is not solved"
    assert check([0 * right[0], *right[1:]]).startswith("off by 1 ")
    assert check([2 * right[0], *right[1:]]).startswith("rows or bounds missed by")
