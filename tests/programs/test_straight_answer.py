"""The closed form of the straight speed: its bits, its certificate, and when there is none."""

import numpy as np
import program_corpus as corpus
import pytest

from hitjoints.programs.hitting_speed import build_hitting_speed, solve_hitting_speed
from hitjoints.programs.problem import primal_residual
from hitjoints.programs.solver import solve
from hitjoints.programs.straight_answer import certified_motion

COUNT = 300


def programs(seed, count=COUNT):
    rng = np.random.default_rng(seed)
    for _ in range(count):
        J = corpus.jacobian(rng)
        yield J, corpus.direction(rng), *corpus.velocity_box(rng, J.shape[1])


def test_the_closed_form_reaches_what_the_solver_does_and_keeps_the_rows():
    for J, h, lower, upper in programs(1):
        speed, qd, primal, gap = certified_motion(J, h, lower, upper)
        program = build_hitting_speed(J, h, lower, upper, straight=True)
        reach = np.abs(h @ J) @ np.maximum(-lower, upper)
        found = solve(program)
        np.testing.assert_allclose(speed, -program.objective(found.x), rtol=0, atol=1e-10 * reach)
        assert primal_residual(program, qd) <= 1e-11
        assert max(primal, gap) <= 1e-12
        assert ((lower <= qd) & (qd <= upper)).all()


def test_a_spherical_shoulder_is_answered_in_closed_form():
    # Three axes through one point: their columns are dependent in every configuration.
    rng = np.random.default_rng(5)
    for _ in range(COUNT):
        reach = rng.normal(size=3)
        J = np.column_stack([np.cross(rng.normal(size=3), reach) for _ in range(3)])
        J = np.hstack((J, rng.normal(size=(3, int(rng.integers(0, 4))))))
        ones = np.ones(J.shape[1])
        assert certified_motion(J, corpus.direction(rng), -ones, ones) is not None


def test_lists_and_arrays_have_the_same_answer():
    for J, h, lower, upper in programs(3, 20):
        arrays = solve_hitting_speed(J, h, lower, upper, straight=True)
        lists = solve_hitting_speed(
            J.tolist(), tuple(h), lower.tolist(), upper.tolist(), straight=True
        )
        assert arrays.speed == lists.speed
        assert (arrays.qd == lists.qd).all()


@pytest.mark.parametrize(
    "change",
    [
        {0: np.full((3, 3), np.nan)},
        {1: np.zeros(3)},
        {1: np.full(3, np.inf)},
        {2: np.full(3, 2.0)},  # above the upper limits
        {3: np.full(3, -np.inf)},
        {2: np.full(3, 0.5)},  # no velocity of this box is straight
        {0: np.eye(3, dtype=np.float32)},
        {1: [1.0, 0.0, 0.0]},
        {3: np.ones(4)},
    ],
)
def test_what_has_no_answer_in_closed_form_gets_none(change):
    given = [np.diag([1.0, 2.0, 3.0]), np.array([1.0, 0.0, 0.0]), -np.ones(3), np.ones(3)]
    for place, value in change.items():
        given[place] = value
    assert certified_motion(*given) is None
