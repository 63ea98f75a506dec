"""An arm without inertia has kinematics and speeds; everything else says what is missing."""

import re

import numpy as np
import pytest

import hitjoints as hj
from hitjoints.errors import ModelError

H = [0.0, 1.0, 0.0]
FAULTS = {"no mass": "no link has mass", "points": "carries no inertia|not positive definite"}


@pytest.fixture
def described(urdf):
    """Return the file of an arm of four joints, with masses or without."""

    def write(kind):
        links = {
            "no mass": [f'<link name="seg{k}"/>' for k in range(1, 5)],
            # A point mass on the last axis does not resist its joint.
            "points": [
                urdf.link(f"seg{k}", mass=0.5 + k / 9, com=(0, 0, 0), moments=(0, 0, 0))
                for k in range(1, 5)
            ],
            "whole": [urdf.link(f"seg{k}", mass=0.5 + k / 9) for k in range(1, 5)],
        }[kind]
        ends = ["base", "seg1", "seg2", "seg3", "seg4"]
        joints = [
            urdf.joint(f"turn{k}", ends[k - 1], ends[k], at="0.05 0 0.2", axis=axis)
            for k, axis in enumerate(("0 0 1", "0 1 0", "0 1 0", "1 0 0"), 1)
        ]
        return urdf.write(urdf.robot(urdf.base, *links, *joints), f"{kind.split()[0]}.urdf")

    return write


@pytest.fixture(params=FAULTS)
def arm_and_reason(request, described):
    path = described(request.param)
    with pytest.warns(hj.ModelWarning):
        robot = hj.load_robot(path)
    return robot, FAULTS[request.param], path


def test_kinematics_and_speeds_are_those_of_the_arm_with_mass(arm_and_reason, described):
    robot = arm_and_reason[0]
    whole = hj.load_robot(described("whole"))
    rows = np.random.default_rng(0).uniform(-0.9, 0.9, (20, 4))
    at = np.array([hj.position(whole, q, 3) for q in rows])
    placed = hj.place_joint(robot, 3, at)
    assert placed.solved.all()
    np.testing.assert_array_equal(placed.q, hj.place_joint(whole, 3, at).q)
    for straight in (False, True):
        for q in (rows, rows[0]):
            speeds = [hj.hitting_speed(r, q, 3, H, straight=straight) for r in (robot, whole)]
            np.testing.assert_array_equal(*speeds)
    for ask in (hj.position, hj.jacobian, hj.manipulability):
        np.testing.assert_array_equal(ask(robot, rows[0], 3), ask(whole, rows[0], 3))
    described_ = hj.feasible_directions(robot, rows[0], 3).description
    assert described_ == hj.feasible_directions(whole, rows[0], 3).description


def questions(robot, folder):
    q, rows = robot.home + 0.2, np.tile(robot.home + 0.2, (3, 1))
    at = hj.position(robot, q, 3)
    hit = hj.Hit(3, at, H, 1.0, 0.1)
    return {
        "inertia": lambda: hj.directional_inertia(robot, q, 3, H),
        "inertia of rows": lambda: hj.directional_inertia(robot, rows, 3, H),
        "gradient": lambda: hj.directional_inertia_gradient(robot, q, 3, H),
        "gradient of rows": lambda: hj.directional_inertia_gradient(robot, rows, 3, H),
        "inverse": lambda: hj.inverse_inertia(robot, q, 3),
        "impact": lambda: hj.impact_inertia(robot, q, 3, H),
        "plan": lambda: hj.plan(robot, at, H, 1.0),
        "plan for flux": lambda: hj.plan(robot, at, H, 1.0, objective="flux", away=False),
        "posture": lambda: hj.posture(robot, q, 3, H),
        "sweep": lambda: hj.sweep_joint(robot, at, H, 1.0, joints=[3], count=3),
        "map": lambda: hj.sweep_workspace(
            robot, at[:1], at[1:2], at[2:], [H], mass=1.0, samples=2, out=folder / "map.zarr"
        ),
        "step": lambda: hj.Controller(robot, hit, q).step(q),
        "rollout": lambda: hj.rollout(robot, hit),
        "simulate": lambda: hj.simulate(robot, hit),
    }


def test_what_needs_inertia_says_that_there_is_none(arm_and_reason, tmp_path):
    robot, reason, _ = arm_and_reason
    for name, ask in questions(robot, tmp_path).items():
        with pytest.raises(ModelError, match=f"robot {robot.name}: .*({reason})"):
            pytest.fail(f"{name}: {ask()}")


def test_every_command_says_it_in_a_line(arm_and_reason, run, tmp_path):
    robot, reason, path = arm_and_reason
    at = ",".join(map(repr, hj.position(robot, robot.home + 0.2, 3).tolist()))
    hit = ("--robot", path, f"--object={at}", "--direction=0,1,0", "--joint", 3)
    place = [f"--{axis}={value}" for axis, value in zip("xyz", at.split(","), strict=True)]
    out = tmp_path / "out.zarr"
    commands = [
        ("inspect", "--robot", path, "--joint", 3),
        ("plan", *hit),
        ("sweep", "joint", *hit, "--count", 3),
        ("sweep", "workspace", "--robot", path, "--joint", 3, *place, "--samples", 2, "--out", out),
        ("rollout", *hit),
        ("simulate", *hit),
        ("view", "--robot", path, "--joint", 3, "--out", tmp_path / "view.html"),
    ]
    for command in commands:
        outcome = run(*command)
        assert outcome.code == 1, command
        *_, last = outcome.err.strip().splitlines()
        assert re.match(rf"error: robot {robot.name}: .*({reason})", last), command
    checked = run("robots", "check", path, "--strict", "--json")
    assert checked.code == 3
    assert re.search(reason, str(checked.json["issues"]))
