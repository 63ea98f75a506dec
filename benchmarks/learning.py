"""What the learnt feasibility is worth: on hits it has not seen, against dense random sampling."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

import numpy as np

import hitjoints as hj
from benchmarks.harness import Row, compare, seconds
from hitjoints.planning.feasibility import (
    Feasibility,
    learn_feasibility,
    maximum_flux,
    random_positions,
)
from hitjoints.quantities import kernel_for
from hitjoints.robot import Contact
from hitjoints.vectors import unit

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from hitjoints.robot import Robot

    Array = NDArray[np.float64]

JOINTS, MASS = (5, 6, 7), 2.0
HITS, DENSE = 300, 4096  # held out, and configurations that give the exact answer of each
RANDOM, PROPOSED = 2048, 128  # longest search of each kind
QUALITY = 0.99  # share of the greatest flux a search has to reach
MOST = 0.9  # share of the hits in which it has to
TIMED = 60


def measure() -> list[Row]:
    """Return how much sooner a good configuration is found; print how right the answers are."""
    robot, rows = hj.load_robot("iiwa14"), []
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
        _say(f"joint {joint}: learnt in {spent:.1f} s, {len(learnt[0].hits)} hits")
        report_answers(learnt[0], at, h, exact, rng)
        rows.append(compare_searches(robot, learnt[0], at[exact > 0], h[exact > 0]))
    return rows


def report_answers(
    learnt: Feasibility, at: Array, h: Array, exact: Array, rng: np.random.Generator
) -> None:
    """Print accuracy, Brier score and reliability of the probabilities."""
    asked = rng.uniform(0.0, 1.05 * np.quantile(exact, 0.99), (10, HITS))
    found = np.array([learnt.probability(at, h, flux) for flux in asked]).ravel()
    truth = (exact >= asked).ravel()
    base = truth.mean()
    _say(
        f"  can it? right {np.mean((found > 0.5) == truth):.1%} of {truth.size}, Brier score "
        f"{np.mean((found - truth) ** 2):.4f} (always {base:.2f}: {base * (1 - base):.4f})"
    )
    bins, cells, error = np.minimum((10 * found).astype(int), 9), [], 0.0
    for i in np.unique(bins):
        here = bins == i
        cells.append(f"{found[here].mean():.2f}->{truth[here].mean():.2f} ({here.sum()})")
        error += abs(found[here].mean() - truth[here].mean()) * here.mean()
    _say(f"  said->true (answers): {', '.join(cells)}; calibration error {error:.4f}")


def compare_searches(robot: Robot, learnt: Feasibility, at: Array, h: Array) -> Row:
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
    needs = {}
    for name, curves, longest in (("learnt", proposed, PROPOSED), ("random", drawn, RANDOM)):
        counts = [
            int(np.argmax(c >= QUALITY * t)) + 1 if c[-1] >= QUALITY * t else longest + 1
            for c, t in zip(curves, top, strict=True)
        ]
        needs[name] = min(int(np.quantile(counts, MOST, method="higher")), longest)
        _say(
            f"  {QUALITY:.0%} of the greatest flux, {name}: {np.median(counts):g} configurations "
            f"in the median, {needs[name]} in {MOST:.0%} of the hits; "
            f"{np.mean(np.array(counts) > longest):.1%} not within {longest}"
        )
    chosen = range(min(TIMED, len(at)))
    return compare(
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


def _say(text: str) -> None:
    print(text, file=sys.stderr)
