"""Hits in the physics engine: `python -m benchmarks.simulation 60` judges 60 random planned."""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Iterator
from typing import Any

import numpy as np

import hitjoints as hj
from benchmarks.harness import Figure, seconds
from hitjoints.evidence.physics.setting import MODES
from hitjoints.evidence.physics.simulated_hit import Simulation
from tests.oracles.random_rollouts import feasible_hits

ROBOTS = ("iiwa14", "iiwa7", "panda")
HITS = 12  # of `python -m benchmarks`


def random_simulations(
    count: int, refused: Counter[str] | None = None, **changes: Any
) -> Iterator[Simulation]:
    """Yield simulations of random planned hits with joints 5 to 7 of three arms: ideal ones.

    `changes` are passed on to `simulate`.
    """
    rng = np.random.default_rng(0)
    for i, name in enumerate(ROBOTS):
        robot = hj.load_robot(name)
        share = count // len(ROBOTS) + (i < count % len(ROBOTS))
        hits = feasible_hits(robot, share, seed=i, refused=refused, away=name != "panda")
        for hit, found in hits:
            eps = float(rng.uniform(0.05, 0.95))
            yield hj.simulate(
                robot, hit, restitution=eps, q0=found.q0, q_hit=found.q_hit, **changes
            )


def judge(results: list[Simulation]) -> list[Figure]:
    """Return how far simulated hits are from predicted ones."""

    def figures(name: str, median: str, most: str) -> list[Figure]:
        off = 100 * np.array([abs(result.errors[name] or 0.0) for result in results])
        what = f"{name.replace('_', ' ')} off in {len(results)} ideal simulations"
        return [
            Figure(f"{what}, median", float(np.median(off)), "%", median),
            Figure(f"{what}, most", float(off.max()), "%", most),
        ]

    return [
        *figures("inertia", "<= 0.1", "<= 1"),
        *figures("object_speed", "<= 1", "<= 3"),
        *figures("rebound", "", ""),
    ]


def measure() -> list[Figure]:
    """Return the errors of a few ideal simulations, and the time of one from the rollout on."""
    results = list(random_simulations(HITS))
    robot, hit = results[0].motion.robot, results[0].motion.hit
    start = {"q0": results[0].motion.rows["q"][0], "q_hit": results[0].motion.q_hit}
    spent = min(seconds(lambda: hj.simulate(robot, hit, **start)) for _ in range(5))
    return [*judge(results), Figure("rollout and ideal simulation of a hit", 1e3 * spent, "ms")]


def causes(count: int) -> dict[str, dict[str, list[float]]]:
    """Return the errors (%) of random planned hits, by each cause alone and by all of them.

    The box stands on no table: the hits go in all directions.
    """
    changes: dict[str, Any] = {k: v for k, v in MODES["realistic"].items() if k != "on_table"}
    found: dict[str, dict[str, list[float]]] = {}
    for result in random_simulations(count, **changes):
        strikes = {cause.name: cause.alone for cause in result.causes} | {"all": result.strike}
        for cause, strike in strikes.items():
            for name, error in result.errors_of(strike).items():
                found.setdefault(cause, {}).setdefault(name, []).append(100 * abs(error))
    return found


def main(count: int) -> None:
    """Print every hit's errors, and what they come to."""
    refused, results = Counter[str](), []
    print("robot    joint  mass   speed  eps    inertia  errors in %: inertia, object, rebound")
    for result in random_simulations(count, refused):
        results.append(result)
        told, hit = result.predicted, result.motion.hit
        errors = [
            100 * (result.errors[name] or 0.0) for name in ("inertia", "object_speed", "rebound")
        ]
        print(
            f"{result.motion.robot.name:8} {result.impact.contact.joint:5}  {hit.mass:5.2f}  "
            f"{told.speed:5.2f}  {result.setting.restitution:5.2f}  {told.inertia:7.2f}  "
            + "  ".join(f"{error:+7.3f}" for error in errors)
        )
    for figure in judge(results):
        print(f"{figure.what}: {figure.value:.3g} {figure.unit} {figure.target}")
    print(f"tried and not feasible: {refused.total()} more hits")
    print("off by, median and most in %:       object speed         rebound         inertia")
    for cause, found in causes(count).items():
        cells = (f"{np.median(off):7.2f} {np.max(off):7.2f}" for off in found.values())
        print(f"{cause:32} " + " ".join(cells))


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 60)
