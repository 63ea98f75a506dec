"""Compiled control steps beside those of the certifying way: `python -m benchmarks.compiled_steps`.

Random hits of three arms, a fifth of them beyond what the arm can do, with the controller's options
in turn. Prints how far the two ever differ, and how many steps had no compiled answer.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from typing import Any

import numpy as np

import hitjoints as hj
from hitjoints.errors import HitjointsError

ARMS = ("iiwa14", "panda", "xarm7")
OPTIONS: tuple[dict[str, Any], ...] = (
    {},
    {"weighting": "gradient"},
    {"reference": "constant"},
    {"speed_profile": "paper"},
)
DT, STEPS = 0.004, 150
BEHIND, SHARES = 0.15, (0.2, 1.2)  # m before the object; of the greatest straight flux


def pairs(count: int, seed: int) -> Iterator[tuple[hj.Controller, hj.Controller, Any]]:
    """Yield controllers of one hit, compiled and not, and where the motion starts."""
    rng = np.random.default_rng(seed)
    robots = [hj.load_robot(name) for name in ARMS]
    done = 0
    while done < count:
        robot, joint = robots[done % len(robots)], int(rng.choice([5, 6, 7]))
        q, h = rng.uniform(robot.lower, robot.upper), rng.normal(size=3)
        h /= np.linalg.norm(h)
        at, mass = hj.position(robot, q, joint), rng.uniform(0.5, 3.0)
        try:
            inertia = hj.directional_inertia(robot, q, joint, h)
            straight = hj.hitting_speed(robot, q, joint, h, straight=True)
            flux = rng.uniform(*SHARES) * hj.hitting_flux(inertia, mass, straight)
            start = hj.place_joint(robot, joint, at - BEHIND * h, start=q)
            hit = hj.Hit(joint, at, h, mass, flux)
            given = {"dt": DT, "posture": q, **OPTIONS[done % len(OPTIONS)]}
            two = [hj.Controller(robot, hit, q, compiled=how, **given) for how in (True, False)]
        except HitjointsError:
            continue
        if start.solved[0]:
            done += 1
            yield two[0], two[1], start.q[0]


def compare(count: int, seed: int) -> dict[str, float]:
    """Return the greatest differences over all steps of `count` hits."""
    found = {"hits": 0.0, "steps": 0.0, "not compiled": 0.0, "qd": 0.0, "the rest": 0.0}
    for fast, slow, start in pairs(count, seed):
        found["hits"] += 1
        q = start
        for _ in range(STEPS):
            try:
                slower, taken = slow.step(q), fast._take(q)
            except HitjointsError:
                break
            qd = fast.last.qd if taken and fast.last is not None else fast.step(q)
            assert fast.last is not None
            assert slow.last is not None
            rest = max(
                float(np.abs(np.asarray(a, float) - np.asarray(b, float)).max())
                for a, b in zip(fast.last, slow.last, strict=True)
            )
            found["steps"] += 1
            found["not compiled"] += not taken
            found["qd"] = max(found["qd"], float(np.abs(qd - slower).max()))
            found["the rest"] = max(found["the rest"], rest)
            q = fast.follow(q, qd)
            if fast.arrived:
                break
    return found


if __name__ == "__main__":
    COUNT, SEED = (*map(int, sys.argv[1:]), *(30, 0)[len(sys.argv) - 1 :])
    for name, value in compare(COUNT, SEED).items():
        print(f"{name}: {value:.3g}")
