"""The threads that are kept: same bits however many, from many callers, and after a fork."""

import multiprocessing
import threading
from concurrent.futures import ThreadPoolExecutor

import arms
import numpy as np
import pytest

import hitjoints as hj
from hitjoints.errors import InputError
from hitjoints.kernels import build_kernel
from hitjoints.kernels.tape import rows
from hitjoints.kernels.tape.rows import ALIGNMENT, over_rows

H = np.array([0.0, 0.6, 0.8])
EAGER = ALIGNMENT * 1e6  # ns a row would take for every aligned piece to be worth a thread


@pytest.fixture
def eager(monkeypatch):
    """Make every piece as short as it can be, so that threads are used for few rows."""
    monkeypatch.setattr(rows, "WORTH_A_THREAD", 1.0)


@pytest.mark.parametrize("backend", ["llvm", "numpy"])
def test_threads_do_not_change_a_bit(backend, eager):
    kernel = build_kernel(arms.iiwa14(), [(6, (0, 0, 0))], ("inertia", "gradient"), backend)
    q = arms.configurations(arms.iiwa14(), 30_011)
    whole = kernel(q, H, threads=1)
    for threads in (2, 3, 7, None):
        again = kernel(q, H, threads=threads)
        assert all(np.array_equal(whole[name], again[name], equal_nan=True) for name in whole)


@pytest.mark.parametrize("threads", [1, 2, 5, None])
@pytest.mark.parametrize("count", [1, ALIGNMENT, ALIGNMENT + 1, 10 * ALIGNMENT + 17])
def test_every_row_is_done_once(count, threads):
    done, lock = np.zeros(count, dtype=int), threading.Lock()

    def work(start, stop):
        with lock:
            done[start:stop] += 1

    over_rows(work, count, threads, EAGER)
    assert (done == 1).all()


def test_few_rows_stay_in_the_calling_thread():
    seen = set()
    over_rows(lambda start, stop: seen.add(threading.get_ident()), 20_000, 4, 10.0)
    assert seen == {threading.get_ident()}


def test_nobody_is_asked_to_help_with_a_few_pieces_unless_it_is_wished(monkeypatch):
    monkeypatch.setattr(rows, "available_cpus", lambda: 8)
    started = []

    def no_pool():
        started.append(1)
        raise InputError("pool", None, "not wanted")

    monkeypatch.setattr(rows, "_pool", no_pool)
    over_rows(lambda start, stop: None, 3 * ALIGNMENT, None, EAGER)
    assert not started
    for count, threads in ((5, None), (2, 2)):
        with pytest.raises(InputError):
            over_rows(lambda start, stop: None, count * ALIGNMENT, threads, EAGER)


def test_an_error_in_a_piece_reaches_the_caller_and_the_threads_live_on():
    def work(start, stop):
        if start == 3 * ALIGNMENT:
            raise InputError("q", start, "not this one")

    for _ in range(5):
        with pytest.raises(InputError, match="not this one"):
            over_rows(work, 20 * ALIGNMENT, 4, EAGER)
    over_rows(lambda start, stop: None, 20 * ALIGNMENT, 4, EAGER)


def test_many_callers_at_once(eager):
    robot = hj.load_robot("iiwa14")
    q = np.random.default_rng(0).uniform(robot.lower, robot.upper, (20_000, 7))
    expected = hj.directional_inertia(robot, q, 6, H)
    with ThreadPoolExecutor(12) as pool:
        answers = pool.map(lambda _: hj.directional_inertia(robot, q, 6, H), range(40))
        assert all(np.array_equal(expected, answer) for answer in answers)


def _in_child(robot, q, expected):
    raise SystemExit(0 if np.array_equal(hj.directional_inertia(robot, q, 6, H), expected) else 1)


def test_a_forked_child_has_threads_of_its_own(eager):
    robot = hj.load_robot("iiwa14")
    q = np.random.default_rng(0).uniform(robot.lower, robot.upper, (20_000, 7))
    expected = hj.directional_inertia(robot, q, 6, H)
    child = multiprocessing.get_context("fork").Process(target=_in_child, args=(robot, q, expected))
    child.start()
    child.join(30)
    assert child.exitcode == 0


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("count", [3, 40_000])
def test_a_number_that_is_not_finite_is_found_wherever_it_is(bad, count):
    robot = hj.load_robot("iiwa14")
    for row, joint in ((0, 0), (count // 2, 6), (count - 1, 3)):
        q = np.zeros((count, 7))
        q[row, joint] = bad
        for call in (hj.directional_inertia, hj.directional_inertia_gradient, hj.hitting_speed):
            with pytest.raises(InputError, match="every joint position must be finite"):
                call(robot, q, 6, H)
