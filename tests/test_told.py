"""Results say themselves in a line, and in a notebook in a small table."""

from xml.etree import ElementTree

import numpy as np
import pytest

import hitjoints as hj
from hitjoints.told import brief


@pytest.fixture(scope="module")
def results(arm):
    robot = arm("iiwa14")
    hit = hj.Hit(
        7, (0.5, 0.2, 0.4), mass=1.0, goal=(0.5, 0.3, 0.4), friction=0.3, restitution=0.4,
        spread={"friction": 0.02},
    )  # fmt: skip
    answer = hj.answer(hit, robot)
    h, swing = hit.direction, answer.swing
    no = hj.plan(robot, (5, 5, 5), h, 1.0, joints=[7], certificate=False)
    return {
        "robot": robot,
        "hit": hit,
        "goal": hit.changed(contact=None),
        "answer": answer,
        "plan": answer.plan,
        "candidate": answer.plan.best,
        "no plan": no,
        "refusal": no.candidates[0],
        "start": answer.plan.start,
        "swing": swing,
        "landing": answer.landing,
        "simulation": answer.simulated,
        "rest": answer.simulated.rest,
        "rollout": hj.rollout(robot, hit),
        "placement": hj.place_joint(robot, 7, np.tile(hit.position, (20, 1))),
        "clearance": hj.clearance(robot, robot.home, 7, h),
        "posture": hj.posture(robot, robot.home, 6, h, certificate=False),
        "elastic": hj.elastic_impact(robot, swing.q_hit, 7, h, 1.0, 0.5, 0.5, 0.01),
    }


def test_they_are_short(results):
    for name, result in results.items():
        told = repr(result)
        assert "\n" not in told, name
        assert len(told) < 250, name
        assert told.startswith(f"{type(result).__name__}("), name
        assert "nan" not in told, name


def test_their_tables_are_well_formed_and_small(results):
    for name, result in results.items():
        text = result._repr_html_()
        table = ElementTree.fromstring(text)
        assert table.tag == "table", name
        assert 1 <= len(table.findall("./tbody/tr")) < 40, name
        assert len(text) < 6000, name


def test_they_say_what_counts(results):
    assert "to (0.5, 0.3, 0.4) m, flux" in repr(results["hit"])
    assert "any joint" in repr(results["goal"])
    assert "sendable" in repr(results["answer"])
    assert "no joint can do it" in repr(results["no plan"])
    assert "unreachable" in repr(results["refusal"])
    assert "in 100 of 100" in repr(results["landing"])
    assert "array of 20 x 7" in repr(results["placement"])


def test_what_is_not_safe_in_html_is_escaped(results):
    odd = results["refusal"].__class__(7, "<script> & 'more'")
    assert "<script>" not in odd._repr_html_()
    ElementTree.fromstring(odd._repr_html_())


@pytest.mark.parametrize(
    ("value", "words"),
    [
        (None, "-"),
        (True, "yes"),
        (1 / 3, "0.3333"),
        ([], "()"),
        (np.zeros((3, 4)), "array of 3 x 4"),
        (list(range(20)), "20 of them"),
        ({"a": 1.0, "b": None}, "a 1, b -"),
        ({}, "-"),
        ("x" * 999, None),
    ],
)
def test_values_are_told_briefly(value, words):
    told = brief(value)
    assert told == words if words is not None else len(told) < 200
