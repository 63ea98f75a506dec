from fractions import Fraction
from time import thread_time

import numpy as np
import program_corpus as corpus
import pytest

from hitjoints.errors import InfeasibleError
from hitjoints.programs.hitting_speed import build_hitting_speed
from hitjoints.programs.infeasibility import verify
from hitjoints.programs.problem import Program
from hitjoints.programs.solver import show_infeasible, solve

TIME = 5e-3  # s of this thread (machines are shared), for the median and, best of three, for each


def proves(program, y, z):
    """Say in exact arithmetic whether the multipliers, or the box itself, exclude every point."""
    if (program.lower > program.upper).any():
        return True
    y, z = [Fraction(v) for v in y], [Fraction(v) for v in z]
    if min(z, default=Fraction(0)) < 0:
        return False
    weighted = [
        *zip(y, program.A, program.b, strict=True),
        *zip(z, program.C, program.d, strict=True),
    ]
    least = -sum(weight * Fraction(right) for weight, _, right in weighted)
    for j in range(program.n):
        slope = sum(weight * Fraction(row[j]) for weight, row, _ in weighted)
        least += min(slope * Fraction(program.lower[j]), slope * Fraction(program.upper[j]))
    return least > 0


def refused(program):
    """Solve three times; return the error and the shortest time."""
    times = []
    for _ in range(3):
        start = thread_time()
        with pytest.raises(InfeasibleError) as error:
            solve(program)
        times.append(thread_time() - start)
    return error.value, min(times)


def away_from_zero(rng):
    """A straight program whose box leaves no motion along the direction alone, or None."""
    J = corpus.jacobian(rng)
    middle = rng.uniform(-2, 2, J.shape[1])
    width = rng.uniform(0, 0.5, J.shape[1])
    program = build_hitting_speed(J, corpus.direction(rng), middle - width, middle + width, True)
    # Known to be infeasible without a solver: a sideways row that the box keeps from 0.
    ends = program.A * program.lower, program.A * program.upper
    off = np.maximum(np.minimum(*ends).sum(axis=1), -np.maximum(*ends).sum(axis=1))
    return program if off.max() > 1e-6 else None


@pytest.mark.parametrize("make", [corpus.contradiction, corpus.empty_box, away_from_zero])
def test_infeasible_programs_are_refused_with_a_proof_in_time(make):
    rng = np.random.default_rng(11)
    programs = [p for p in (make(rng) for _ in range(300)) if p is not None]
    assert len(programs) >= 200
    times = []
    for program in programs:
        error, seconds = refused(program)
        assert proves(program, error.data["y"], error.data["z"])
        assert error.data["shortfall"] > 0
        times.append(seconds)
    assert np.median(times) < TIME
    assert max(times) < TIME


def test_straight_programs_are_solved_or_refused_with_a_proof():
    rng = np.random.default_rng(12)
    proofs = []
    for _ in range(400):
        J = corpus.jacobian(rng)
        lower = rng.uniform(-0.6, 0.3, J.shape[1])
        upper = lower + rng.uniform(0, 0.8, J.shape[1])
        program = build_hitting_speed(J, corpus.direction(rng), lower, upper, True)
        try:
            assert solve(program).residuals.worst <= 1e-8
        except InfeasibleError as error:
            proofs.append(proves(program, error.data["y"], error.data["z"]))
    assert all(proofs)
    assert 50 < len(proofs) < 350


def test_the_proof_names_the_bounds_the_row_and_the_rows():
    one = np.ones(2)
    crossed = show_infeasible(Program(one, np.array([0.0, 0.5]), np.array([1.0, 0.25])))
    assert crossed.reason == "the bounds leave no room for variable 1 (lower 0.5 > upper 0.25)"
    assert crossed.margin == 0.25
    row = show_infeasible(Program(one, -one, one, A=np.ones((1, 2)), b=np.array([2.5])))
    assert row.reason == "within the bounds, equality 0 is missed by 0.5 or more"
    assert row.shortfall == pytest.approx(0.5)
    rows = show_infeasible(
        Program(
            one, -one, one,
            A=np.array([[1.0, 0.0], [1.0, 1.0]]), b=np.array([0.0, 0.5]),
            C=np.array([[3.0, 1.0], [0.0, 1.0]]), d=np.array([5.0, 0.1]),
        )
    )  # fmt: skip
    assert "equality 0, equality 1 and inequality 1 exclude each other" in rows.reason
    assert rows.shortfall == pytest.approx(0.4 / 3)
    assert rows.margin > 2 * rows.roundoff


def test_no_proof_against_a_feasible_program():
    rng = np.random.default_rng(13)
    for _ in range(100):
        assert show_infeasible(corpus.feasible(rng)) is None
    assert show_infeasible(Program(np.ones(2), np.zeros(2), np.zeros(2))) is None


def test_multipliers_that_prove_nothing_are_refused():
    one = np.ones(2)
    p = Program(one, -one, one, A=np.ones((1, 2)), b=np.array([2.5]), C=np.eye(2), d=one)
    assert verify(p, np.array([-1.0]), np.zeros(2)) is not None
    assert verify(p, np.array([1.0]), np.zeros(2)) is None
    assert verify(p, np.zeros(1), -one) is None
    assert verify(p, np.array([np.nan]), np.zeros(2)) is None


def test_a_row_at_the_very_end_of_its_reach_is_not_infeasible_by_round_off():
    rng = np.random.default_rng(14)
    for _ in range(200):
        row, upper = rng.normal(size=7), rng.uniform(0.5, 3, 7)
        b = np.array([np.abs(row) @ upper]) * (1 + rng.choice([-1e-15, 0, 1e-15]))
        found = solve(Program(np.zeros(7), -upper, upper, np.eye(7), row[None], b))
        np.testing.assert_allclose(found.x, np.sign(row) * upper, rtol=1e-6)
