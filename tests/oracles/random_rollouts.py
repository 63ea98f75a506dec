"""Random rollouts and hits, and what is wrong with them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from typing import Any

import numpy as np

import hitjoints as hj
from hitjoints.hit import Hit
from hitjoints.model.robot import Robot
from hitjoints.planning.planner import plan
from hitjoints.rollouts.follow import rollout
from hitjoints.rollouts.prepare import Preparation, prepare
from hitjoints.rollouts.record import Rollout

JOINTS = (5, 6, 7)
TRIES = 20  # random hits tried for each feasible one


def broken_limits(result: Rollout) -> int:
    """Return how many numbers of a rollout are beyond a limit, by however little.

    A position that was clipped counts too: the velocity before would have led beyond.
    """
    robot, q, qd = result.robot, result.rows["q"], result.rows["qd"]
    kept = result.parameters.get("acceleration_limits")
    change = np.abs(np.diff(qd, axis=0, prepend=0.0))
    too_hard = change > result.dt * np.array(kept) if kept else np.zeros(1)
    forced = result.parameters["torque_limits"]
    too_strong = np.abs(result.rows["torque"]) > robot.effort if forced else np.zeros(1)
    beyond = (q < robot.lower) | (q > robot.upper)
    too_fast = (qd < robot.velocity_lower) | (qd > robot.velocity_upper)
    clipped = np.abs(q[1:] - q[:-1] - result.dt * qd[:-1]) > 1e-12
    return int(beyond.sum() + too_fast.sum() + too_strong.sum() + too_hard.sum() + clipped.sum())


def random_cases(count: int, seed: int = 0) -> Iterator[tuple[Robot, Hit, Any, Any, Any]]:
    """Yield arm, hit, start, hitting configuration and reference, half from starts at a limit."""
    rng = np.random.default_rng(seed)
    robots = [hj.load_robot(name) for name in ("iiwa14", "iiwa7", "panda")]
    for i in range(count):
        robot = robots[i % 3]
        joint = int(rng.choice(robot.hitting_joints))
        q0, goal = rng.uniform(robot.lower, robot.upper, (2, robot.n))
        if i % 2:
            side = rng.integers(0, 4, robot.n)
            q0 = np.where(side == 0, robot.lower, np.where(side == 1, robot.upper, q0))
        target = hj.position(robot, goal, joint)
        way = target - hj.position(robot, q0, joint)
        direction = way / np.linalg.norm(way) + 0.3 * rng.standard_normal(3)
        if direction @ way <= 0:
            direction = way
        flux = float(rng.uniform(0.05, 1.0))
        hit = Hit(joint, target, direction, float(rng.uniform(0.3, 5.0)), flux)
        yield robot, hit, q0, goal, ("optimised", "constant")[i % 2]


def random_rollouts(count: int, seed: int = 0, **kept: bool) -> Iterator[Rollout]:
    """Yield rollouts of three arms from random starts, half of them with joints at a limit.

    `kept` are torque_limits and acceleration_limits, of `rollout`.
    """
    for robot, hit, q0, goal, reference in random_cases(count, seed):
        yield rollout(robot, hit, q0=q0, q_hit=goal, reference=reference, **kept)


def feasible_hits(
    robot: Robot,
    count: int,
    seed: int = 0,
    refused: Counter[str] | None = None,
    *,
    away: bool = True,
    level: bool = False,
) -> Iterator[tuple[Hit, Preparation]]:
    """Yield random hits that a plan reaches with a run-up; `refused` counts the others.

    Without `away` the links beyond the joint may point anywhere: the panda has no other hits.
    With `level` all directions are horizontal.
    """
    rng = np.random.default_rng(seed)
    refused = Counter() if refused is None else refused
    found = 0
    for i in range(TRIES * count):
        if found == count:
            return
        joint = JOINTS[found % len(JOINTS)]
        target = hj.position(robot, rng.uniform(robot.lower, robot.upper), joint)
        direction, mass = rng.standard_normal(3), float(rng.uniform(0.5, 4.0))
        share = float(rng.uniform(0.3, 0.8))
        if level:
            direction[2] = 0.0
        best = plan(
            robot,
            target,
            direction,
            mass,
            [joint],
            "straight-flux",
            away=away,
            seed=i,
            certificate=False,
        ).best
        if best is None or best.straight_flux is None or best.straight_flux <= 0.01:
            refused["plan"] += 1
            continue
        hit = Hit(joint, target, direction, mass, share * best.straight_flux)
        try:
            prepared = prepare(robot, hit, q_hit=None if away else best.q, seed=i)
        except hj.InfeasibleError as error:
            refused[error.reason.split(":")[0].split(" has ")[-1]] += 1
            continue
        found += 1
        yield hit, prepared


def tracking(result: Rollout) -> float:
    """Return the RMS of inertia - desired inertia over the approach, kg."""
    n = result.steps
    return float(
        np.sqrt(np.mean((result.rows["inertia"] - result.rows["desired_inertia"])[:n] ** 2))
    )


def failure(result: Rollout) -> str:
    """Return what a hit of a feasible plan lacks, or nothing."""
    impact = result.impact
    if result.reason or impact is None:
        return result.reason
    if impact.miss > 2e-3:
        return f"miss {1e3 * impact.miss:.2f} mm"
    if impact.direction_error > 2:
        return f"direction {impact.direction_error:.2f} deg"
    if abs(impact.flux / result.hit.desired_flux - 1) > 0.01:
        return f"flux {impact.flux:.3f} instead of {result.hit.desired_flux:.3f}"
    return ""
