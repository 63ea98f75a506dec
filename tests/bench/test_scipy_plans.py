"""The searches that plans are timed against, and what is said of them."""

import numpy as np
import pytest

from benchmarks.planning import DIRECTION, JOINT, MASS, POSITION, judged, search
from tests.oracles import scipy_plans
from tests.oracles.scipy_plans import SciPyPlanner


def test_differential_evolution_finds_a_plan_and_none_better(monkeypatch, arm):
    monkeypatch.setattr(scipy_plans, "GENERATIONS", 40)
    robot = arm("iiwa14")
    planner = SciPyPlanner(robot, JOINT, np.array(POSITION), DIRECTION, MASS, away=True)
    best = search(robot, "inertia", certificate=False)
    assert 0.8 * best < planner.by_evolution("inertia") < 1.002 * best


@pytest.mark.parametrize(
    ("values", "told"),
    [([4.0], "100"), ([4.0, None], "0 to 100"), ([3.9996, 4.0], "99.99 to 100")],
)
def test_a_search_is_named_by_what_it_reaches(values, told):
    peer = judged("method", lambda: values, 4.0)
    assert peer.name == f"SciPy method: {told} % of ours"
    assert peer.units == len(values)
    assert peer.make()() == values
