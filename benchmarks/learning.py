"""What the learnt feasibility is worth: on hits it has not seen, against dense random sampling."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

import hitjoints as hj
from benchmarks.harness import Figure, Row, compare, seconds
from hitjoints.built import kernel_for
from hitjoints.model.robot import Contact
from hitjoints.planning.learning.feasibility import Feasibility, learn_feasibility
from hitjoints.planning.learning.greatest_flux import maximum_flux, random_positions
from hitjoints.vectors import unit

if TYPE_CHECKING:
    from hitjoints.model.robot import Robot
    from hitjoints.types import Array

JOINTS, MASS = (5, 6, 7), 2.0
HITS, DENSE = 300, 4096  # held out, and configurations that give the exact answer of each
RANDOM, PROPOSED = 2048, 128  # longest search of each kind
QUALITY = 0.99  # share of the greatest flux a search has to reach
MOST = 0.9  # share of the hits in which it has to
TIMED = 60


def measure() -> list[Row | Figure]:
    """Return how right the answers are, and how much sooner a good configuration is found."""
    robot = hj.load_robot("iiwa14")
    rows: list[Row | Figure] = []
    for joint in JOINTS:
        contact, rng = Contact(joint), np.random.default_rng(1000 + joint)
        kernel = kernel_for(robot, (contact,), ("flux",))
        learnt: list[Feasibility] = []
        spent = seconds(lambda: learnt.append(learn_feasibility(robot, contact, MASS)))  # noqa: B023
        at = random_positions(robot, contact, HITS, rng)
        h = unit(rng.normal(size=(HITS, 3)))
        exact = maximum_flux(robot, contact, MASS, at, h, DENSE, 1000 + joint)[0]
        # What a proposal attains can be attained, whether or not the dense samples show it.
        for i in np.flatnonzero(exact):
            best = kernel(learnt[0].propose(at[i], h[i], PROPOSED), h[i], MASS)["flux"][0].max()
            exact[i] = max(exact[i], best)
        rows.append(Figure(f"joint {joint}: learning feasibility", spent, "s", "<= 60"))
        rows += judge_answers(learnt[0], at, h, exact, rng)
        rows += compare_searches(robot, learnt[0], at[exact > 0], h[exact > 0])
    return rows


def judge_answers(
    learnt: Feasibility, at: Array, h: Array, exact: Array, rng: np.random.Generator
) -> list[Figure]:
    """Return accuracy, Brier score and calibration error of the probabilities."""
    asked = rng.uniform(0.0, 1.05 * np.quantile(exact, 0.99), (10, HITS))
    found = np.array([learnt.probability(at, h, flux) for flux in asked]).ravel()
    truth = (exact >= asked).ravel()
    base = truth.mean()
    bins, error = np.minimum((10 * found).astype(int), 9), 0.0
    for i in np.unique(bins):
        here = bins == i
        error += abs(found[here].mean() - truth[here].mean()) * here.mean()
    name = f"joint {learnt.contact.joint}: can it produce a flux,"
    brier, ignorant = float(np.mean((found - truth) ** 2)), float(base * (1 - base))
    return [
        Figure(f"{name} right answers of {truth.size}", np.mean((found > 0.5) == truth), ""),
        Figure(f"{name} Brier score (always saying {base:.2f}: {ignorant:.3f})", brier, ""),
        Figure(f"{name} calibration error", error, ""),
    ]


def compare_searches(robot: Robot, learnt: Feasibility, at: Array, h: Array) -> list[Row | Figure]:
    """Count the configurations that each search needs, and time those two searches."""
    contact = learnt.contact
    kernel = kernel_for(robot, (contact,), ("flux",))

    def best(q: Array, direction: Array) -> Array:
        return np.maximum.accumulate(kernel(q, direction, MASS)["flux"][0])

    def propose(i: int, count: int) -> Array:
        return best(learnt.propose(at[i], h[i], count), h[i])

    def draw(i: int, count: int) -> Array:
        placed = hj.place_joint(robot, contact, np.tile(at[i], (count, 1)), seed=i)
        return best(placed.q[placed.solved], h[i])

    each = range(len(at))
    proposed, drawn = [propose(i, PROPOSED) for i in each], [draw(i, RANDOM) for i in each]
    top = [max(p[-1], d[-1]) for p, d in zip(proposed, drawn, strict=True)]
    needs: dict[str, int] = {}
    figures: list[Row | Figure] = []
    for name, curves, longest in (("learnt", proposed, PROPOSED), ("random", drawn, RANDOM)):
        counts = [
            int(np.argmax(c >= QUALITY * t)) + 1 if c[-1] >= QUALITY * t else longest + 1
            for c, t in zip(curves, top, strict=True)
        ]
        needs[name] = min(int(np.quantile(counts, MOST, method="higher")), longest)
        what = f"joint {contact.joint}: {name} configurations to {QUALITY:.0%} of the greatest flux"
        figures.append(Figure(f"{what}, median", float(np.median(counts)), ""))
    chosen = range(min(TIMED, len(at)))
    row = compare(
        f"joint {contact.joint}: within {1 - QUALITY:.0%} of the greatest flux, {MOST:.0%} of hits",
        (
            f"{needs['learnt']} learnt proposals",
            lambda: [propose(i, needs["learnt"]) for i in chosen],
            len(chosen),
        ),
        (
            f"{needs['random']}{' (too few)' * (needs['random'] == RANDOM)} random configurations",
            lambda: [draw(i, needs["random"]) for i in chosen],
            len(chosen),
        ),
    )
    return [*figures, row]
