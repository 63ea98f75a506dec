"""What a plan promises: limits, position, away condition, the same optimum from any seed."""

import numpy as np
import pytest

import hitjoints as hj
from hitjoints.planning.objectives.registry import OBJECTIVES as KNOWN
from hitjoints.planning.planner import plan

POSITION, DIRECTION, MASS = [0.5, 0.3, 0.5], [0, 1, 0], 2.0


def quick(robot, position=POSITION, direction=DIRECTION, mass=MASS, **options):
    return plan(robot, position, direction, mass, certificate=False, **options)


def test_the_papers_question(arm):
    found = plan(arm("iiwa14"), POSITION, DIRECTION, MASS)
    five, six, seven = found.candidates
    assert not five.feasible
    assert "away condition" in five.reason
    assert five.evidence["nearest"]["away_gap"] > 0.05
    assert found.best is six
    assert six.inertia > seven.inertia
    assert "less inertia than joint 6" in seven.reason
    assert found.summary.startswith(f"joint 6: {six.inertia:.1f} kg, {six.speed:.2f} m/s; joint 7")
    assert "joint 5: infeasible here because" in found.summary
    for one in (six, seven):
        proof = one.evidence["certificate"]
        assert proof["proved"]
        assert one.inertia <= proof["upper_bound"] * (1 + 1e-12) <= 1.0101 * one.inertia
        assert proof["boxes"] >= 1
        assert one.evidence["spread"] < 2e-3
        assert one.evidence["samples"] >= one.evidence["admissible"] > 0


def test_joint_5_without_the_away_condition(arm):
    best = quick(arm("iiwa14"), joints=[5], away=False).best
    assert best is not None
    assert best.away is False
    assert best.inertia > quick(arm("iiwa14"), joints=[6], away=False).best.inertia


def test_quantities_are_those_of_the_configuration(arm):
    robot = arm("iiwa7")
    best = quick(robot, direction=[1, 2, 0], objective="flux", joints=[7]).best
    h = np.array([1, 2, 0]) / np.sqrt(5)
    assert best.inertia == pytest.approx(hj.directional_inertia(robot, best.q, 7, h))
    assert best.speed == pytest.approx(hj.hitting_speed(robot, best.q, 7, h))
    straight = hj.hitting_speed(robot, best.q, 7, h, straight=True)
    assert best.straight_speed == pytest.approx(straight)
    assert best.flux == pytest.approx(hj.hitting_flux(best.inertia, MASS, best.speed))
    gap = h @ (hj.position(robot, best.q, robot.flange) - hj.position(robot, best.q, 7))
    assert best.away_gap == pytest.approx(gap)
    assert gap < 0


@pytest.mark.parametrize("objective", ["inertia", "flux", "straight-flux", "rebound"])
@pytest.mark.parametrize(("name", "joint"), [("iiwa14", 6), ("panda", 7)])
def test_the_same_optimum_from_any_seed(arm, name, joint, objective):
    flux = 0.8 if objective == "rebound" else None
    values = [
        getattr(
            quick(arm(name), joints=[joint], objective=objective, flux=flux, seed=seed).best,
            KNOWN[objective].ranked_by,
        )
        for seed in range(4)
    ]
    assert max(values) / min(values) - 1 < 1e-4


def test_repeatable(arm):
    first, second = (quick(arm("panda"), joints=[6], seed=3) for _ in range(2))
    np.testing.assert_array_equal(first.best.q, second.best.q)
    assert first.summary == second.summary


def test_promises_over_many_plans(arm):
    rng = np.random.default_rng(8)
    feasible = 0
    for i in range(45):
        robot = arm(("iiwa14", "iiwa7", "panda")[i % 3])
        joint = int(rng.choice(robot.hitting_joints))
        target = hj.position(robot, rng.uniform(robot.lower, robot.upper), joint)
        h = rng.standard_normal(3)
        objective = ("inertia", "flux", "straight-flux")[i // 3 % 3]
        best = quick(robot, target, h, rng.uniform(0.3, 5), joints=[joint], objective=objective)
        if best.best is None:
            assert "away condition" in best.candidates[0].reason
            continue
        feasible += 1
        q = best.best.q
        assert (robot.lower <= q).all()
        assert (q <= robot.upper).all()
        assert np.linalg.norm(hj.position(robot, q, joint) - target) < 1e-6
        after = robot.beyond(hj.Contact(joint))
        assert h @ (hj.position(robot, q, after) - hj.position(robot, q, joint)) < 0
    assert feasible > 25


def test_objectives_trade_inertia_for_flux(arm):
    robot = arm("iiwa14")
    found = {name: quick(robot, joints=[6], objective=name).best for name in list(KNOWN)[:3]}
    for name, one in found.items():
        quantity = KNOWN[name].ranked_by
        others = [getattr(other, quantity) for other in found.values()]
        assert getattr(one, quantity) >= max(others) * (1 - 1e-9)
    needed = 0.5 * (found["inertia"].flux + found["flux"].flux)
    gentle = quick(robot, joints=[6], objective="rebound", flux=needed).best
    assert gentle.flux >= needed
    assert found["flux"].inertia < gentle.inertia < found["inertia"].inertia
    # Less rebound than the hardest hitter, for the same flux (Eq. 11).
    lost = [
        hj.rebound(one.inertia, MASS, hj.required_speed(one.inertia, MASS, needed), 0.5)
        for one in (gentle, found["flux"])
    ]
    assert abs(lost[0]) < abs(lost[1])


def test_the_most_accepted(arm):
    robot = arm("iiwa14")
    free = quick(robot, joints=[6]).best
    asked = []

    def elbow_up(q):
        asked.append(q)
        return bool(q[3] > 0)

    limited = quick(robot, joints=[6], accept=elbow_up).best
    assert limited.q[3] > 0
    assert limited.inertia <= free.inertia
    assert len(asked) >= 1
    refused = quick(robot, joints=[6], accept=lambda q: False)
    assert refused.best is None
    assert "accepted" in refused.candidates[0].reason


def test_continuous_and_prismatic_joints(urdf):
    parts = [urdf.base]
    turning = '<limit effort="3" velocity="2"/>'
    chain = [("0 0 1", "continuous"), ("0 1 0", "revolute"), ("0 0 1", "prismatic"),
             ("1 0 0", "continuous"), ("0 1 0", "revolute")]  # fmt: skip
    for i, (axis, kind) in enumerate(chain):
        more = turning if kind == "continuous" else urdf.limit
        before = f"l{i - 1}" if i else "base"
        parts += [
            urdf.link(f"l{i}"),
            urdf.joint(f"j{i}", before, f"l{i}", kind, at="0.2 0 0.2", axis=axis, more=more),
        ]
    robot = urdf.load(*parts)
    target = hj.position(robot, [2.5, 0.3, 0.4, -2.0, 0.5], 5)
    best = quick(robot, target, [0, 1, 1], joints=[5], away=False).best
    assert best is not None
    assert np.linalg.norm(hj.position(robot, best.q, 5) - target) < 1e-6


@pytest.mark.parametrize(
    ("options", "word"),
    [
        ({"objective": "speed"}, "straight-flux"),
        ({"objective": "rebound"}, "flux"),
        ({"objective": "rebound", "flux": -1.0}, "at least 1e-06"),
        ({"mass": 0.0}, "weighs more"),
        ({"joints": []}, "at least one"),
        ({"joints": [6, 6]}, "once"),
        ({"joints": [9]}, "1 to 7"),
        ({"direction": [0, 0, 0]}, "zero"),
        ({"position": [0.5, 0.3]}, "three numbers"),
        ({"position": [0.5, 0.3, np.nan]}, "finite"),
        ({"seed": -1}, "at least 0"),
    ],
)
def test_bad_input(arm, options, word):
    with pytest.raises(hj.InputError, match=word):
        quick(arm("iiwa14"), **options)
