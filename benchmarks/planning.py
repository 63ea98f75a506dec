"""Plans against searches with SciPy, and a count of broken promises over many plans.

`python -m benchmarks planning` measures; `python -m benchmarks.planning 10000` plans as many
random hits and counts violations of the limits, the position and the away condition.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Sequence
from functools import partial

import numpy as np

import hitjoints as hj
from benchmarks.contest import Peer, contest
from benchmarks.harness import Figure, Remark, Row, seconds
from hitjoints.model.robot import Robot
from hitjoints.planning.objectives.registry import OBJECTIVES as KNOWN
from hitjoints.planning.planner import plan
from tests.oracles.scipy_plans import SciPyPlanner

POSITION, DIRECTION, MASS = [0.5, 0.3, 0.5], [0.0, 1.0, 0.0], 2.0
JOINT, SEEDS = 6, 5
OBJECTIVES = ("inertia", "flux", "straight-flux")


def measure() -> list[Row | Figure | Remark]:
    """Return the time of one joint's plan against searches with SciPy, and what these reach."""
    robot = hj.load_robot("iiwa14")
    rows: list[Row | Figure | Remark] = []
    for objective in OBJECTIVES:
        what = f"plan joint {JOINT}, {objective}"
        rows += against_scipy(robot, objective, what)
        certified = seconds(lambda: search(robot, objective, certificate=True))  # noqa: B023
        target = "<= 0.05" if objective == "straight-flux" else "<= 0.025"
        rows.append(Figure(f"{what}, with its certificate", certified, "s", target))
    return rows


def search(robot: Robot, objective: str, *, certificate: bool) -> float:
    """Return the greatest value that our plan finds."""
    found = plan(
        robot,
        POSITION,
        DIRECTION,
        MASS,
        joints=[JOINT],
        objective=objective,
        certificate=certificate,
    )
    assert found.best is not None
    return float(getattr(found.best, KNOWN[objective].ranked_by))


def against_scipy(robot: Robot, objective: str, what: str) -> list[Row | Remark]:
    """Return the gain over each search; its name tells how much of our value it reaches."""
    at = np.array(POSITION)
    planner = SciPyPlanner(robot, JOINT, at, DIRECTION, MASS, away=True)
    searches: dict[str, Callable[[], list[float | None]]] = {
        "SLSQP, 8 starts": partial(_by_slsqp, planner, objective, 8, 8),
        "SLSQP from the best of 250": partial(_by_slsqp, planner, objective, 250, 6),
    }
    if objective != "straight-flux":  # a linear program in each evaluation: half a minute
        searches["differential evolution"] = lambda: [planner.by_evolution(objective)]
    best = search(robot, objective, certificate=False)
    peers = [judged(name, work, best) for name, work in searches.items()]
    ours = ("global search", lambda: [search(robot, objective, certificate=False)], 1)
    return contest(what, ours, peers, _found, repeats=3)


def _by_slsqp(
    planner: SciPyPlanner, objective: str, samples: int, starts: int
) -> list[float | None]:
    seeds = map(np.random.default_rng, range(SEEDS))
    return [planner.by_slsqp(objective, rng, samples, starts) for rng in seeds]


def judged(name: str, work: Callable[[], list[float | None]], best: float) -> Peer:
    """Return a search under a name that tells which shares of our value its seeds reach."""
    values = work()
    shares = [(value or 0.0) / best for value in values]
    low, high = (f"{100 * share:.4g}" for share in (min(shares), max(shares)))
    reached = low if low == high else f"{low} to {high}"
    target = ">= 1" if name == "SLSQP, 8 starts" else ""
    return Peer(f"SciPy {name}: {reached} % of ours", lambda: work, len(values), target)


def _found(values: Sequence[float | None]) -> str:
    return "" if any(values) else "no configuration is found"


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
