"""Eq. 14 with the joints before the hitting joint fixed, and its certificate."""

import numpy as np
import pytest
from tasks import task

import hitjoints as hj
from hitjoints.model.robot import Contact
from hitjoints.planning.posture import posture
from hitjoints.planning.proof import certificate
from hitjoints.planning.proof.certificate import certify

Q = np.array([1.1, 0.8, -0.9, -1.5, -2.2, 0.3, 0.6])
H = np.array([0.0, 0.6, 0.8])


def grid(robot, joint, count):
    axes = [np.linspace(robot.lower[i], robot.upper[i], count) for i in range(joint - 1, robot.n)]
    cells = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, len(axes))
    q = np.tile(Q, (len(cells), 1))
    q[:, joint - 1 :] = cells
    return q


def gaps(robot, q, joint):
    after = robot.beyond(Contact(joint))
    return np.array([H @ (hj.position(robot, x, after) - hj.position(robot, x, joint)) for x in q])


@pytest.mark.parametrize(("name", "joint", "count"), [("iiwa14", 5, 45), ("panda", 6, 200)])
def test_global_against_a_grid(arm, name, joint, count):
    robot = arm(name)
    start = np.clip(Q, robot.lower, robot.upper)
    found = posture(robot, start, joint, H, away=False)
    q = grid(robot, joint, count)
    q[:, : joint - 1] = start[: joint - 1]
    most = hj.directional_inertia(robot, q, joint, H).max()
    np.testing.assert_array_equal(found.q[: joint - 1], start[: joint - 1])
    assert most <= found.inertia * (1 + 1e-12)
    assert most > 0.99 * found.inertia
    proof = found.evidence["certificate"]
    assert proof["proved"]
    assert found.inertia <= proof["upper_bound"] <= 1.0101 * found.inertia
    assert found.inertia == pytest.approx(hj.directional_inertia(robot, found.q, joint, H))


def test_away_condition_against_a_grid(arm):
    robot = arm("iiwa14")
    found = posture(robot, Q, 6, H)
    q = grid(robot, 6, 60)
    admissible = gaps(robot, q, 6) < 0
    assert 0 < admissible.sum() < len(q)
    inertias = hj.directional_inertia(robot, q, 6, H)
    assert found.away_gap < 0
    assert inertias[admissible].max() <= found.inertia * (1 + 1e-9)
    assert found.evidence["certificate"]["upper_bound"] >= found.inertia


def test_flat_is_a_result(arm):
    # Link 7 of the iiwa is symmetric: its posture does not matter.
    robot = arm("iiwa14")
    found = posture(robot, Q, 7, H, away=False)
    for angle in (-2.0, 0.0, 1.0):
        q = found.q.copy()
        q[6] = angle
        assert hj.directional_inertia(robot, q, 7, H) == pytest.approx(found.inertia)
    assert found.evidence["certificate"]["boxes"] == 1


def test_impossible_away_condition(arm):
    # Joint 6 lies on the axis of joint 5: turning joint 5 on does not move it.
    robot = arm("iiwa14")
    h = hj.position(robot, Q, 6) - hj.position(robot, Q, 5)
    with pytest.raises(hj.InfeasibleError, match="away condition") as refused:
        posture(robot, Q, 5, h)
    assert refused.value.data["nearest"]["away_gap"] == pytest.approx(np.linalg.norm(h))
    assert posture(robot, Q, 5, -h).away


def test_seeds_agree(arm):
    values = [posture(arm("panda"), Q.clip(arm("panda").lower, arm("panda").upper), 6, H,
                      seed=s, certificate=False).inertia for s in range(5)]  # fmt: skip
    assert max(values) / min(values) - 1 < 1e-4


def test_certificate_of_a_poor_posture_says_so(arm, monkeypatch):
    monkeypatch.setattr(certificate, "MOST_BOXES", 300)
    robot = arm("iiwa14")
    asked = task(robot, Contact(5), H, 2.0, None, False)
    best = posture(robot, Q, 5, H, away=False)
    worse = min(
        (q for q in grid(robot, 5, 9)), key=lambda q: hj.directional_inertia(robot, q, 5, H)
    )
    claimed = certify(asked, worse, (5, 6, 7))
    assert not claimed.proved
    assert claimed.upper_bound >= best.inertia
    assert claimed.inertia < 0.99 * best.inertia


def test_bounds_hold_everywhere(arm):
    robot = arm("panda")
    rng = np.random.default_rng(0)
    q0 = rng.uniform(robot.lower, robot.upper)
    asked = task(robot, Contact(6), H, 2.0, None, True)
    at = np.array([4, 5, 6])
    bound = certificate._Bound(asked, q0, at)
    low = rng.uniform(robot.lower[at], robot.upper[at], (40, 3))
    high = low + rng.uniform(0, 0.8, low.shape)
    upper, admissible, _ = bound(low, high)
    q = np.tile(q0, (40, 200, 1))
    q[..., at] = low[:, None] + (high - low)[:, None] * rng.random((40, 200, 3))
    inertias = hj.directional_inertia(robot, q.reshape(-1, 7), 6, H).reshape(40, 200)
    assert (inertias <= upper[:, None]).all()
    assert np.median(upper / inertias.max(axis=1)) < 1.5
    for i in np.flatnonzero(~admissible):
        assert (gaps(robot, q[i], 6) >= 0).all()
