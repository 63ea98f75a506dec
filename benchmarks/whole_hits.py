"""Swings by servos, their impacts and their boxes' ways: `python -m benchmarks.whole_hits 60`.

Where boxes end, beside where they were meant to, and what brings the difference about.
"""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Iterator
from typing import Any

import numpy as np

import hitjoints as hj
from hitjoints.evidence.physics.whole_hit import CAUSES, WholeHit
from hitjoints.evidence.physics.whole_simulation import simulate_whole
from hitjoints.impact.rotor import known_rotors, known_stiffness
from hitjoints.swings.swing_record import Swing

ROBOTS = ("iiwa14", "panda")
"""Those whose rotors are known."""
SHORTEST = 0.02
"""m, that a box is meant to go at least."""
WAYS: dict[str, dict[str, Any]] = {
    "rigid joints, servos of 10 Hz, contact of 1 ms": {},
    "rigid joints, servos of 10 Hz, contact of 10 ms": {"contact_time": 0.01},
    "elastic joints, servos of 10 Hz, contact of 10 ms": {"elastic": True, "contact_time": 0.01},
}


def random_swings(count: int, refused: Counter[str]) -> Iterator[Swing]:
    """Yield swings for random level hits of three arms that move their boxes by 2 cm or more.

    Boxes of 0.5 to 3 kg and 8 to 20 cm, hit in the middle of a face that is turned by up to 10
    degrees; joints 5 to 7; 50 to 95 % of what a swing can deliver; `refused` counts the others.
    """
    rng = np.random.default_rng(11)
    for i, name in enumerate(ROBOTS):
        robot, found = hj.load_robot(name), 0
        while found < count // len(ROBOTS) + (i < count % len(ROBOTS)):
            joint = robot.n - int(rng.integers(3))
            position = hj.position(robot, rng.uniform(*robot.finite_limits), joint)
            angle = rng.uniform(-np.pi, np.pi)
            direction = np.array([np.cos(angle), np.sin(angle), 0.0])
            hit = hj.Hit(
                joint, position, direction, float(rng.uniform(0.5, 3)),
                restitution=float(rng.uniform(0.2, 0.8)), friction=float(rng.uniform(0.15, 0.5)),
                size=rng.uniform(0.08, 0.2, 3), yaw=float(rng.uniform(-1, 1) * np.radians(10)),
            )  # fmt: skip
            share = float(rng.uniform(0.5, 0.95))
            try:
                most = hj.swing(robot, hit, seed=found)
                swung = hj.swing(robot, hit.changed(flux=share * most.flux), seed=found)
            except hj.InfeasibleError as error:
                refused[error.reason.split(":")[0][:30]] += 1
                continue
            object_speed = (1 + (hit.restitution or 0.0)) * swung.flux
            if object_speed**2 < 2 * (hit.friction or 0.0) * 9.81 * SHORTEST:
                refused["it hardly moves"] += 1
                continue
            found += 1
            yield swung


def whole(swung: Swing, *, elastic: bool = False, **changes: Any) -> WholeHit:
    """Simulate one."""
    if elastic:
        robot = swung.robot
        changes["rotors"] = tuple(known_rotors(robot, None).tolist())
        changes["stiffness"] = tuple(known_stiffness(robot, None).tolist())
    return simulate_whole(swung, **changes)


def main(count: int) -> None:
    """Print what 60 of them come to, in each way."""
    refused = Counter[str]()
    swings = list(random_swings(count, refused))
    print(f"{len(swings)} swings; not among them: {dict(refused)}")
    print(
        "share of the way in %, median and 95 of 100:      " + "".join(f"{c:>16}" for c in CAUSES)
    )
    for words, changes in WAYS.items():
        failed, results = Counter[str](), []
        for swung in swings:
            try:
                results.append(whole(swung, **changes))
            except hj.HitjointsError as error:
                failed[str(error)[:40]] += 1
        ways = np.array([result.meant.distance for result in results])
        rows = [[result.miss, *result.shares.values()] for result in results]
        off = 100 * np.array(rows) / ways[:, None]
        cells = [f"{np.median(a):7.2f} {np.percentile(a, 95):8.2f}" for a in off.T]
        print(f"{words:50} {'  '.join(cells[1:])}   all: {cells[0]}")
        ahead = 100 * np.array([list(result.along.values()) for result in results]) / ways[:, None]
        print(
            f"{'  along the way, mean':50} " + " ".join(f"{v:+16.2f}" for v in ahead.mean(axis=0))
        )
        touched = [result.largest_error for result in results]
        again = sum(result.contacts > 1 for result in results)
        print(
            f"  way {np.median(ways):.3f} m, miss {1e3 * np.median(off[:, 0] * ways) / 100:.1f} mm "
            f"(medians); servos within {np.median(touched):.1e} rad; touched again: {again}; "
            f"failed: {dict(failed)}", flush=True,
        )  # fmt: skip


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 60)
