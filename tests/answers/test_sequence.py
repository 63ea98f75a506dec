"""Several hits: the map and the graph they are found with, and a goal reached in the engine."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

import hitjoints as hj
from hitjoints.answers.deliverable_map import deliverable_map
from hitjoints.answers.way_graph import WayGraph, arrival_share
from hitjoints.errors import InputError
from hitjoints.hit_setting import HitSetting, RobotChoice

FAR = (0.5, 0.5, 0.4)


def wish(hits=1, **changed):
    given = {
        "contact": 7,
        "position": (0.5, 0.0, 0.4),
        "mass": 1.0,
        "goal": FAR,
        "friction": 0.3,
        "restitution": 0.4,
        "size": (0.1, 0.12, 0.1),
        "spread": {"friction": 0.01, "mass": 0.05},
        "setting": HitSetting(RobotChoice("iiwa14"), hits=hits, margin=0.002),
    }
    return hj.Hit(**(given | changed))


@pytest.fixture(scope="module")
def robot(arm):
    return arm("iiwa14")


@pytest.fixture(scope="module")
def answered(robot):
    return hj.answer(wish(hits=2), robot, simulated=False)


def test_the_map_is_below_the_planned_optimum_and_near_it(robot):
    hit = wish()
    contact, places = robot.contact(7), np.array([[0.5, 0.1, 0.4], [0.5, 0.3, 0.4], [5, 5, 5]])
    h = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0]])
    found = deliverable_map(robot, hit, (contact,), places, h)
    assert (found.flux[2] == 0).all()
    for p in range(2):
        for d in range(2):
            best = hj.plan(
                robot, places[p], h[d], 1.0, joints=[7], objective="deliverable", certificate=False
            ).best
            assert 0.75 * best.deliverable_flux < found.flux[p, d, 0]
            assert found.flux[p, d, 0] <= best.deliverable_flux * (1 + 1e-6)


@pytest.mark.parametrize(("near", "yaw"), [(2e-6, 0.0), (0.05, 0.03), (0.3, 1e-5)])
def test_a_goal_next_to_the_object_does_not_fill_the_memory(robot, near, yaw):
    x, y, z = wish().position
    graph = WayGraph(robot, wish(goal=(x, y + near, z), yaw=yaw))
    assert len(graph.places) < 2500
    np.testing.assert_allclose(graph.places[:2, 1], (y, y + near), atol=1e-12)
    apart = np.linalg.norm(graph.places[2:, None] - graph.places[:2], axis=2)
    assert apart.min() > 1e-6


def test_a_way_takes_the_fewest_hits_and_goes_along_faces(robot):
    graph = WayGraph(robot, wish())
    assert graph.best(1) == []
    way = graph.best(4)
    assert len(way) == 3
    for start, end in pairwise(way):
        leg = graph.leg(start, end)
        assert np.abs((leg.end - leg.start)[:2] @ graph.axes.T).min() < 1e-9
    graph.forbid(way[0], way[1])
    other = graph.best(4)
    assert other != way
    assert len(other) >= 3
    for place in range(2, len(graph.places)):
        graph.forbid(0, place)
    assert graph.best(4) == []


def test_a_goal_a_hair_beside_the_normal_is_hit_for_along_it(robot):
    """From where a box really rests the goal lies a little aside: the hit is turned by that."""
    straight = WayGraph(robot, wish())
    for angle in (1e-3, -1e-3):
        graph = WayGraph(robot, wish(yaw=angle))
        assert len(graph.places) < 1.2 * len(straight.places)
        way = graph.best(4)
        assert len(way) == 3
        leg = graph.leg(way[-2], way[-1])
        way_along = (leg.end - leg.start)[:2]
        heading = np.arctan2(way_along[1], way_along[0]) + leg.yaw
        normal = np.array([np.cos(heading), np.sin(heading)])
        assert np.abs(graph.axes @ normal).max() == pytest.approx(1.0, abs=1e-12)


def test_no_way_passes_the_base(robot):
    opposite = wish(position=(0.5, 0.0, 0.4), goal=(-0.5, 0.0, 0.4), friction=0.01, size=None)
    graph = WayGraph(robot, opposite)
    assert graph.best(1) == []
    way = graph.places[graph.best(6), :2]
    for a, b in pairwise(way):
        points = a + np.linspace(0, 1, 50)[:, None] * (b - a)
        assert np.linalg.norm(points, axis=1).min() > 0.2


def test_the_share_that_arrives_is_that_of_many_hits(robot):
    hit = wish(goal=(0.5, 0.4, 0.4), spread={"friction": 0.03, "mass": 0.1, "restitution": 0.02})
    q = hj.place_joint(robot, 7, hit.position).q[0]
    inertia = hj.directional_inertia(robot, q, 7, hit.direction)
    tried = hj.landing(robot, q, hit, hj.required_speed(inertia, 1.0, hit.flux), samples=4000)
    assert 0.4 < tried.within < 0.95
    told = arrival_share(hit, np.array([0.4]), np.array([inertia]))
    assert told[0] == pytest.approx(tried.within, abs=0.03)


def test_what_one_hit_cannot_two_can(answered):
    assert answered.verdict == "sendable"
    assert len(answered.hits) == 2
    first, second = answered.hits
    assert first.hit.goal == pytest.approx(second.hit.position)
    assert second.hit.goal == pytest.approx(FAR)
    assert (first.swing.joints.q[-1] == second.swing.q0).all()
    assert answered.swing is first.swing
    assert answered.arrives == first.landing.within * second.landing.within
    told = answered.as_dict()
    assert [one["flux"] for one in told["hits"]] == [first.swing.flux, second.swing.flux]
    assert told["hit"]["how"]["hits"] == 2
    assert "2 hits" in answered.words


def test_a_no_to_one_hit_names_the_way_of_two(robot, answered):
    no = hj.answer(wish(), robot, simulated=False)
    assert no.verdict == "no"
    assert no.nearest.hits == 2
    assert no.nearest.way[0] == pytest.approx(answered.hits[0].hit.goal)
    assert "ask with hits = 2" in no.words
    assert no.as_dict()["hits"] is None


def test_it_arrives_in_the_engine_each_hit_from_where_the_last_one_ended(answered):
    ended = answered
    for _ in range(2):
        first = ended.hits[0] if ended.hits else ended
        told = hj.simulate(first.swing, restitution=0.4, friction=0.3, size=tuple(first.hit.size))
        place = first.hit.position + told.travel * first.hit.direction
        if np.linalg.norm(place - FAR) < 0.05:
            break
        left = ended.left(place)
        assert left.setting.hits == 1
        ended = hj.answer(left, answered.robot, simulated=False)
        assert ended.verdict == "sendable"
    assert place == pytest.approx(FAR, abs=0.02)


def test_several_hits_need_a_goal(robot):
    hit = hj.Hit(7, (0.5, 0.2, 0.4), (0, 1, 0), 1.0, 0.2, setting=HitSetting(hits=2))
    with pytest.raises(InputError, match="hits = 2: several hits need a goal"):
        hj.answer(hit, robot)
    with pytest.raises(InputError, match="hits = 0: at least 1"):
        HitSetting(hits=0)


def test_no_way_at_all_is_said(robot):
    hit = wish(hits=2, goal=(0.5, 9.0, 0.4))
    found = hj.answer(hit.changed(setting=replace(hit.setting, hits=2)), robot, simulated=False)
    assert found.verdict == "no"
    assert "no way of at most 2 hits was found" in found.reason
    assert found.hits == ()
    assert found.nearest.hits is None
