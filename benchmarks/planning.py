"""Plans against SciPy's SLSQP, and a count of broken promises over many plans.

`python -m benchmarks planning` measures; `python -m benchmarks.planning 10000` plans as many
random hits and counts violations of the limits, the position and the away condition.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from typing import Any

import numpy as np
import pinocchio as pin
from scipy.optimize import minimize

import hitjoints as hj
from benchmarks.harness import Row, compare
from hitjoints.planning.plan import Plan, plan
from hitjoints.robot import Robot

POSITION, DIRECTION, MASS = [0.5, 0.3, 0.5], [0.0, 1.0, 0.0], 2.0
STARTS = 8
OBJECTIVES = ("inertia", "flux", "straight-flux")


def measure() -> list[Row]:
    """Return the time of one joint's plan against a plain multi-start."""
    robot = hj.load_robot("iiwa14")

    def ours(objective: str) -> Callable[[], Plan]:
        return lambda: plan(
            robot, POSITION, DIRECTION, MASS, joints=[6], objective=objective, certificate=False
        )

    return [
        compare(
            f"plan joint 6, {objective}",
            ("global search with evidence", ours(objective), 1),
            (f"SciPy SLSQP, {STARTS} starts, inertia", lambda: multi_start(robot, 6), 1),
            repeats=5,
        )
        for objective in OBJECTIVES
    ]


def multi_start(robot: Robot, joint: int) -> float:
    """Return the greatest inertia of a few SLSQP runs from random configurations."""
    model, data, h = robot.model, robot.model.createData(), np.array(DIRECTION)
    following = joint + 1

    def negative_inertia(q: Any) -> float:
        J = jacobian(q)
        return float(-1.0 / (h @ J @ np.linalg.solve(pin.crba(model, data, q), J.T @ h)))

    def jacobian(q: Any) -> Any:
        pin.computeJointJacobians(model, data, q)
        return pin.getJointJacobian(model, data, joint, pin.LOCAL_WORLD_ALIGNED)[:3]

    def origin(q: Any, k: int) -> Any:
        pin.forwardKinematics(model, data, q)
        return data.oMi[k].translation.copy()

    constraints = (
        {"type": "eq", "fun": lambda q: origin(q, joint) - POSITION, "jac": jacobian},
        {"type": "ineq", "fun": lambda q: h @ (origin(q, joint) - origin(q, following))},
    )
    bounds = list(zip(robot.lower, robot.upper, strict=True))
    best, rng = 0.0, np.random.default_rng(0)
    for _ in range(STARTS):
        start = rng.uniform(robot.lower, robot.upper)
        run = minimize(
            negative_inertia, start, method="SLSQP", bounds=bounds, constraints=constraints
        )
        if np.linalg.norm(origin(run.x, joint) - POSITION) < 1e-4:
            best = max(best, -float(run.fun))
    return best


def count_violations(count: int, seed: int = 0) -> dict[str, float]:
    """Plan random hits of three arms and count what a plan promises and does not keep."""
    rng = np.random.default_rng(seed)
    robots = [hj.load_robot(name) for name in ("iiwa14", "iiwa7", "panda")]
    counts = dict.fromkeys(("plans", "feasible", "limits", "position", "away"), 0)
    worst, begin = 0.0, time.perf_counter()
    for i in range(count):
        robot = robots[i % 3]
        joint = int(rng.choice(robot.hitting_joints))
        target = hj.position(robot, rng.uniform(robot.lower, robot.upper), joint)
        best = plan(
            robot,
            target,
            rng.standard_normal(3),
            float(rng.uniform(0.3, 5.0)),
            joints=[joint],
            objective=OBJECTIVES[i // 3 % 3],
            seed=i,
            certificate=False,
        ).best
        counts["plans"] += 1
        if best is None or best.q is None:
            continue
        error = float(np.linalg.norm(hj.position(robot, best.q, joint) - target))
        worst = max(worst, error)
        counts["feasible"] += 1
        counts["limits"] += bool(((best.q < robot.lower) | (best.q > robot.upper)).any())
        counts["position"] += error > 1e-6
        counts["away"] += not best.away
    seconds = time.perf_counter() - begin
    return {**counts, "worst_position_error": worst, "seconds_per_plan": seconds / max(1, count)}


if __name__ == "__main__":
    print(count_violations(int(sys.argv[1]) if len(sys.argv) > 1 else 10_000))
