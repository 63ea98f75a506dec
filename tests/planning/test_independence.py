"""The agreement of a plan's searches is evidence only while they share nothing."""

import numpy as np
import pytest

from hitjoints.planning import joint_plan
from hitjoints.planning.planner import plan
from hitjoints.planning.search import groups


def test_hints_are_dealt_out_once():
    hints = np.arange(22.0).reshape(11, 2)
    dealt = groups.dealt(hints)
    assert len(dealt) == groups.GROUPS
    rows = np.concatenate(dealt)
    np.testing.assert_array_equal(rows[np.argsort(rows[:, 0])], hints)


@pytest.mark.parametrize(
    ("name", "hit", "options"),
    [
        ("iiwa14", ([0.5, 0.3, 0.5], [0, 1, 0], 2.0), {"objective": "rebound", "flux": 1.0}),
        # Few configurations of the elbow point away: random samples miss them all.
        ("panda", ([0.3, 0.2, 0.6], [0.2, -0.6, 0.8], 2.0), {"objective": "inertia"}),
    ],
)
def test_no_two_groups_start_from_the_same(arm, monkeypatch, name, hit, options):
    seen, search = [], joint_plan.search

    def spy(problem, sampler, seed, hints=()):
        seen.append(hints)
        return search(problem, sampler, seed, hints)

    monkeypatch.setattr(joint_plan, "search", spy)
    plan(arm(name), *hit, joints=[6], certificate=False, **options)
    for hints in seen:
        rows = [tuple(row) for part in hints for row in np.atleast_2d(part)]
        assert len(rows) == len(set(rows))
    if "flux" in options:
        assert sum(map(len, seen[-1])) > 1


def test_an_optimum_that_four_searches_missed(arm):
    """Every search used to end at 0.22673 m/s with seed 1; others found more."""
    hit = (
        (0.005349677440499499, 0.02979580223905958, 0.8987504584668469),
        (0.017309850667636094, 0.5845135165041645, 0.8111993084894734),
        2.333,
    )
    options = {"joints": [6], "objective": "straight-flux", "certificate": False}
    for seed in (1, 2, 5):
        best = plan(arm("xarm7"), *hit, seed=seed, **options).best
        assert best.straight_flux == pytest.approx(0.2277425639, rel=2e-4)


def test_agreeing_counts_searches_that_found_the_answer(arm):
    robot, rng = arm("xarm7"), np.random.default_rng(3)
    from hitjoints.planning.candidates import evidence_of

    found = groups.Found(
        rng.normal(size=(2, robot.n)),
        np.log([2.0, 1.5]),
        10,
        5,
        np.zeros((0, robot.n)),
        2,
        np.log([1.5, 1.5, 1.5, 1.5]),
    )
    assert evidence_of(found)["agreeing"] == 0
