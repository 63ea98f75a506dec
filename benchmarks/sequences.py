"""Goals that one hit cannot reach, reached by several in the physics engine.

Each hit starts from where the engine left the box after the last one, and is asked for anew.

python -m benchmarks.sequences [--count 12] [--hits 3] [--seed 0]
"""

from __future__ import annotations

import argparse
import math
from collections import Counter

import numpy as np

import hitjoints as hj
from hitjoints.answers.answer_record import Answer
from hitjoints.answers.hit_sequence import sequence
from hitjoints.answers.single_hit import SingleHit
from hitjoints.hit_setting import HitSetting

ROBOT = "iiwa14"
TOLERANCE = 0.03


def wish(rng: np.random.Generator, hits: int) -> hj.Hit:
    """Return a goal that is mostly too far for one hit."""
    angle, radius = rng.uniform(-1.0, 1.0), rng.uniform(0.4, 0.6)
    place = np.array([radius * math.cos(angle), radius * math.sin(angle), rng.uniform(0.3, 0.5)])
    way, distance = rng.uniform(-math.pi, math.pi), rng.uniform(0.3, 0.6)
    return hj.Hit(
        None,
        place,
        mass=rng.uniform(0.8, 2.0),
        goal=place + distance * np.array([math.cos(way), math.sin(way), 0.0]),
        friction=rng.uniform(0.2, 0.4),
        restitution=rng.uniform(0.3, 0.6),
        size=rng.uniform(0.08, 0.14, 3),
        spread={"friction": 0.01, "mass": 0.05},
        setting=HitSetting(hits=hits, tolerance=TOLERANCE),
    )


def carried_out(single: SingleHit, hit: hj.Hit) -> tuple[str, int, float]:
    """Ask, make the first hit in the engine, and ask again from where the box rests.

    Returns:
        What became of it, how many hits were made, and how far from the goal the box is (m).
    """
    left, yaw, made = hit, hit.yaw, 0
    assert hit.goal is not None
    while True:
        found = _answer(single, left)
        away = float(np.linalg.norm(hit.goal - left.position))
        if found is None:
            return "no" if made == 0 else "no further", made, away
        first = found.hits[0] if found.hits else found
        assert first.swing is not None
        rest = hj.simulate(first.swing).rest
        assert rest is not None
        made += 1
        away = float(np.linalg.norm(rest.place - hit.goal))
        if away <= TOLERANCE or made == hit.setting.hits:
            return "arrived" if away <= TOLERANCE else "missed", made, away
        turned = _heading(first.hit.direction) + first.hit.yaw + rest.yaw
        yaw = turned - _heading(hit.goal - rest.place)
        yaw -= round(yaw / (math.pi / 2)) * math.pi / 2  # another face, where one is nearer
        left = found.left(rest.place, yaw)


def _answer(single: SingleHit, hit: hj.Hit) -> Answer | None:
    """Return the answer of one hit or of several; None for a no."""
    one = single.answer(hit)
    if one.verdict == "sendable":
        return one
    made = sequence(single, hit)[0] if hit.setting.hits > 1 else ()
    return None if not made else hj.Answer(**(vars(made[0]) | {"hit": hit, "hits": made}))


def _heading(way: np.ndarray) -> float:
    return math.atan2(way[1], way[0])


def main() -> None:
    """Print what became of each goal, and the counts."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=12)
    parser.add_argument("--hits", type=int, default=3)
    parser.add_argument("--seed", type=int, default=0)
    asked = parser.parse_args()
    single = SingleHit(hj.load_robot(ROBOT), simulated=False, proved=False)
    counts, misses = Counter[str](), []
    for number in range(asked.count):
        hit = wish(np.random.default_rng((asked.seed, number)), asked.hits)
        state, made, away = carried_out(single, hit)
        counts[f"{state} after {made}" if made else state] += 1
        if state == "arrived" and made > 1:
            misses.append(away)
        print(f"goal {number}: {state}, {made} hits, {1e3 * away:.1f} mm off", flush=True)
    print(f"{asked.count} goals, seed {asked.seed}: {dict(sorted(counts.items()))}")
    if misses:
        print(f"by several: {1e3 * float(np.median(misses)):.1f} mm off in the median")


if __name__ == "__main__":
    main()
