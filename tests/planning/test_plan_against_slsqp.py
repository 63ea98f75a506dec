"""Plans against an independent brute force: never more than 0.2 % below it."""

import numpy as np
import pytest

import hitjoints as hj
from hitjoints.planning.objectives.registry import OBJECTIVES as KNOWN
from hitjoints.planning.planner import plan
from tests.oracles.scipy_plans import SciPyPlanner

ROBOTS = ("iiwa14", "iiwa7", "panda")
OBJECTIVES = ("inertia", "flux", "straight-flux", "rebound")


def hits(arm):
    rng = np.random.default_rng(11)
    for i in range(36):
        robot, objective = arm(ROBOTS[i % 3]), OBJECTIVES[i // 3 % 4]
        joint = int(rng.choice(robot.hitting_joints))
        while True:
            target = hj.position(robot, rng.uniform(robot.lower, robot.upper), joint)
            if target[2] > 0.1:
                break
        away = bool(rng.random() < 0.7)
        yield robot, joint, objective, target, rng.standard_normal(3), rng.uniform(0.3, 5), away


def test_never_below_the_brute_force(arm):
    shares = []
    for i, (robot, joint, objective, target, h, mass, away) in enumerate(hits(arm)):
        options = {"joints": [joint], "away": away, "certificate": False, "seed": i}
        flux = None
        if objective == "rebound":
            hardest = plan(robot, target, h, mass, objective="flux", **options).best
            flux = 0.9 * (hardest.flux if hardest else 0.1)
        best = plan(robot, target, h, mass, objective=objective, flux=flux, **options).best
        peer = SciPyPlanner(robot, joint, target, h, mass, away)
        reached = peer.by_slsqp(objective, np.random.default_rng(i), least_flux=flux)
        if reached is None:
            continue
        assert best is not None, (robot.name, joint, objective)
        value = getattr(best, KNOWN[objective].ranked_by)
        assert value > reached * 0.998, (robot.name, joint, objective, value, reached)
        # The same quantity by the other path.
        recomputed = peer.values[objective](best.q)
        assert value == pytest.approx(recomputed, rel=1e-7)
        shares.append(reached / value)
    assert len(shares) >= 30
    # The brute force is a worthy opponent: it gets close to most plans.
    assert np.median(shares) > 0.98
