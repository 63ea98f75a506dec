"""One configuration in microseconds: the evaluator, and the public batch beside its kernel."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

import hitjoints as hj
from benchmarks.contest import Peer, contest, near
from benchmarks.harness import Figure, Remark, Row, compare
from benchmarks.peers.pinocchio import PinocchioArm
from benchmarks.single_call import EXACT, JOINT, H
from hitjoints.kernels import build_kernel

CALLS = 2000
BATCHES = {10_000: 20, 100_000: 10, 1_000_000: 3, 10_000_000: 1}
"""Rows, and how often they are evaluated for one timing."""
WORTH_TWO = 1_000_000
"""Rows from which on two processors should be faster than one."""
EVERYTHING = ("inertia", "gradient", "jacobian", "position", "speed")


def measure() -> list[Row | Figure | Remark]:
    """Return the evaluator against Pinocchio by hand, and batches against the bare kernel."""
    robot = hj.load_robot("iiwa14")
    return [*evaluators(robot), *batches(robot)]


def evaluators(robot: hj.Robot) -> list[Row | Figure | Remark]:
    """Return calls of the evaluator, warm."""
    qs = np.random.default_rng(0).uniform(robot.lower, robot.upper, (CALLS, robot.n))
    arm = PinocchioArm(robot, JOINT)
    rows: list[Row | Figure | Remark] = []
    for what, outputs, target in (
        ("inertia and gradient, bound to the robot", ("inertia", "gradient"), ">= 8"),
        ("inertia, gradient, Jacobian, position and speed, bound", EVERYTHING, ">= 8"),
    ):
        evaluate = hj.Evaluator(robot, JOINT, outputs)

        def ours(evaluate: Any = evaluate) -> list[Any]:
            return [evaluate(q, H) for q in qs]

        peer = Peer(
            "Pinocchio by hand, inertia and gradient",
            lambda: lambda: [arm.inertia_and_gradient(q, H) for q in qs],
            CALLS,
            target,
        )
        check = partial(_agrees, ours())
        rows += contest(what, ("hj.Evaluator", ours, CALLS), [peer], check, repeats=7)
        rows.append(Figure(f"{what}, one call", _microseconds(rows[-1]), "us", "<= 2"))
    return rows


def batches(robot: hj.Robot) -> list[Row | Figure | Remark]:
    """Return the public function with its defaults against the bare kernel on one thread."""
    kernel = build_kernel(robot.model, ((JOINT, (0.0, 0.0, 0.0)),))
    rows: list[Row | Figure | Remark] = []
    for count, times in BATCHES.items():
        q = np.random.default_rng(0).uniform(robot.lower, robot.upper, (count, robot.n))

        def ours(q: Any = q, times: int = times) -> None:
            for _ in range(times):
                hj.directional_inertia(robot, q, JOINT, H)

        def bare(q: Any = q, times: int = times) -> None:
            for _ in range(times):
                kernel(q, H, threads=1)

        rows.append(
            compare(
                f"inertia of {count:,} rows",
                ("hj.directional_inertia, defaults", ours, count * times),
                ("the bare kernel, one thread", bare, count * times),
                meaning="cost",
                target="<= 1" if count >= WORTH_TWO else "<= 1.2",
            )
        )
    return rows


def _agrees(expected: list[Any], answer: list[Any]) -> str:
    inertia = near([row[0] for row in expected], EXACT)([row[0] for row in answer])
    return inertia or near([row[1] for row in expected], EXACT)([row[1] for row in answer])


def _microseconds(row: Row | Figure | Remark) -> float:
    return row.ours_time * 1e6 if isinstance(row, Row) else float("nan")
