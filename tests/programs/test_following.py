"""The law's program near singularities: an answer always, and the optimum to the last digits."""

import numpy as np
import pytest
from scipy.optimize import lsq_linear

from hitjoints.hitting.laws import QpLaw
from hitjoints.programs.following import PROGRESS, following

SIZES = (1e-12, 1e-10, 1e-9, 3e-9, 1e-8, 3e-8, 1e-7, 3e-7, 1e-6, 1e-5, 1e-4)


def case(rng, least):
    """A Jacobian of that least singular value, a field of three kinds, a posture and bounds."""
    U, _, Vt = np.linalg.svd(rng.normal(size=(3, 7)), full_matrices=False)
    J = U * np.array([0.8, 0.5, least]) @ Vt
    f = U @ (rng.normal(size=3) * [1.0, 1.0, rng.choice([0.0, least, 1.0])])
    bounds = -rng.uniform(0.3, 2.0, 7), rng.uniform(0.3, 2.0, 7)
    return J, f, 2.0 * rng.normal(size=7), *bounds


def kkt_error(J, f, posture, lower, upper, qd, s):
    """What is left of the optimality conditions by the best multipliers of the right signs.

    In s = room t, room being what the joints leave s, and rows of size one.
    """
    U, sizes, Vt = np.linalg.svd(J, full_matrices=False)
    along = f @ U
    swing = np.abs(Vt) @ np.maximum(upper, -lower)
    room = min(1.0, np.min(sizes * swing / np.maximum(np.abs(along), 1e-300)))
    rows = np.column_stack((sizes[:, None] * Vt, -room * along))
    rows /= np.linalg.norm(rows, axis=1)[:, None]
    x = np.append(qd, s / room)
    low, high = np.append(lower, 0.0), np.append(upper, 1.0 / room)
    slope = np.append(qd - posture, room * (s - PROGRESS))
    push = np.eye(8)[:, x >= high - 1e-9], -np.eye(8)[:, x <= low + 1e-9]
    columns = np.hstack((rows.T, *push))
    least = np.concatenate((np.full(3, -np.inf), np.zeros(columns.shape[1] - 3)))
    found = lsq_linear(columns, -slope, bounds=(least, np.inf), tol=1e-15)
    size = 1.0 + np.abs(found.x[:3]).max(initial=0.0)
    assert (x >= low).all()
    assert (x <= high + 1e-12).all()
    return np.abs(rows @ x).max(), np.abs(columns @ found.x + slope).max() / size


@pytest.mark.parametrize("least", SIZES)
def test_the_law_has_the_optimum_however_near_the_singularity(least):
    rng = np.random.default_rng(61)
    for _ in range(40):
        J, f, posture, lower, upper = case(rng, least)
        motion = QpLaw(7)(J, f, posture, lower, upper)
        assert motion is not None
        rows, slope = kkt_error(J, f, posture, lower, upper, *motion)
        assert rows <= 1e-7  # of rows of size one
        assert slope <= 1e-4
        assert np.linalg.norm(J @ motion.qd - motion.scaling * f) <= 1e-7


def test_most_answers_are_exact():
    rng, errors = np.random.default_rng(62), []
    for _ in range(200):
        given = case(rng, rng.choice(SIZES))
        errors.append(kkt_error(*given, *QpLaw(7)(*given)))
    rows, slopes = np.array(errors).T
    assert np.quantile(rows, 0.97) <= 1e-12
    assert np.quantile(slopes, 0.97) <= 1e-8


def test_a_direction_without_any_motion_stops_the_arm_and_round_off_does_not():
    rng = np.random.default_rng(63)
    J, _, posture, lower, upper = case(rng, 0.0)
    U = np.linalg.svd(J)[0]
    stopped = QpLaw(7)(J, U[:, 0] + 0.1 * U[:, 2], posture, lower, upper)
    assert stopped.scaling == 0.0
    np.testing.assert_allclose(J @ stopped.qd, 0.0, atol=1e-12)
    moving = QpLaw(7)(J, 0.1 * U[:, 0] + 1e-9 * U[:, 2], posture, lower, upper)
    assert moving.scaling > 0.1
    assert np.linalg.norm(J @ moving.qd - 0.1 * moving.scaling * U[:, 0]) < 2e-9


def test_a_regular_arm_gets_the_plain_program():
    J, f = np.hstack((np.eye(3), np.zeros((3, 4)))), np.ones(3)
    program = following(J, f, np.zeros(7), -np.ones(7), np.ones(7))
    assert program.unit == 1.0
    np.testing.assert_array_equal(program.terms.A, np.column_stack((J, -f)))
