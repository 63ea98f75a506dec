import sys
import time

import numpy as np
import pytest

from benchmarks.contest import Peer, contest, near
from benchmarks.harness import Figure, Remark, Row, compare

RIGHT = [1.0, 2.0, 4.0]


def answering(answer, delay=0.0):
    def work():
        time.sleep(delay)
        return answer

    return work


def meet(peer, ours=0.002):
    sides = ("ours", answering(RIGHT, ours), 3)
    (row,) = contest("a task", sides, [peer], near(RIGHT, 1e-6), repeats=3)
    return row


def test_a_slower_peer_has_a_row():
    row = meet(Peer("slow", lambda: answering(RIGHT, 0.02), 3, ">= 2"))
    assert isinstance(row, Row)
    assert 2 < row.low <= row.ratio <= row.high
    assert row.ratio == pytest.approx(row.peer_time / row.ours_time, rel=0.5)
    assert row.contest
    assert row.verdict == "met"


def test_a_faster_peer_is_said_to_be_faster():
    row = meet(Peer("quick", lambda: answering(RIGHT, 0.0), 3, ">= 1"), ours=0.02)
    assert row.ratio < 0.5
    assert row.verdict == "NOT met, peer is faster"


def test_times_are_per_unit_of_work():
    row = meet(Peer("less work", lambda: answering(RIGHT[:1], 0.002), 1))
    assert 2 < row.ratio < 4


def test_a_peer_with_a_wrong_answer_is_not_timed():
    calls = []

    def work():
        calls.append(1)
        return [1.0, 2.0, 4.002]

    row = meet(Peer("sloppy", lambda: work, 3))
    assert isinstance(row, Remark)
    assert row.verdict.startswith("not timed, its answer is wrong: off by 0.0005")
    assert len(calls) == 1


def test_an_answer_that_is_not_a_number_is_wrong():
    assert isinstance(meet(Peer("lost", lambda: answering([np.nan] * 3), 3)), Remark)


def test_our_own_wrong_answer_stops_the_benchmark():
    with pytest.raises(AssertionError, match="a task, ours: off by"):
        contest("a task", ("ours", answering([1.0, 2.0, 3.0]), 3), [], near(RIGHT, 1e-6))


def test_a_missing_peer_is_skipped_and_said(monkeypatch):
    monkeypatch.setitem(sys.modules, "pybullet", None)

    def make():
        import pybullet

        return pybullet.connect

    row = meet(Peer("PyBullet", make, 3))
    assert row == Remark("a task", "PyBullet", "skipped: pybullet is not installed")


def test_a_peer_that_fails_is_not_timed():
    row = meet(Peer("broken", lambda: lambda: 1 / 0, 3))
    assert row.verdict == "not timed, it failed: ZeroDivisionError: division by zero"


def test_costs_and_figures_have_verdicts_too():
    row = compare(
        "start", ("a", answering(0, 0.01), 1), ("b", answering(0), 1), meaning="cost", repeats=1
    )
    assert row.verdict == "peer is faster"
    assert Figure("time", 3.0, "s", "<= 2").verdict == "NOT met"
    assert Figure("time", 3.0, "s").verdict == ""
