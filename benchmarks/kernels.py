"""Batches of configurations and batched inverse kinematics against Pinocchio loops."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

import hitjoints as hj
from benchmarks.floor import operations, peak
from benchmarks.harness import Figure, Row, compare, seconds
from benchmarks.peers import pinocchio
from hitjoints.kernels import build_kernel, place

ROWS, LOOP_ROWS, NUMPY_ROWS, IK_ROWS, IK_LOOP_ROWS = 1_000_000, 3000, 200_000, 300_000, 300
H = np.array([0.0, 1.0, 0.0])
JOINT = 6
ORIGIN = (0.0, 0.0, 0.0)
TASKS = {
    "inertia": (("inertia",), "8", "100"),
    "inertia and gradient": (("inertia", "gradient"), "20", "200"),
}


def measure() -> list[Row | Figure]:
    """Return gains over the loops, the gain of a second thread, build times and the floor."""
    robot = hj.load_robot("iiwa14")
    rng = np.random.default_rng(0)
    q = rng.uniform(robot.lower, robot.upper, (ROWS, robot.n))
    rows: list[Row | Figure] = []
    for name, (outputs, numpy_target, llvm_target) in TASKS.items():
        loop = ("Pinocchio loop", partial(_loop, robot, q[:LOOP_ROWS], outputs), LOOP_ROWS)
        for backend, count, target in (
            ("numpy", NUMPY_ROWS, numpy_target),
            ("llvm", ROWS, llvm_target),
        ):
            kernel = _build(robot, ((JOINT, ORIGIN),), outputs, backend)
            work = partial(kernel, q[:count], H, threads=1)
            ours = (f"{backend}, one thread", work, count)
            rows.append(compare(name, ours, loop, target=f">= {target}", repeats=5))
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


def _loop(robot: hj.Robot, q: Any, outputs: tuple[str, ...]) -> None:
    model, data, weightless = robot.model, robot.data, robot.weightless_model
    for row in q:
        if "gradient" in outputs:
            pinocchio.gradient(model, weightless, data, row, JOINT, H)
        else:
            pinocchio.inertia(model, data, row, JOINT, H)


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


def _placing(robot: hj.Robot, q: Any) -> list[Row | Figure]:
    model, rng = robot.model, np.random.default_rng(1)
    position = _build(robot, ((JOINT, ORIGIN),), ("position",))
    targets = np.ascontiguousarray(position(q, H)["position"][0])

    def loop() -> None:
        for target in targets[:IK_LOOP_ROWS]:
            pinocchio.place(model, robot.data, JOINT, target, rng)

    row = compare(
        "inverse kinematics, reachable targets",
        ("llvm, one thread", lambda: place(model, (JOINT, ORIGIN), targets, threads=1), len(q)),
        ("Pinocchio, damped least squares", loop, IK_LOOP_ROWS),
        target=">= 500",
        repeats=3,
    )
    unsolved = int((~place(model, (JOINT, ORIGIN), targets).solved).sum())
    return [row, Figure(f"unsolved of {len(q)} reachable targets", unsolved, "", "<= 0")]
