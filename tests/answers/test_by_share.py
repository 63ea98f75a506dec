"""The objective "landing": no joint, and no configuration, makes more objects arrive."""

from dataclasses import replace

import numpy as np
import pytest

import hitjoints as hj
from hitjoints.errors import InputError
from hitjoints.hit_setting import HitSetting, RobotChoice
from hitjoints.hitting.drive_limits import drive_limits
from hitjoints.swings.hit_samples import measured

NOISE = 0.004
"""What a thousand draws leave of a share, from the same draws; all differences are monotone."""


@pytest.fixture(scope="module")
def hit():
    return hj.Hit(
        None, (0.5, 0.15, 0.4), mass=2.0, goal=(0.5, 0.35, 0.4), friction=0.3, restitution=0.4,
        spread={"mass": 0.5, "friction": 0.01},
        setting=HitSetting(
            RobotChoice("iiwa14"), (6, 7), objective="landing", away=False, tolerance=0.02
        ),
    )  # fmt: skip


@pytest.fixture(scope="module")
def robot(arm):
    return arm("iiwa14")


@pytest.fixture(scope="module")
def planned(hit):
    return hj.plan(hit, certificate=False)


def share(robot, hit, q, joint):
    chosen = hit.with_contact(joint)
    inertia = hj.directional_inertia(robot, q, joint, hit.direction)
    speed = hj.required_speed(inertia, hit.mass, hit.flux)
    return hj.landing(robot, q, chosen, float(speed), seed=hit.setting.seed).within


def test_the_best_joint_is_that_of_the_greatest_share(hit, robot, planned):
    able = [one for one in planned.candidates if one.feasible]
    assert len(able) > 1
    assert planned.best.arrives == max(one.arrives for one in able)
    for one in able:
        assert one.arrives == share(robot, hit, one.q, one.joint)
        assert one.deliverable_flux >= hit.flux * (1 - 1e-6)
    assert len({one.arrives for one in able}) > 1, "the joints differ"


def test_no_sampled_configuration_that_delivers_it_makes_more_arrive(hit, robot, planned):
    limits = drive_limits(robot)
    for one in planned.candidates:
        if not one.feasible:
            continue
        placed = hj.place_joint(robot, one.joint, np.tile(hit.position, (400, 1)), 3)
        seen = measured(robot, hit.with_contact(one.joint), limits, placed.q[placed.solved])
        able = np.flatnonzero(seen.flux >= hit.flux)
        assert len(able) > 20
        # Those of least, middle and most inertia, and some others.
        order = able[np.argsort(seen.inertia[able])]
        for row in order[np.unique(np.linspace(0, len(order) - 1, 8).astype(int))]:
            assert share(robot, hit, seen.q[row], one.joint) <= one.arrives + NOISE


def test_the_answer_takes_the_motion_whose_object_most_surely_arrives(hit, robot):
    found = hj.answer(hit, robot, simulated=False)
    plain = hit.changed(setting=replace(hit.setting, objective="deliverable"))
    usual = hj.answer(plain, robot, simulated=False)
    assert found.verdict == "sendable"
    assert found.landing.within > usual.landing.within
    assert found.as_dict()["arrives"] == found.landing.within


def test_without_a_goal_it_is_refused(robot, hit):
    free = hit.changed(goal=None, direction=(0, 1, 0), flux=0.2)
    with pytest.raises(InputError, match="objective = landing: it needs a goal"):
        hj.plan(free, robot)
    with pytest.raises(InputError, match="objective = landing: a hit with a goal"):
        hj.plan(robot, (0.5, 0.2, 0.4), (0, 1, 0), 1.0, objective="landing", flux=0.2)


def test_the_command_plans_by_it(run, hit, planned, tmp_path):
    hit.save(tmp_path / "hit.toml")
    told = run("plan", "--hit", tmp_path / "hit.toml", "--no-certificate", "--json").json
    assert told["objective"] == "landing"
    assert told["best"]["arrives"] == planned.best.arrives
    assert told["best"]["joint"] == planned.best.joint
