"""One configuration, one target: the public functions against the libraries users know."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

import hitjoints as hj
from benchmarks.contest import Check, Peer, contest, near
from benchmarks.harness import Remark, Row, Work, compare
from benchmarks.peers.drake import DrakeArm
from benchmarks.peers.mujoco import MuJoCoArm
from benchmarks.peers.pink import PinkArm
from benchmarks.peers.pinocchio import PinocchioArm
from benchmarks.peers.pybullet import PyBulletArm
from benchmarks.peers.toolbox import ToolboxArm
from hitjoints.dynamics.inertia import inertia_and_gradient_along
from hitjoints.evaluator import WORTH_COMPILING
from hitjoints.vectors import unit

JOINT, H = 6, np.array([0.0, 1.0, 0.0])
CALLS = 500
TARGETS = 50
SLOW = {ToolboxArm: 2}  # calls: its inertia matrix takes over 10 ms
ARMS: dict[str, type[Any]] = {
    "Pinocchio by hand": PinocchioArm,
    "MuJoCo": MuJoCoArm,
    "Drake": DrakeArm,
    "PyBullet": PyBulletArm,
    "Robotics Toolbox": ToolboxArm,
}
PLACERS: dict[str, type[Any]] = {
    "Pinocchio by hand, damped least squares": PinocchioArm,
    "MuJoCo by hand, damped least squares": MuJoCoArm,
    "Robotics Toolbox, ik_LM in C++": ToolboxArm,
    "Pink with DAQP, repeated": PinkArm,
    "Drake, InverseKinematics": DrakeArm,
}
# What answers may differ by, relative to the largest: of equal formulas, and of differences.
EXACT, DIFFERENCES = 1e-9, 1e-6
STARTS = 1  # their seed; that of the targets' configurations would start each search at its answer
PLACED = 1e-5  # m; ours are right to 1e-9


def measure() -> list[Row | Remark]:
    """Return inertia, gradient and inverse kinematics, one at a time, and what checking costs."""
    robot = hj.load_robot("iiwa14")
    qs = np.random.default_rng(0).uniform(robot.lower, robot.upper, (CALLS, robot.n))
    return [*inertias(robot, qs), *gradients(robot, qs), *placements(robot, qs), *checks(robot, qs)]


def inertias(robot: hj.Robot, qs: Any) -> list[Row | Remark]:
    """Return the directional inertia of one configuration against that of each library."""

    def ours() -> list[float]:
        return [hj.directional_inertia(robot, q, JOINT, H) for q in qs]

    _warm(ours, len(qs))

    peers = _evaluators(robot, "inertia", qs, ">= 1.5")
    named = ("hj.directional_inertia", ours, len(qs))
    return contest("inertia, one call", named, peers, near(ours(), EXACT))


def gradients(robot: hj.Robot, qs: Any) -> list[Row | Remark]:
    """Return its gradient against exact ones and central differences."""

    def ours() -> list[Any]:
        return [hj.directional_inertia_gradient(robot, q, JOINT, H) for q in qs]

    _warm(ours, len(qs))

    peers = _evaluators(robot, "gradient", qs, ">= 4")
    named = ("hj.directional_inertia_gradient", ours, len(qs))
    return contest("gradient, one call", named, peers, near(ours(), DIFFERENCES), repeats=5)


def _warm(ours: Work, calls: int) -> None:
    """Ask often enough for the quantity to be compiled."""
    for _ in range(WORTH_COMPILING // calls + 1):
        ours()


def placements(robot: hj.Robot, qs: Any) -> list[Row | Remark]:
    """Return inverse kinematics of one reachable target, from random starts."""
    targets = [hj.position(robot, q, JOINT) for q in qs[:TARGETS]]

    def ours() -> list[Any]:
        return [hj.place_joint(robot, JOINT, target).q[0] for target in targets]

    peers = [
        Peer(name, placer(arm, robot, targets), TARGETS, ">= 1" * (arm is ToolboxArm))
        for name, arm in PLACERS.items()
    ]
    named = ("hj.place_joint", ours, TARGETS)
    check = placed(robot, JOINT, targets)
    return contest("inverse kinematics, one target", named, peers, check, repeats=5)


def placer(arm: type[Any], robot: hj.Robot, targets: Any) -> Callable[[], Work]:
    """Return what makes a loop over targets, the same random starts every time."""

    def make() -> Work:
        peer = arm(robot, JOINT)

        def work() -> list[Any]:
            rng = np.random.default_rng(STARTS)
            return [peer.place(target, rng) for target in targets]

        return work

    return make


def placed(robot: hj.Robot, joint: int, targets: Any) -> Check:
    """Return a check that configurations lie within the limits and have the joint at targets."""

    def check(answers: Sequence[Any]) -> str:
        worst = 0.0
        for q, target in zip(answers, targets, strict=False):
            if q is None:
                return "a reachable target is not reached"
            if ((q < robot.lower - 1e-9) | (q > robot.upper + 1e-9)).any():
                return "it is outside the joint limits"
            worst = max(worst, float(np.linalg.norm(hj.position(robot, q, joint) - target)))
        return "" if worst <= PLACED else f"off by {worst:.1g} m where {PLACED:.0e} m is allowed"

    return check


def checks(robot: hj.Robot, qs: Any) -> list[Row]:
    """Return the cost of checking input and wrapping results."""
    arm = PinocchioArm(robot, JOINT)

    def bare() -> None:
        for q in qs:
            arm.inertia_and_gradient(q, H)

    def together() -> None:
        contact = robot.contact(JOINT)
        for q in qs:
            inertia_and_gradient_along(robot, robot.configuration(q), contact, unit(H))

    def separately() -> None:
        for q in qs:
            hj.directional_inertia(robot, q, JOINT, H)
            hj.directional_inertia_gradient(robot, q, JOINT, H)

    peer = ("the same Pinocchio calls, bare", bare, len(qs))
    return [
        compare(
            "inertia and gradient, one configuration",
            (name, work, len(qs)),
            peer,
            meaning="cost",
            target=target,
        )
        for name, work, target in (
            ("checked, in one call", together, "<= 2.5"),
            ("two public functions", separately, ""),
        )
    ]


def _evaluators(robot: hj.Robot, method: str, qs: Any, target: str) -> list[Peer]:
    def theirs(arm: type[Any], some: Any) -> Callable[[], Work]:
        def make() -> Work:
            evaluate = getattr(arm(robot, JOINT), method)
            return lambda: [evaluate(q, H) for q in some]

        return make

    counts = {name: SLOW.get(arm, len(qs)) for name, arm in ARMS.items()}
    return [
        Peer(
            name,
            theirs(arm, qs[: counts[name]]),
            counts[name],
            target * (arm is PinocchioArm),
        )
        for name, arm in ARMS.items()
    ]
