"""The planner before a referee: random hits, other seeds, and SLSQP from the best of many samples.

`python -m benchmarks.referee HITS` plans that many random hits of five arms, half of them near the
edge of reach, each with several seeds, and lets SciPy's SLSQP climb from the best 50 of 3,000
samples of its own. It prints every hit in which a plan is more than 0.2 % below the best value
known, with what its evidence said, and every refusal that another search contradicts.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

import hitjoints as hj
from tests.oracles.scipy_plans import SciPyPlanner

ROBOTS = ("iiwa14", "iiwa7", "panda", "xarm7", "ur5")
QUANTITIES = {
    "inertia": "inertia",
    "flux": "flux",
    "straight-flux": "straight_flux",
    "rebound": "inertia",
    "deliverable": "deliverable_flux",
}
FIRST_JOINT = 4
LOST = 2e-3
"""Share of the best value known that a plan may miss."""
NOTHING = 1e-5
"""A value below this is none: all that rounded angles leave of a direction."""
SAMPLES, STARTS = 3000, 50


@dataclass(frozen=True)
class Question:
    """One random hit.

    Attributes:
        robot: the arm.
        joint: what hits.
        objective: what is maximised.
        position: (3,) m.
        direction: (3,).
        mass: kg.
        away: whether the away condition is demanded.
    """

    robot: Any
    joint: int
    objective: str
    position: Any
    direction: Any
    mass: float
    away: bool

    def ask(self, objective: str, seed: int, flux: float | None = None) -> Any:
        """Return the plan's candidate."""
        return hj.plan(
            self.robot,
            self.position,
            self.direction,
            self.mass,
            joints=[self.joint],
            objective=objective,
            flux=flux,
            away=self.away,
            seed=seed,
            certificate=False,
        ).candidates[0]

    def __str__(self) -> str:
        """Return what repeats it."""
        return (
            f"{self.robot.name} joint {self.joint} {self.objective} "
            f"{self.position.tolist()} {self.direction.tolist()} {self.mass} away={self.away}"
        )


def questions(
    names: list[str], first: int, count: int, wanted: list[str] | None = None
) -> Iterator[Question]:
    """Yield random hits; number i is the same whatever the first and the count."""
    robots = [hj.load_robot(name) for name in names]
    for i in range(first, first + count):
        rng = np.random.default_rng((2026, i))
        robot = robots[i % len(robots)]
        joint = int(rng.integers(FIRST_JOINT, robot.n + 1))
        q = rng.uniform(*robot.finite_limits, (64, robot.n))
        at = np.array([hj.position(robot, row, joint) for row in q])
        position = at[0]
        if i // len(robots) % 2:
            # Near the edge of reach: the farthest of many, moved a little in or out.
            pivot = hj.position(robot, robot.home, 2)
            far = at[np.argmax(np.linalg.norm(at - pivot, axis=1))]
            position = pivot + (far - pivot) * rng.uniform(0.98, 1.01)
        h = rng.standard_normal(3)
        objective = (wanted or list(QUANTITIES))[int(rng.integers(len(wanted or QUANTITIES)))]
        yield Question(
            robot,
            joint,
            objective,
            position,
            h / np.linalg.norm(h),
            float(rng.uniform(0.2, 5.0)),
            bool(rng.random() < 0.5),
        )


def judge(question: Question, seeds: int, slsqp: bool, seed: int) -> dict[str, Any]:
    """Plan with several seeds and by SLSQP; return what each reached and how long it took."""
    flux, objective = None, question.objective
    if objective == "rebound":
        hardest = question.ask("flux", seed=0)
        flux = 0.9 * hardest.flux if hardest.feasible else 0.1
    begin = time.perf_counter()
    plans = [question.ask(objective, number, flux) for number in range(seeds)]
    spent = (time.perf_counter() - begin) / seeds
    values = [float(getattr(one, QUANTITIES[objective])) if one.feasible else 0.0 for one in plans]
    peer = None
    if slsqp:
        planner = SciPyPlanner(
            question.robot,
            question.joint,
            question.position,
            question.direction,
            question.mass,
            question.away,
        )
        rng = np.random.default_rng(seed)
        peer = planner.by_slsqp(objective, rng, SAMPLES, STARTS, least_flux=flux)
    return {"plans": plans, "values": values, "peer": peer, "seconds": spent, "flux": flux}


def main(arguments: list[str]) -> None:
    """Judge random hits and print the figures."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("hits", type=int)
    parser.add_argument("--seeds", type=int, default=4)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--robots", default=",".join(ROBOTS))
    parser.add_argument("--objectives", default="inertia,flux,straight-flux,rebound")
    parser.add_argument("--no-slsqp", action="store_true")
    asked = parser.parse_args(arguments)
    count: Counter[str] = Counter()
    times: list[float] = []
    names = asked.robots.split(",")
    hits = questions(names, asked.first, asked.hits, asked.objectives.split(","))
    for i, question in enumerate(hits, asked.first):
        found = judge(question, asked.seeds, not asked.no_slsqp, i)
        best = max([*found["values"], found["peer"] or 0.0])
        best = best if best > NOTHING else 0.0
        count["plans"] += asked.seeds
        times.append(found["seconds"])
        count["hits with an answer"] += best > 0
        for number, (one, value) in enumerate(zip(found["plans"], found["values"], strict=True)):
            if value >= (1 - LOST) * best:
                continue
            if one.feasible:
                said = (one.evidence["spread"] or 0.0) > LOST
                kind = "below, and says so" if said else "below, and does not know"
            else:
                said = "certified" not in one.reason
                kind = "refused, and does not know why" if said else "refused by a wrong proof"
            count[kind] += 1
            print(
                f"{i} seed {number} {kind}: {value:.6g} of {best:.6g} (SLSQP {found['peer']}, "
                f"flux {found['flux']}) {one.reason} restarts {one.evidence.get('restarts')} "
                f"{question}",
                flush=True,
            )
    print(f"{asked.hits} hits, {asked.seeds} seeds: {dict(count)}")
    print(f"seconds per plan: median {np.median(times):.3f}, 95 % {np.quantile(times, 0.95):.3f}")


if __name__ == "__main__":
    main(sys.argv[1:])
