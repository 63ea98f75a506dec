"""Batches of configurations and batched inverse kinematics against Pinocchio loops."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

import hitjoints as hj
from benchmarks.contest import Peer, contest, near
from benchmarks.floor import operations, peak
from benchmarks.harness import Figure, Remark, Row, Work, compare, seconds
from benchmarks.peers.mujoco import MuJoCoArm
from benchmarks.peers.pinocchio import PinocchioArm
from benchmarks.peers.toolbox import ToolboxArm
from benchmarks.single_call import EXACT, placed, placer
from hitjoints.kernels import build_kernel, place

ROWS, LOOP_ROWS, NUMPY_ROWS, IK_ROWS, IK_LOOP_ROWS = 1_000_000, 3000, 200_000, 300_000, 300
H = np.array([0.0, 1.0, 0.0])
JOINT = 6
ORIGIN = (0.0, 0.0, 0.0)
TASKS = {
    "inertia": (("inertia",), "8", "100"),
    "inertia and gradient": (("inertia", "gradient"), "20", "200"),
}


def measure() -> list[Row | Figure | Remark]:
    """Return gains over the loops, the gain of a second thread, build times and the floor."""
    robot = hj.load_robot("iiwa14")
    rng = np.random.default_rng(0)
    q = rng.uniform(robot.lower, robot.upper, (ROWS, robot.n))
    rows: list[Row | Figure | Remark] = []
    for name, (outputs, numpy_target, llvm_target) in TASKS.items():
        for backend, count, target in (
            ("numpy", NUMPY_ROWS, numpy_target),
            ("llvm", ROWS, llvm_target),
        ):
            kernel = _build(robot, ((JOINT, ORIGIN),), outputs, backend)
            ours = (f"{backend}, one thread", partial(kernel, q[:count], H, threads=1), count)
            loops = _loops(robot, q[:LOOP_ROWS], outputs, f">= {target}")
            check = partial(_agrees, kernel(q[:LOOP_ROWS], H))
            rows += contest(f"{name}, many configurations", ours, loops, check, repeats=5)
        rows += _threads_and_floor(name, kernel, q)
    for contacts, outputs in (
        (((JOINT, ORIGIN),), ("inertia", "gradient")),
        (tuple((k, ORIGIN) for k in robot.hitting_joints), ("inertia", "speed", "flux")),
    ):
        build = min(seconds(partial(_build, robot, contacts, outputs)) for _ in range(3))
        what = f"build and verify: {', '.join(outputs)}; {len(contacts)} joint(s)"
        rows.append(Figure(what, build, "s", "<= 0.3"))
    return [*rows, *_placing(robot, q[:IK_ROWS])]


def _build(robot: hj.Robot, contacts: Any, outputs: Any, backend: str | None = None) -> Any:
    return build_kernel(robot.model, contacts, outputs, backend)


def _loops(robot: hj.Robot, q: Any, outputs: tuple[str, ...], target: str) -> list[Peer]:
    def loop(arm: type[Any], method: str) -> Work:
        evaluate = getattr(arm(robot, JOINT), method)
        return lambda: [evaluate(row, H) for row in q]

    if "gradient" in outputs:  # MuJoCo would need fourteen differences
        makers = {"Pinocchio loop": partial(loop, PinocchioArm, "inertia_and_gradient")}
    else:
        arms = {"Pinocchio loop": PinocchioArm, "MuJoCo loop": MuJoCoArm}
        makers = {name: partial(loop, arm, "inertia") for name, arm in arms.items()}
    return [
        Peer(name, make, len(q), target * name.startswith("Pinocchio"))
        for name, make in makers.items()
    ]


def _agrees(expected: dict[str, Any], answer: Any) -> str:
    """Return what is wrong with the outputs of a kernel, or with a loop's numbers or pairs."""
    if not isinstance(answer, dict):
        columns = [answer] if len(expected) == 1 else zip(*answer, strict=True)
        answer = {name: [list(c)] for name, c in zip(expected, columns, strict=True)}
    for name, want in expected.items():
        wrong = near(want[0], EXACT)(answer[name][0][: len(want[0])])
        if wrong:
            return wrong
    return ""


def _threads_and_floor(name: str, kernel: Any, q: Any) -> list[Row | Figure]:
    two = compare(
        f"{name}, a second thread",
        ("llvm, two threads", partial(kernel, q, H, threads=2), len(q)),
        ("llvm, one thread", partial(kernel, q, H, threads=1), len(q)),
        target=">= 1.6",
        repeats=9,
    )
    share = operations(kernel) / two.peer_time / peak()
    return [
        two,
        Figure(f"{name}: operations per evaluation", operations(kernel), ""),
        Figure(f"{name}: share of one core's measured vector peak", share, ""),
    ]


def _placing(robot: hj.Robot, q: Any) -> list[Row | Figure | Remark]:
    model = robot.model
    position = _build(robot, ((JOINT, ORIGIN),), ("position",))
    targets = np.ascontiguousarray(position(q, H)["position"][0])

    some = targets[:IK_LOOP_ROWS]

    def ours() -> Any:
        return place(model, (JOINT, ORIGIN), targets, threads=1).q[:IK_LOOP_ROWS]

    rows = contest(
        "inverse kinematics, many reachable targets",
        ("llvm, one thread", ours, len(q)),
        [
            Peer(
                "Pinocchio loop, damped least squares",
                placer(PinocchioArm, robot, some),
                IK_LOOP_ROWS,
                ">= 500",
            ),
            Peer(
                "Robotics Toolbox loop, ik_LM in C++", placer(ToolboxArm, robot, some), IK_LOOP_ROWS
            ),
        ],
        placed(robot, JOINT, targets),
        repeats=3,
    )
    unsolved = int((~place(model, (JOINT, ORIGIN), targets).solved).sum())
    return [*rows, Figure(f"unsolved of {len(q)} reachable targets", unsolved, "", "<= 0")]
