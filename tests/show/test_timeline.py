"""Play, pause, scrub, speed: the time in a motion; and work of which only the latest is done."""

import threading

import pytest

from hitjoints.show.viewer.timeline import Timeline
from hitjoints.show.viewer.worker import Worker

LIMIT = 10  # s


@pytest.fixture
def shown():
    return []


@pytest.fixture
def timeline(shown):
    made = Timeline(shown.append, lambda: shown.append("end"))
    made.load(2.0)
    yield made
    made.stop()


def still(timeline):
    """Let only `tick` move it: its own thread waits."""
    timeline.plays = True


def test_time_passes_as_fast_as_it_is_told(timeline, shown):
    still(timeline)
    timeline.speed = 0.25
    timeline.tick(1.0)
    timeline.speed = 2.0
    timeline.tick(0.5)
    assert shown == [0.25, 1.25]


def test_it_ends_at_the_end_and_begins_again(timeline, shown):
    still(timeline)
    timeline.tick(5.0)
    assert shown == [2.0, "end"]
    assert not timeline.plays
    timeline.tick(1.0)
    assert shown == [2.0, "end"]
    timeline.play()
    assert timeline.time < 2.0
    timeline.pause()


def test_scrubbing_pauses_and_keeps_within_the_motion(timeline, shown):
    still(timeline)
    timeline.scrub(1.5)
    timeline.scrub(9.0)
    timeline.scrub(-1.0)
    assert shown == [1.5, 2.0, 0.0]
    assert not timeline.plays


def test_it_plays_by_itself():
    over, seen = threading.Event(), []
    timeline = Timeline(seen.append, over.set)
    try:
        timeline.load(0.2)
        timeline.play()
        assert over.wait(LIMIT)
        assert seen[-1] == 0.2
        assert sorted(seen) == seen
    finally:
        timeline.stop()


def test_nothing_plays_without_a_motion():
    timeline = Timeline(lambda time: None, lambda: None)
    timeline.play()
    assert not timeline.plays
    timeline.stop()


def test_only_the_latest_is_done():
    worker, done, hold = Worker(), [], threading.Event()
    try:
        worker.ask(lambda: hold.wait(LIMIT), pause=0.0)
        while worker._asked is not None:
            pass
        for number in range(5):
            worker.ask(lambda number=number: done.append(number), pause=0.0)
        assert not worker.wait(0.05)
        hold.set()
        assert worker.wait(LIMIT)
        assert done == [4]
    finally:
        worker.stop()


def test_a_pause_lets_what_is_dragged_come_to_rest():
    worker, done = Worker(), []
    try:
        for number in range(4):
            worker.ask(lambda number=number: done.append(number), pause=0.2)
        assert worker.wait(LIMIT)
        assert done == [3]
    finally:
        worker.stop()


def test_after_a_job_that_fails_the_next_is_done(monkeypatch):
    said = []
    monkeypatch.setattr("sys.excepthook", lambda kind, *_: said.append(kind))
    worker, done = Worker(), []
    try:
        worker.ask(lambda: 1 / 0, pause=0.0)
        assert worker.wait(LIMIT)
        worker.ask(lambda: done.append(1), pause=0.0)
        assert worker.wait(LIMIT)
        assert done == [1]
        assert said == [ZeroDivisionError]
    finally:
        worker.stop()
