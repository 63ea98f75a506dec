"""Boxes hit off centre, turned, high or low, in the engine: `python -m benchmarks.boxes 60`."""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Iterator
from itertools import islice
from typing import Any, NamedTuple

import numpy as np

import hitjoints as hj
from benchmarks.harness import Figure
from hitjoints.evidence.physics.simulated_hit import Simulation
from hitjoints.goals.sliding import Support
from hitjoints.hit import Hit
from hitjoints.model.robot import Robot
from hitjoints.rollouts.prepare import Preparation
from tests.oracles.random_rollouts import feasible_hits

Planned = tuple[Robot, Hit, Preparation]
ROBOTS = ("iiwa14", "iiwa7", "panda")
SUPPORTS: tuple[Support, ...] = ("corners", "face")
WEAKEST = 0.2
"""m/s, of flux."""
SPINNING = 0.1
"""Share of what the greatest lever would give: boxes that turn less are left out of the spin's."""
SHORTEST = 0.02
"""m, that a box goes at least."""
MOST = 20
"""Boxes tried for each that is to fall."""
TRIES = 10
"""Boxes for each hit, until one slides."""
MARGIN = 0.9
"""Share of the half face within which it is hit."""


class Off(NamedTuple):
    """How far a simulated box is from the predicted one: shares of the prediction, and degrees."""

    distance: float
    miss: float
    direction: float
    yaw: float
    speed: float
    spin: float


def off(result: Simulation) -> Off:
    """Return how far a box is from where it should be."""
    told, found = result.predicted_rest, result.rest
    assert told is not None
    assert found is not None
    width = result.setting.size[1]
    lever = abs(result.impact.face_point(result.setting)[1])
    spins = lever > SPINNING * width / 2
    return Off(
        abs(found.distance / told.distance - 1),
        found.miss(told) / told.distance,
        abs(np.degrees(found.direction - told.direction)),
        abs(np.degrees(found.yaw - told.yaw)),
        abs(found.speed / told.speed - 1),
        abs(found.spin / told.spin - 1) if spins else 0.0,
    )


def random_box(rng: np.random.Generator, *, central: bool = False) -> dict[str, Any]:
    """Return a box and where it is hit, by the arguments of `simulate`.

    Off its centre by up to a third of the face, turned by up to 20 degrees, up to a third of its
    height above or below its centre; or central and level.
    """
    while True:
        size = tuple(float(edge) for edge in rng.uniform((0.08, 0.08, 0.05), (0.25, 0.25, 0.2)))
        box: dict[str, Any] = {
            "size": size,
            "friction": float(rng.uniform(0.15, 0.6)),
            "restitution": float(rng.uniform(0.1, 0.9)),
        }
        if central:
            return box
        aside, up = rng.uniform(-1 / 3, 1 / 3, 2)
        yaw = float(rng.uniform(-1, 1) * np.radians(20))
        lever = (-aside * size[1] + size[0] / 2 * np.sin(yaw)) / np.cos(yaw)
        if abs(lever) < MARGIN * size[1] / 2:
            where = {"off_centre": float(aside * size[1]), "height": float(up * size[2])}
            return box | where | {"yaw": yaw}


def level_hits(count: int) -> list[Planned]:
    """Return random planned level hits of three arms with joints 5 to 7, no weak ones."""
    found: list[Planned] = []
    for i, name in enumerate(ROBOTS):
        robot = hj.load_robot(name)
        share = count // len(ROBOTS) + (i < count % len(ROBOTS))
        hits = feasible_hits(robot, 5 * share, seed=i, away=name != "panda", level=True)
        hard = ((robot, hit, start) for hit, start in hits if hit.desired_flux > WEAKEST)
        found += islice(hard, share)
    return found


def random_boxes(
    hits: list[Planned], support: Support, left_out: Counter[str], *, central: bool = False
) -> Iterator[Simulation]:
    """Yield hits on random boxes that slide 2 cm at least.

    Args:
        hits: each on a box, and on others until one slides.
        support: what carries the boxes.
        left_out: counts those that do not, and are not among them.
        central: see `random_box`.
    """
    rng = np.random.default_rng(3)
    for robot, hit, start in hits:
        for _ in range(TRIES):
            box = random_box(rng, central=central)
            result = hj.simulate(
                robot, hit, **box, support=support, q0=start.q0,
                q_hit=start.q_hit,
            )  # fmt: skip
            told, why = result.predicted_rest, "it hardly moves"
            if told is None:
                why = result.unpredicted.split(": ")[1]
            elif told.distance >= SHORTEST:
                yield result
                break
            left_out[why] += 1


def falls(hits: list[Planned], support: Support, count: int) -> Counter[str]:
    """Hit tall boxes high or low until some have fallen, and count which were told to.

    Args:
        hits: tried in turn.
        support: what carries the boxes.
        count: how many are to fall.

    Returns:
        Of "fell, foretold", "fell, missed", "stood, foretold to fall", "stood": how many.
    """
    rng, found = np.random.default_rng(4), Counter[str]()
    for i in range(MOST * count):
        if found["fell, foretold"] + found["fell, missed"] == count:
            break
        robot, hit, start = hits[i % len(hits)]
        size = rng.uniform((0.05, 0.05, 0.12), (0.12, 0.15, 0.25))
        height = float(rng.choice((-1, 1)) * rng.uniform(0.1, 0.45) * size[2])
        friction = float(rng.uniform(0.1, min(0.6, 0.74 * size[0] / size[2])))
        result = hj.simulate(
            robot, hit, size=size, height=height, friction=friction, support=support,
            restitution=float(rng.uniform(0.1, 0.9)), yaw=float(rng.uniform(-0.2, 0.2)),
            q0=start.q0, q_hit=start.q_hit,
        )  # fmt: skip
        assert result.rest is not None
        told = "tip" in result.unpredicted
        fate = ("stood", "stood, foretold to fall", "fell, missed", "fell, foretold")
        found[fate[2 * result.rest.tipped + told]] += 1
    return found


def judge(results: list[Simulation], what: str, *, central: bool = False) -> list[Figure]:
    """Return what simulated boxes come to, beside what is asked."""
    offs = np.array([off(result) for result in results])
    shares = Off(100, 100, 1, 1, 100, 100)
    median, most, all_of = (Off(*(np.percentile(offs, p, axis=0) * shares)) for p in (50, 95, 100))
    if central:
        return [Figure(f"{what}: distance off, most", all_of.distance, "%", "<= 0.5")]
    return [
        Figure(f"{what}: miss, median", median.miss, "% of the way", "<= 1"),
        Figure(f"{what}: miss, 95 of 100", most.miss, "% of the way", "<= 4"),
        Figure(f"{what}: direction off, 95 of 100", most.direction, "degrees", "<= 2"),
        Figure(f"{what}: yaw off, 95 of 100", most.yaw, "degrees", "<= 10"),
        Figure(f"{what}: speed off, 95 of 100", most.speed, "%", "<= 0.3"),
        Figure(f"{what}: speed off, most", all_of.speed, "%", ""),
        Figure(f"{what}: spin off, 95 of 100", most.spin, "%", "<= 2"),
        Figure(f"{what}: spin off, most", all_of.spin, "%", ""),
    ]


def main(count: int) -> None:
    """Print every box, and what they come to."""
    hits = level_hits(count)
    for support in SUPPORTS:
        for central in (True, False):
            left_out, results = Counter[str](), []
            for result in random_boxes(hits, support, left_out, central=central):
                results.append(result)
                if not central:
                    one, how = off(result), result.setting
                    print(
                        f"{result.motion.robot.name:7} way {result.predicted_rest.distance:.3f} "  # type: ignore[union-attr]
                        f"mu {how.friction:.2f} z {how.height:+.3f} yaw {how.yaw:+.2f} "
                        f"off {how.off_centre:+.3f}: distance {100 * one.distance:.2f} miss "
                        f"{100 * one.miss:.2f} % direction {one.direction:.2f} yaw {one.yaw:.2f} "
                        f"speed {100 * one.speed:.2f} spin {100 * one.spin:.2f} %", flush=True,
                    )  # fmt: skip
            what = f"{len(results)} boxes on {support}, {'central' if central else 'anyhow'}"
            for figure in judge(results, what, central=central):
                print(f"{figure.what}: {figure.value:.3g} {figure.unit} {figure.target}")
            print(f"not simply sliding, and left out: {dict(left_out)}")
        print(f"tall boxes on {support}: {dict(falls(hits, support, count // 2))}", flush=True)


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 60)
