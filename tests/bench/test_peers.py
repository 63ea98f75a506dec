"""Every library that is installed agrees with us: independent checks of inertia, gradient, IK."""

import sys

import numpy as np
import pytest

import hitjoints as hj
from benchmarks.peers.drake import DrakeArm
from benchmarks.peers.mujoco import MuJoCoArm
from benchmarks.peers.pink import PinkArm
from benchmarks.peers.pinocchio import PinocchioArm
from benchmarks.peers.pybullet import PyBulletArm
from benchmarks.peers.toolbox import ToolboxArm
from benchmarks.single_call import inertias, placed

MODULES = {
    PinocchioArm: ["pinocchio"],
    MuJoCoArm: ["mujoco"],
    DrakeArm: ["pydrake"],
    PyBulletArm: ["pybullet"],
    ToolboxArm: ["roboticstoolbox"],
    PinkArm: ["pink", "daqp"],
}
EVALUATORS = [arm for arm in MODULES if arm is not PinkArm]
PLACERS = [arm for arm in MODULES if arm is not PyBulletArm]


@pytest.fixture
def peer(arm):
    """Make an arm of a library, or skip the test."""

    def make(kind, name, joint):
        for module in MODULES[kind]:
            pytest.importorskip(module)
        return kind(arm(name), joint), arm(name)

    return make


@pytest.mark.parametrize("kind", EVALUATORS)
@pytest.mark.parametrize(("name", "joint"), [("iiwa14", 6), ("iiwa7", 7)])
def test_inertia_and_gradient(peer, kind, name, joint):
    theirs, robot = peer(kind, name, joint)
    q = np.random.default_rng(joint).uniform(robot.lower, robot.upper)
    h = np.array([0.6, 0.0, 0.8])
    inertia = hj.directional_inertia(robot, q, joint, h)
    assert theirs.inertia(q, h) == pytest.approx(inertia, rel=1e-9)
    gradient = hj.directional_inertia_gradient(robot, q, joint, h)
    np.testing.assert_allclose(theirs.gradient(q, h), gradient, atol=1e-6 * np.abs(gradient).max())


@pytest.mark.parametrize("kind", PLACERS)
def test_inverse_kinematics(peer, kind):
    theirs, robot = peer(kind, "iiwa14", 6)
    rng = np.random.default_rng(1)
    targets = [hj.position(robot, rng.uniform(robot.lower, robot.upper), 6) for _ in range(5)]
    check = placed(robot, 6, targets)
    answers = [theirs.place(target, rng) for target in targets]
    assert check(answers) == ""
    assert "off by" in check([robot.home] * 5)
    assert "outside" in check([robot.upper + 1] * 5)
    assert "not reached" in check([None])


def test_drake_and_pybullet_share_a_process(peer):
    """Both bring a copy of much the same libraries."""
    ours = [peer(kind, "iiwa14", 6)[0] for kind in (DrakeArm, PyBulletArm)]
    q, h = np.full(7, 0.3), np.array([0.0, 1.0, 0.0])
    assert ours[0].inertia(q, h) == pytest.approx(ours[1].inertia(q, h), rel=1e-9)


def test_missing_libraries_are_skipped_and_said(monkeypatch, arm):
    robot = arm("iiwa14")
    for module in ("mujoco", "pydrake", "pybullet", "roboticstoolbox"):
        monkeypatch.setitem(sys.modules, module, None)
    bare, *skipped = inertias(robot, np.array([robot.home]))
    assert bare.peer == "Pinocchio by hand"
    assert {row.peer: row.verdict for row in skipped} == {
        "MuJoCo": "skipped: mujoco is not installed",
        "Drake": "skipped: pydrake is not installed",
        "PyBullet": "skipped: pybullet is not installed",
        "Robotics Toolbox": "skipped: roboticstoolbox is not installed",
    }
