"""The same program gives the same bits, wherever in memory its numbers lie."""

import numpy as np
import pytest

import hitjoints as hj
from hitjoints.programs.active_set import eliminated
from hitjoints.programs.hitting_speed import solve_hitting_speed

TRIES, PROGRAMS = 4, 60


def test_the_same_speeds_again_have_the_same_bits(arm):
    """Joint 6 of this arm leaves a direction open: there are many velocities of the same speed."""
    iiwa14, kept = arm("iiwa14"), []
    rng = np.random.default_rng(0)
    for _ in range(PROGRAMS):
        q = rng.uniform(iiwa14.lower, iiwa14.upper)
        J, h = hj.jacobian(iiwa14, q, int(rng.integers(4, 8))), rng.normal(size=3)
        answers = set()
        for _ in range(TRIES):
            kept.append(np.zeros(rng.integers(200)))  # moves what is allocated next
            found = solve_hitting_speed(J, h, iiwa14.velocity_lower, iiwa14.velocity_upper, True)
            answers.add((found.speed, found.qd.tobytes()))
        assert len(answers) == 1


@pytest.mark.parametrize("shape", [(4, 4), (3, 6), (6, 3)])
@pytest.mark.parametrize("rank", [1, 3])
def test_elimination_agrees_with_the_pseudo_inverse(shape, rank):
    rng = np.random.default_rng(1)
    system = rng.normal(size=(shape[0], rank)) @ rng.normal(size=(rank, shape[1]))
    right = system @ rng.normal(size=shape[1])
    assert eliminated(system, right) == pytest.approx(np.linalg.pinv(system) @ right, abs=1e-10)


def test_nothing_to_eliminate():
    assert eliminated(np.zeros((2, 3)), np.zeros(2)).tolist() == [0, 0, 0]
    assert eliminated(np.zeros((0, 2)), np.zeros(0)).tolist() == [0, 0]
