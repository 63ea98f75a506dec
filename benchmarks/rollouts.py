"""Thousands of rollouts at once against one by one; broken limits among them.

`python -m benchmarks rollouts` measures; `python -m benchmarks.rollouts 1000` also counts the
limits that random rollouts of three arms break, half of them from starts at their limits.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from collections import Counter
from typing import TYPE_CHECKING, Any

import numpy as np

import hitjoints as hj
from benchmarks.harness import Figure, Row, compare, seconds
from hitjoints.planning.start import fastest_start
from tests.oracles import random_rollouts as oracle

if TYPE_CHECKING:
    from hitjoints.types import Array

COUNT, ALONE, DIFFERENT = 10_000, 20, 1000
H, AT = np.array([0.0, 1.0, 0.0]), np.array([0.5, 0.3, 0.5])
JOINT, MASS, FLUX = 6, 2.0, 0.3
BESIDE = 0.03
"""m by which the starts differ, to all sides."""


def measure() -> list[Row | Figure]:
    """Return batches of one hit, and of different ones, against the same one by one."""
    robot = hj.load_robot("iiwa14")
    hit = hj.Hit(JOINT, AT, H, MASS, FLUX)
    rows: list[Row | Figure] = []
    for what, count, hits, target in (
        (f"{COUNT:,} rollouts of a hit", COUNT, [hit] * COUNT, ">= 50"),
        (f"{DIFFERENT:,} rollouts of different hits", DIFFERENT, different(hit, DIFFERENT), ""),
    ):
        q0, q_hit = starts(robot, hits)
        together = hj.rollouts(robot, hits, q0, q_hit=q_hit)
        able = np.flatnonzero(together.steps)[:: max(1, count // ALONE)]
        rows += [
            against_alone(what, robot, hits, (q0, q_hit), able, target),
            Figure(f"{what}: hits", float(together.hit.mean()), ""),
            Figure(f"{what}: beyond a limit", float((~together.within_limits).sum()), "", "<= 0"),
        ]
    whole = Figure(
        "map of delivered flux, 20 x 20 x 3 joints, the command", seconds(a_map), "s", "<= 30"
    )
    return [*rows, whole]


def a_map() -> None:
    """Run `hitjoints sweep motion` in a folder of its own, imports and compiling included."""
    with tempfile.TemporaryDirectory() as folder:
        words = [sys.executable, "-m", "hitjoints.cli", "sweep", "motion", "--out", "map.zarr"]
        done = subprocess.run(
            [*words, "--x=-0.8:0.8:20", "--y=-0.8:0.8:20"],
            cwd=folder,
            check=False,
            capture_output=True,
        )
        assert done.returncode == 0, done.stderr


def against_alone(
    what: str, robot: hj.Robot, hits: list[hj.Hit], q: tuple[Array, Array], able: Any, target: str
) -> Row:
    """Return the gain over rolling some of them out alone."""
    q0, q_hit = q

    def ours() -> hj.Rollouts:
        return hj.rollouts(robot, hits, q0, q_hit=q_hit)

    def alone() -> list[Any]:
        return [hj.rollout(robot, hits[i], q0=q0[i], q_hit=q_hit[i]) for i in able]

    together = ours()
    off = max(
        abs(one.impact.flux - together.flux[i])
        for i, one in zip(able, alone(), strict=True)
        if one.impact is not None
    )
    assert off < 1e-9, off
    return compare(
        what,
        ("hj.rollouts", ours, len(hits)),
        ("hj.rollout one by one", alone, len(able)),
        target=target,
        repeats=3,
    )


def different(hit: hj.Hit, count: int) -> list[hj.Hit]:
    """Return hits at places and with fluxes round about one."""
    rng = np.random.default_rng(1)
    places = hit.position + rng.uniform(-0.05, 0.05, (count, 3))
    fluxes = rng.uniform(0.5, 1.2, count) * hit.desired_flux
    return [hj.Hit(JOINT, at, H, MASS, flux) for at, flux in zip(places, fluxes, strict=True)]


def starts(robot: hj.Robot, hits: list[hj.Hit]) -> tuple[Array, Array]:
    """Return starts behind the objects, somewhat beside the lines, and hitting configurations."""
    best = hj.plan(robot, AT, H, MASS, [JOINT], "straight-flux", certificate=False).best
    assert best is not None
    begin = fastest_start(robot, best.q, JOINT, H).q
    rng, targets = np.random.default_rng(0), np.array([hit.position for hit in hits])
    way = hj.position(robot, begin, JOINT) - AT
    behind = targets + way + rng.uniform(-BESIDE, BESIDE, targets.shape)
    ends = hj.place_joint(robot, JOINT, targets, start=best.q).q
    return hj.place_joint(robot, JOINT, behind, start=begin).q, ends


def count_violations(count: int) -> dict[str, Any]:
    """Return the limits broken by random rollouts with compiled steps, and how these ended."""
    asked = list(oracle.random_cases(count))
    ends, broken, steps, certified = Counter[str](), 0, 0, 0
    for robot in dict.fromkeys(each[0] for each in asked):
        mine = [each for each in asked if each[0] is robot]
        q0, q_hit = (np.array([each[i] for each in mine]) for i in (2, 3))
        found = hj.rollouts(robot, [each[1] for each in mine], q0, q_hit=q_hit)
        broken += int((~found.within_limits).sum())
        steps += int(found.steps.sum())
        certified += int(found.certified_steps.sum())
        ends.update(reason.split(" ")[0] or "hit" for reason in found.reason)
    return {
        "rollouts": count,
        "steps": steps,
        "not compiled": certified,
        "beyond a limit": broken,
        "ends": dict(ends),
    }


if __name__ == "__main__":
    for figure in measure():
        print(figure)
    print(count_violations(int([*sys.argv[1:], "1000"][0])))
