"""A new objective is one class, and one line in the registry."""

import numpy as np
import pytest

import hitjoints as hj
from hitjoints.errors import UnknownNameError
from hitjoints.planning.objectives import registry
from hitjoints.planning.objectives.objective import Objective
from hitjoints.planning.planner import plan


class Nearest(Objective):
    """A dummy: the least inertia."""

    ranked_by = "inertia"

    def screen(self, seen):
        return np.log(seen.mobility)

    def formula(self, seen):
        return seen.mobility, [by / seen.mobility for by in seen.mobility_gradient]


def test_a_dummy_objective_is_planned_with(arm, monkeypatch):
    monkeypatch.setitem(registry.OBJECTIVES, "lightest", Nearest)
    hit = ([0.5, 0.3, 0.5], [0, 1, 0], 2.0)
    options = {"joints": [6], "certificate": False}
    light, heavy = (
        plan(arm("iiwa14"), *hit, objective=name, **options).best
        for name in ("lightest", "inertia")
    )
    assert light.inertia < 0.5 * heavy.inertia
    q = hj.place_joint(arm("iiwa14"), 6, np.tile(hit[0], (200, 1))).q
    away = [row for row in q if (hj.position(arm("iiwa14"), row, 7) - hit[0]) @ hit[1] < 0]
    assert light.inertia <= hj.directional_inertia(arm("iiwa14"), away, 6, hit[1]).min() + 1e-9


def test_an_unknown_name_lists_the_choices(arm):
    with pytest.raises(UnknownNameError) as caught:
        plan(arm("iiwa14"), [0.5, 0.3, 0.5], [0, 1, 0], 2.0, objective="inertial")
    for name in registry.OBJECTIVES:
        assert name in str(caught.value)
