"""Directions in which real boxes slid, beside the law's: `python -m benchmarks.landing_directions`.

The law takes each recorded offset, yaw and distance. What the table does not tell is assumed and
varied: the box's edges and its friction. The hit is taken to be level, at half the height.
"""

from __future__ import annotations

import csv
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np

from hitjoints.constants import GRAVITY
from hitjoints.goals.box_hit import Boxes, hit_boxes
from hitjoints.goals.sliding import slide_to_rest
from hitjoints.types import Array

TABLE = Path("tests/data/landing/object_1.csv")
MASS, INERTIA, RESTITUTION = 0.4, 4.5, 0.5
"""kg, of the box; kg, what the arms show, about; assumed. Directions hardly depend on them."""
EDGES, FRICTIONS = (0.1, 0.15, 0.2, 0.25), (0.2, 0.4, 0.6)
"""m, and mu: assumed."""
REACH = 0.95
"""Share of the half face beyond which nothing is hit."""


class Way(NamedTuple):
    """One landing: m; rad, to the left of the hitting direction."""

    arm: str
    offset: float
    yaw: float
    distance: float
    direction: float


def ways(table: Path) -> Iterator[Way]:
    """Yield the landings of a table; arm 7 hits along y, arm 14 against it."""
    with table.open(encoding="utf-8") as file:
        for row in csv.DictReader(file):
            ahead = 1.0 if row["arm"] == "7" else -1.0  # left is -x, or x
            hit_x, qz, x, y, to_x, to_y = (
                float(row[name])
                for name in ("hit_x", "yaw_qz", "start_x", "start_y", "end_x", "end_y")
            )
            along, left = ahead * (to_y - y), -ahead * (to_x - x)
            yield Way(
                row["arm"], -ahead * (hit_x - x), 2 * float(np.arcsin(qz)),
                float(np.hypot(along, left)), float(np.arctan2(left, along)),
            )  # fmt: skip


def told(found: list[Way], edge: float, friction: float) -> Array:
    """Return the law's directions, (N,) degrees, of boxes that go as far as they did."""
    one = np.ones(len(found))
    offset, yaw, distance = np.array([(w.offset, w.yaw, w.distance) for w in found]).T
    most = (REACH * np.cos(yaw) - np.abs(np.sin(yaw))) * edge / 2
    boxes = Boxes(
        MASS * one, np.full(3, edge), yaw, np.clip(offset, -most, most), 0.0, friction * one
    )
    speed = np.sqrt(2 * friction * GRAVITY * distance) * (1 + MASS / INERTIA) / (1 + RESTITUTION)
    left = hit_boxes(boxes, INERTIA * one, speed, RESTITUTION * one)
    slid = slide_to_rest(left.velocity, left.spin, boxes.size, boxes.friction, yaw=yaw)
    return np.asarray(np.degrees(np.arctan2(*slid.displacement.T[::-1])))


def slopes(found: list[Way], directions: Array) -> tuple[Array, float]:
    """Return degrees per mm of offset and per degree of yaw, and the share they explain."""
    told_by = np.array([(1.0, 1e3 * w.offset, np.degrees(w.yaw)) for w in found])
    fit = np.linalg.lstsq(told_by, directions)[0]
    return fit[1:], float(1 - np.var(directions - told_by @ fit) / np.var(directions))


def sticking(edge: float) -> float:
    """Return the degrees per mm of offset of a cube whose hit face sticks to the link.

    The impulse then has a sideways part, -3 b / edge / (2.5 + m / lambda) of it, b the offset.
    """
    return float(-np.degrees(3e-3 / edge / (2.5 + MASS / INERTIA)))


def main(table: Path) -> None:
    """Print what is recorded, and what the law says for each assumption."""
    rows = list(ways(table))
    for arm in sorted({row.arm for row in rows}):
        found = [row for row in rows if row.arm == arm]
        recorded = np.degrees([row.direction for row in found])
        fit, explained = slopes(found, recorded)
        print(
            f"arm {arm}, {len(found)} hits: spread {recorded.std(ddof=1):.1f} degrees, "
            f"{fit[0]:+.2f} per mm of offset, {fit[1]:+.1f} per degree of yaw, "
            f"which explain {100 * explained:.0f} %"
        )
        for edge in EDGES:
            for friction in FRICTIONS:
                law = told(found, edge, friction)
                own, _ = slopes(found, law)
                print(
                    f"  law, edge {edge:.2f} m, friction {friction:.1f}: spread "
                    f"{law.std(ddof=1):.1f}, {own[0]:+.2f} per mm, {own[1]:+.1f} per degree, "
                    f"correlation {np.corrcoef(law, recorded)[0, 1]:+.2f}"
                )
            print(f"  a link that sticks, edge {edge:.2f} m: {sticking(edge):+.2f} per mm more")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else TABLE)
