"""The breakdown of public calls names their parts as they are today."""

import re

from benchmarks import where_time_goes


def test_every_call_is_told_with_its_parts(monkeypatch):
    def once(work, repeats=0, times=0):
        work()
        return 1e-6

    monkeypatch.setattr(where_time_goes, "least", once)
    monkeypatch.setattr(where_time_goes, "ROWS", 20_000)
    lines = where_time_goes.table().splitlines()
    calls = [line for line in lines if line.startswith("| **")]
    assert len(calls) >= 10
    for name in ("Evaluator", "directional_inertia", "place_joint", "step", "plan", "rollouts"):
        assert any(name in line for line in calls)
    assert all(re.search(r"\d+%", line) for line in lines[2:] if line not in calls)
