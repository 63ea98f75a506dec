"""One target gives the bits of the same row in a batch, on every way through the attempts."""

import threading

import arms
import numpy as np
import pytest

import hitjoints as hj
from hitjoints.kernels import place
from hitjoints.kernels.formulas.chain import Chain
from hitjoints.kernels.ik_starts import one_start, random_starts

CONTACT = (6, (0.01, 0.0, 0.03))


def targets(model, count):
    """Reachable targets, some at the edge of the limits, some out of reach."""
    from hitjoints.kernels import build_kernel

    q = arms.configurations(model, count, 8)
    q[:5] = model.upperPositionLimit
    at = build_kernel(model, [CONTACT], ("position",))(q, np.array([0.0, 0.0, 1.0]))
    at = np.array(at["position"][0])
    at[5:15] *= 3.0
    return at


@pytest.mark.parametrize("make", [arms.iiwa14, arms.panda, arms.xarm7])
@pytest.mark.parametrize("seed", [0, 7, -1])
def test_a_single_target_is_its_row(make, seed):
    model = make()
    at = targets(model, 60)
    whole = place(model, CONTACT, at, seed=seed)
    for i in range(60):
        one = place(model, CONTACT, at[i : i + 1], seed=seed, rows=np.array([i]))
        assert np.array_equal(one.q[0], whole.q[i])
        assert one.error[0] == pytest.approx(whole.error[i], abs=1e-16)
        assert one.solved[0] == whole.solved[i]
    assert whole.solved.mean() > 0.6
    assert not whole.solved[5:15].all()


def test_a_start_is_kept_too():
    model = arms.iiwa14()
    at, start = targets(model, 20), arms.configurations(model, 20, 9)
    whole = place(model, CONTACT, at, start=start)
    for i in range(20):
        rows = np.array([i])
        one = place(model, CONTACT, at[i : i + 1], start=start[i], rows=rows)
        assert np.array_equal(one.q[0], whole.q[i])


@pytest.mark.parametrize("seed", [0, 3, 2**62, -5])
def test_one_start_is_that_of_the_rows(seed):
    chain = Chain.from_model(arms.random_chain(4, 7))
    rows = np.array([0, 1, 999, 2**40, -3])
    for attempt in (0, 5):
        many = random_starts(chain, rows, seed, attempt, 1)
        for k, row in enumerate(rows.tolist()):
            np.testing.assert_array_equal(one_start(chain, row, seed, attempt), many[:, k])


def test_threads_have_numbers_of_their_own():
    robot = hj.load_robot("iiwa14")
    at = targets(robot.model, 40)
    expected = [hj.place_joint(robot, 6, target).q for target in at]
    wrong = []

    def work():
        for target, q in zip(at, expected, strict=True):
            if not np.array_equal(hj.place_joint(robot, 6, target).q, q):
                wrong.append(target)

    threads = [threading.Thread(target=work) for _ in range(5)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not wrong
