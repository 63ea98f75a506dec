"""The control step's time, alone and against the authors' stack; counts over many rollouts.

`python -m benchmarks control` measures the step; `python -m benchmarks.control 1000 300` also
counts broken limits over 1000 random rollouts and judges 300 random planned hits.
"""

from __future__ import annotations

import statistics
import sys
import time
from collections import Counter
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

import hitjoints as hj
from benchmarks.contest import Peer, contest, near
from benchmarks.harness import Figure, Remark, Row, Work
from benchmarks.peers.control_step import PyBulletStep, Solve
from benchmarks.peers.osqp import OsqpInPlace, QpSolvers
from hitjoints.hit import Hit
from hitjoints.hitting.controller import Controller
from hitjoints.rollouts.follow import rollout
from hitjoints.rollouts.prepare import prepare
from tests.oracles.random_rollouts import (
    broken_limits,
    failure,
    feasible_hits,
    random_rollouts,
    tracking,
)

if TYPE_CHECKING:
    from hitjoints.types import Array


def measure() -> list[Row | Figure | Remark]:
    """Return the time of a full control step: kinematics, inertia, gradient, Eq. 12, law."""
    robot = hj.load_robot("iiwa14")
    hit = Hit(6, np.array([0.5, 0.3, 0.5]), np.array([0.0, 1.0, 0.0]), 2.0, 0.3)
    found = prepare(robot, hit)
    times: list[float] = []
    for dt in (0.005, 0.002, 0.001) * 8:
        times += walk(Controller(robot, hit, found.q_hit, dt=dt), found.q0)[1]
    micro = 1e6 * np.array(times)
    from_rest = prepare(robot, hit, torque_limits=True)
    limited: list[float] = []
    for _ in range(5):
        limited += walk(Controller(robot, hit, from_rest.q_hit, torque_limits=True), from_rest.q0)[
            1
        ]
    with_torques = 1e6 * float(np.median(limited))
    return [
        Figure("control step, median", float(np.median(micro)), "us", "<= 15"),
        Figure("control step, 99th percentile", float(np.percentile(micro, 99)), "us", "<= 60"),
        Figure("control step with torque limits, median", with_torques, "us", "<= 100"),
        *against_authors(Controller(robot, hit, found.q_hit), found.q0),
    ]


def walk(controller: Controller, q: Array) -> tuple[list[Array], list[float]]:
    """Return the configurations (n,) rad of a hit from q, and the time (s) of each step."""
    path, times = [], []
    while not controller.arrived:
        path.append(q)
        begin = time.perf_counter()
        qd = controller.step(q)
        times.append(time.perf_counter() - begin)
        q = controller.follow(q, qd)
    return path, times


def against_authors(controller: Controller, q0: Array) -> list[Row | Remark]:
    """Return the gain over the same steps made with PyBullet, differences and OSQP."""
    robot, hit, path = controller.robot, controller.hit, walk(controller, q0)[0]
    joint = controller.contact.joint
    count = len(path)

    def ours() -> list[Array]:
        return [controller.step(q) for q in path]

    def theirs(solver: Callable[[], Solve]) -> Callable[[], Work]:
        def make() -> Work:
            step = PyBulletStep(robot, hit, joint, controller.posture, controller.dt, solver)
            return lambda: [step(q) for q in path]

        return make

    return contest(
        "control step",
        ("Controller.step", ours, count),
        [
            Peer("PyBullet, differences, qpsolvers + OSQP", theirs(QpSolvers), count, ">= 120"),
            Peer("PyBullet, differences, OSQP set up once", theirs(OsqpInPlace), count),
        ],
        near(ours(), 1e-5),
    )


def count_violations(count: int, **kept: bool) -> dict[str, Any]:
    """Return the violations over random rollouts, and how these ended."""
    begin, ends = time.perf_counter(), Counter[str]()
    violations = steps = braked = emergencies = 0
    times: list[float] = []
    for result in random_rollouts(count, **kept):
        violations += broken_limits(result)
        steps += len(result.rows["q"])
        braked += result.braked_steps
        emergencies += int(result.rows["emergency"].sum())
        times += result.step_times.tolist()
        ends[result.reason.split(" ")[0] or "hit"] += 1
    seconds = time.perf_counter() - begin
    return {"rollouts": count, "steps": steps, "violations": violations, "braked": braked} | {
        "ends": dict(ends),
        "emergencies": emergencies,
        "seconds": seconds,
        "step_us_median": 1e6 * statistics.median(times),
    }


def judge_hits(count: int) -> dict[str, Any]:
    """Return the share of successful hits and how well the two references are tracked."""
    robot, ratios = hj.load_robot("iiwa14"), []
    failures: list[str] = []
    saturated, misses, times = 0, [], []
    refused = Counter[str]()
    for hit, found in feasible_hits(robot, count, refused=refused):
        optimised = rollout(robot, hit, q0=found.q0, q_hit=found.q_hit)
        constant = rollout(robot, hit, q0=found.q0, q_hit=found.q_hit, reference="constant")
        ratios.append(tracking(optimised) / tracking(constant))
        times.append(1e6 * optimised.step_times)
        reason = failure(optimised)
        if reason:
            failures.append(f"joint {robot.contact(hit.chosen_contact).joint}: {reason}")
        if optimised.impact is not None:
            saturated += optimised.impact.saturated
            misses.append(optimised.impact.miss)
    return {
        "hits": len(ratios),
        "success": 1 - len(failures) / len(ratios),
        "saturated": saturated,
        "largest_miss_mm": 1e3 * max(misses),
        "failures": failures,
        "optimised_tracks_better": statistics.mean(ratio < 1 for ratio in ratios),
        "tracking_ratio_median": statistics.median(ratios),
        "refused": dict(refused),
        "step_us_median": float(np.median(np.concatenate(times))),
        "step_us_p99": float(np.percentile(np.concatenate(times), 99)),
    }


if __name__ == "__main__":
    rollouts, hits = (int(word) for word in [*sys.argv[1:], "1000", "300"][:2])
    for figure in measure():
        print(figure)
    print(count_violations(rollouts))
    print("with torque limits:", count_violations(rollouts, torque_limits=True))
    print("with acceleration limits:", count_violations(rollouts, acceleration_limits=True))
    both = count_violations(rollouts, torque_limits=True, acceleration_limits=True)
    print("with both:", both)
    print(judge_hits(hits))
