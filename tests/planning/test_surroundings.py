"""Plans that leave room, and their starts."""

import re

import numpy as np
import pytest

import hitjoints as hj
from hitjoints.planning.room.shapes import Scene

HIT = ([0.5, 0.3, 0.5], [0, 1, 0], 2.0)


@pytest.fixture(scope="module")
def robot():
    return hj.load_robot("iiwa14")


def test_the_clearance_is_reported(robot):
    around = hj.Surroundings((0.1, 0.1, 0.1), 0.1)
    best = hj.plan(robot, *HIT, joints=[6], certificate=False, surroundings=around).best
    direct = hj.clearance(robot, best.q, 6, HIT[1], (0.1, 0.1, 0.1), 0.1, approach=0.1)
    assert best.clearance["least"] == pytest.approx(direct.least)
    assert set(best.clearance["closest"]) == {"object", "table", "itself"}


def test_a_margin_is_kept_at_a_price(robot):
    room = (0.15, 0.15, 0.15), 0.1
    free = hj.plan(robot, *HIT, joints=[6], certificate=False).best
    before = hj.clearance(robot, free.q, 6, HIT[1], *room, approach=0.1)
    assert before.least < 0.1
    around = hj.Surroundings(*room, margin=0.1)
    kept = hj.plan(robot, *HIT, joints=[6], certificate=False, surroundings=around).best
    assert kept.clearance["least"] >= 0.1
    assert 0.8 * free.inertia < kept.inertia < free.inertia


def test_a_margin_that_nothing_keeps(robot):
    around = hj.Surroundings(table_height=0.6, margin=0.0)
    planned = hj.plan(robot, *HIT, joints=[6], certificate=False, surroundings=around)
    assert planned.best is None
    reason = planned.candidates[0].reason
    assert "is accepted: margin of 0 m not kept: link_" in reason
    assert "and table come within -" in reason


def test_a_margin_that_is_too_much_says_which_pair_and_how_near(robot):
    far = hj.Surroundings(margin=0.3)
    planned = hj.plan(robot, *HIT, joints=[7], certificate=False, surroundings=far)
    reason = planned.candidates[0].reason
    found = re.search(r"margin of 0.3 m not kept: (\S+) and (\S+) come within (\S+) m", reason)
    assert 0.05 < float(found[3]) < 0.3
    assert {found[1], found[2]} <= {name for pair in robot_links(robot) for name in pair}


def robot_links(robot):
    return Scene(robot).pairs


def test_the_start_leads_to_the_hit(robot):
    planned = hj.plan(robot, *HIT, joints=[6], certificate=False, start=True)
    start = planned.start
    assert start.feasible
    np.testing.assert_array_equal(start.path[-1], planned.best.q)
    behind = np.array(HIT[0]) - start.run_up * np.array(HIT[1])
    np.testing.assert_allclose(start.position, behind, atol=1e-4)
    assert planned.as_dict()["start"]["q"] == start.q.tolist()


def test_the_start_is_planned_for_the_flux(robot):
    planned = hj.plan(robot, *HIT, joints=[7], flux=0.3, certificate=False, start=True)
    wanted = hj.required_speed(planned.best.inertia, 2.0, 0.3)
    assert planned.start.speed == pytest.approx(wanted)


def test_bad_margin():
    with pytest.raises(hj.InputError, match="margin"):
        hj.Surroundings(margin=float("nan"))


def test_hints_are_searched_from_and_change_no_optimum(robot):
    plain = hj.plan(robot, *HIT, joints=[6], certificate=False).best
    near = hj.place_joint(robot, 6, np.tile(HIT[0], (8, 1)), seed=9).q
    hinted = hj.plan(robot, *HIT, joints=[6], certificate=False, hints={6: near}).best
    assert hinted.inertia == pytest.approx(plain.inertia, rel=1e-4)
    with pytest.raises(hj.InputError, match="hints"):
        hj.plan(robot, *HIT, joints=[6], hints={6: [[0, 0]]})


def test_a_robot_without_shapes_has_plans_but_no_clearance(robot, tmp_path):
    path = tmp_path / "bare.urdf"
    path.write_text(re.sub(r"<collision>.*?</collision>", "", robot.xml, flags=re.S))
    bare = hj.load_robot(path)
    best = hj.plan(bare, *HIT, joints=[6], certificate=False, surroundings=hj.Surroundings()).best
    assert "no collision shapes" in best.clearance["not_known"]
    with pytest.raises(hj.ModelError, match="no collision shapes"):
        hj.plan(bare, *HIT, joints=[6], surroundings=hj.Surroundings(margin=0.01))
