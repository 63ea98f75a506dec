"""Meshes, collision shapes and tools at random: an answer, or one line that says why not.

python -m benchmarks.shapes_fuzz [--count 1000] [--seed 0]
"""

from __future__ import annotations

import argparse
import random
import re
import sys
import warnings
from collections import Counter
from collections.abc import Callable, Iterator
from functools import partial

import coal
import numpy as np

import hitjoints as hj
from hitjoints.errors import HitjointsError
from hitjoints.model.meshes import MeshError, check_surface, convex_hull
from hitjoints.types import Array

VALUES = (
    "0.1", "0.1 0.2 0.3", "", "0", "-1", "nan", "inf", "1e308", "1e-320", "a", "0 0", "0 0 0",
    "0 0 0 0", "1 1", "1_0", "1 ", "-0", "1e400", "0x10", "1,2", "9" * 400,
)  # fmt: skip
NUMBERS: tuple[object, ...] = (
    0.5, [0, 0.1, 0.2], None, 0, -1, 1, float("nan"), float("inf"), "a", [], [1, 2], [0, 0, 0],
    [1, 1, 1], [[1, 0, 0], [0, 1, 0], [0, 0, 1]], {}, True, 10**400, 1e308, [1e308] * 3,
    ["a"] * 3, [1j, 0, 0],
)  # fmt: skip
TOOL = {"mass": 0.8, "com": [0, 0, 0.1], "inertia": [1e-3] * 3, "tip": [0, 0, 0.1], "radius": 0.02}
SHAPES = (
    '<collision><origin xyz="0 0 0.1" rpy="0 1 0"/><geometry><box size="0.1 0.1 0.3"/></geometry>'
    '</collision><collision><geometry><sphere radius="0.1"/></geometry></collision><collision>'
    '<geometry><capsule radius="0.05" length="0.2"/></geometry></collision>'
)


def cloud(chance: np.random.Generator) -> Array:
    """Return points that are thin, small, large, far, doubled or on a grid."""
    n, kind = int(chance.integers(3, 60)), int(chance.integers(4))
    points = [
        chance.normal(size=(n, 3)) * 10.0 ** chance.uniform(-16, 0, 3),
        chance.integers(0, 3, (n, 3)) * 10.0 ** chance.uniform(-16, 0, 3),
        np.column_stack([chance.normal(size=(n, 2)), np.zeros(n)]),
        chance.integers(0, 2, (n, 3)) * [1, 1, 10.0 ** chance.uniform(-16, 0)],
    ][kind]
    turn = np.linalg.qr(chance.normal(size=(3, 3)))[0]
    away = chance.normal(size=3) * 10.0 ** chance.uniform(-3, 3)
    return np.asarray(points @ turn * 10.0 ** chance.uniform(-6, 4) + away)


def hull(points: Array) -> None:
    """Make the hull of points, and check that it reaches as far as they do."""
    mesh = coal.BVHModelOBBRSS()
    mesh.beginModel(0, len(points))
    mesh.addVertices(points)
    mesh.endModel()
    check_surface(mesh, "cloud")
    solid = convex_hull(mesh)
    corners = np.array([solid.point(i) for i in range(solid.num_points)])
    short = (points.max(axis=0) - corners.max(axis=0)).max()
    assert short <= 1e-9 * np.abs(points).max(), "a point outside of its hull"


def described(choice: random.Random) -> None:
    """Load an arm with one to three changed numbers, and ask for its clearance."""
    shapes = SHAPES
    for _ in range(choice.randint(1, 3)):
        at = choice.choice(list(re.finditer(r'="([^"]*)"', shapes)))
        shapes = shapes[: at.start(1)] + choice.choice(VALUES) + shapes[at.end(1) :]
    first, rest = hj.load_robot("iiwa14").xml.split("</link>", 1)
    text = f"{first}{shapes}</link>{rest}"
    robot = hj.load_robot(text)
    found = hj.clearance(robot, robot.home, 6, [1, 0, 0], table_height=-1.0)
    assert not np.isnan([found.table, found.itself]).any(), "a clearance that is no number"


def held(choice: random.Random) -> None:
    """Weld a tool with one to three changed entries."""
    entries = TOOL | {choice.choice(list(TOOL)): choice.choice(NUMBERS) for _ in range(3)}
    hj.load_robot("iiwa14", tool=entries)


def cases(count: int, seed: int) -> Iterator[tuple[str, Callable[[], None]]]:
    """Yield what to try, by name."""
    chance, choice = np.random.default_rng(seed), random.Random(seed)
    for _ in range(count):
        yield "hulls", partial(hull, cloud(chance))
        yield "shapes", partial(described, choice)
        yield "tools", partial(held, choice)


def run(count: int, seed: int) -> tuple[Counter[str], list[str]]:
    """Return how often what came of it, and everything that should not have."""
    came: Counter[str] = Counter()
    wrong = []
    for name, case in cases(count, seed):
        try:
            case()
            came[f"{name} done"] += 1
        except (HitjointsError, MeshError) as error:
            came[f"{name} refused"] += 1
            wrong += [f"{name}: not one line: {error}"] if "\n" in str(error) else []
        except Exception as error:
            wrong.append(f"{name}: {type(error).__name__}: {error}")
    return came, wrong


def main() -> None:
    """Try as many as asked for, and tell."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=0)
    asked = parser.parse_args()
    warnings.simplefilter("error", RuntimeWarning)
    warnings.simplefilter("ignore", hj.ModelWarning)
    came, wrong = run(asked.count, asked.seed)
    print(dict(came), *wrong[:20], sep="\n")
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
