"""Verdicts of random goals: objects arrive as often as the stated share says.

Each goal that is granted is hit again and again in the physics engine, with masses, frictions,
restitutions, turns, offsets and speeds drawn within the stated spreads.

python -m benchmarks.verdicts [--count 200] [--draws 3] [--seed 0] [--out FILE]
"""

from __future__ import annotations

import argparse
import json
import math
import sys
from collections import Counter
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

import hitjoints as hj
from hitjoints.answers.single_hit import SingleHit
from hitjoints.errors import HitjointsError
from hitjoints.evidence.physics.setting import setting
from hitjoints.evidence.physics.simulation import impact_of
from hitjoints.evidence.physics.slide import slide
from hitjoints.evidence.physics.strike import strike
from hitjoints.hit_setting import HitSetting
from hitjoints.swings.as_rollout import as_rollout

ROBOT = "iiwa14"
BINS = (0.0, 0.5, 0.8, 0.95, 1.01)


def wish(rng: np.random.Generator) -> hj.Hit:
    """Return a random goal for a box."""
    angle, radius = rng.uniform(-1.0, 1.0), rng.uniform(0.4, 0.65)
    place = np.array([radius * math.cos(angle), radius * math.sin(angle), rng.uniform(0.3, 0.5)])
    way, distance = rng.uniform(-math.pi, math.pi), float(np.exp(rng.uniform(-3.0, -1.0)))
    mass, friction, restitution = (
        rng.uniform(0.5, 2.5),
        rng.uniform(0.2, 0.5),
        rng.uniform(0.2, 0.7),
    )
    return hj.Hit(
        None,
        place,
        mass=mass,
        goal=place + distance * np.array([math.cos(way), math.sin(way), 0.0]),
        friction=friction,
        restitution=restitution,
        size=rng.uniform(0.08, 0.14, 3),
        spread={
            "mass": mass * rng.uniform(0.0, 0.15),
            "friction": friction * rng.uniform(0.02, 0.12),
            "restitution": rng.uniform(0.0, 0.05),
            "yaw": math.radians(rng.uniform(0.0, 2.0)),
            "offset": rng.uniform(0.0, 0.005),
            "speed": rng.uniform(0.0, 0.01),
        },
        setting=HitSetting(tolerance=rng.uniform(0.005, 0.03)),
    )


def arrives(swing: hj.Swing, rng: np.random.Generator) -> bool:
    """Hit an object that is not quite what was told, in the engine; tell whether it arrives."""
    hit, motion = swing.hit, as_rollout(swing)
    off = {name: rng.standard_normal() * value for name, value in (hit.spread or {}).items()}
    assert hit.goal is not None
    assert hit.size is not None
    how = setting(
        "ideal",
        restitution=min(max((hit.restitution or 0.0) + off["restitution"], 0.0), 1.0),
        size=tuple(hit.size.tolist()),
        friction=(hit.friction or 0.0) + off["friction"],
        yaw=hit.yaw + off["yaw"],
        off_centre=off["offset"],
    )
    at = impact_of(motion)
    real = replace(at, mass=hit.mass + off["mass"], qd=at.qd * (1 + off["speed"]))
    found = strike(swing.robot, real, how, lambda _: real.qd, 0.0)
    slid = slide(real, how, *found.box)
    way = slid.rows["slide_position"][-1] - real.box_centre(how)
    return bool(np.linalg.norm((hit.position + way - hit.goal)[:2]) <= hit.setting.tolerance)


def run(count: int, draws: int, seed: int) -> dict[str, Any]:
    """Ask for goals and judge the answers.

    Args:
        count: of the goals.
        draws: hits of each in the engine.
        seed: of all.
    """
    robot = hj.load_robot(ROBOT)
    single, verdicts, rows = SingleHit(robot, simulated=False, proved=False), Counter[str](), []
    for number in range(count):
        rng = np.random.default_rng((seed, number))
        try:
            found = single.answer(wish(rng))
        except HitjointsError as error:
            verdicts[f"error: {error}"] += 1
            continue
        verdicts[found.verdict] += 1
        if found.swing is None or found.landing is None:
            continue
        again = hj.landing(
            robot, found.swing.q_hit, found.hit, found.swing.speed, samples=4000, seed=seed + 1
        )
        tried = [arrives(found.swing, rng) for _ in range(draws)]
        if (number + 1) % 20 == 0:
            print(f"{number + 1} goals", file=sys.stderr, flush=True)
        rows.append((found.landing.within, again.within, float(np.mean(tried))))
    return {"count": count, "draws": draws, "seed": seed, "verdicts": verdicts, "rows": rows}


def told(result: dict[str, Any]) -> str:
    """Return the shares in a table, in per cent."""
    rows = np.array(result["rows"]).reshape(-1, 3)
    lines = [f"{result['count']} goals, seed {result['seed']}: {dict(result['verdicts'])}"]
    lines.append("stated share   goals   stated   other draws   engine")
    groups = [
        (f"{100 * a:3.0f} to {min(100 * b, 100):3.0f}", (rows[:, 0] >= a) & (rows[:, 0] < b))
        for a, b in pairwise(BINS)
    ]
    for name, chosen in [*groups, ("all", np.ones(len(rows), dtype=bool))]:
        if chosen.any():
            means = "   ".join(f"{100 * mean:6.1f}" for mean in rows[chosen].mean(axis=0))
            lines.append(f"{name:>12}   {chosen.sum():5d}   {means}")
    spread = np.abs(rows[:, 0] - rows[:, 1]).max(initial=0.0)
    error = rows[:, 2].std() / math.sqrt(max(len(rows), 1))
    lines.append(f"other draws differ by {100 * spread:.1f} points at most for one goal; the mean")
    lines.append(f"of the engine's column has a standard error of {100 * error:.1f} points")
    return "\n".join(lines)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--draws", type=int, default=3)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--out", type=Path)
    asked = parser.parse_args()
    result = run(asked.count, asked.draws, asked.seed)
    print(told(result))
    if asked.out is not None:
        asked.out.write_text(json.dumps(result), encoding="utf-8")


if __name__ == "__main__":
    main()
