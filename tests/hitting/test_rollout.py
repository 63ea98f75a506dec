from __future__ import annotations

import math

import numpy as np
import pytest

import hitjoints as hj
from hitjoints.errors import InfeasibleError, InputError
from hitjoints.hit import Hit
from hitjoints.hitting.approach import Impact, crossing, why_no_hit
from hitjoints.hitting.controller import Controller
from hitjoints.rollouts.follow import rollout
from hitjoints.rollouts.prepare import prepare
from tests.oracles.random_rollouts import (
    broken_limits,
    failure,
    feasible_hits,
    random_rollouts,
    tracking,
)

OBJECT, ALONG = np.array([0.5, 0.3, 0.5]), np.array([0.0, 1.0, 0.0])
Q0 = np.array([-0.34, 1.41, -1.38, 1.6, 0.48, 1.97, 1.32])


@pytest.fixture
def robot(arm):
    return arm("iiwa14")


@pytest.fixture
def hit():
    return Hit(6, OBJECT, ALONG, 2.0, 0.3)


@pytest.fixture(scope="module")
def planned(arm):
    return rollout(arm("iiwa14"), Hit(6, OBJECT, ALONG, 2.0, 0.3))


def planar(urdf):
    """Return a three-link arm in a plane: its Jacobian has a row of zeros."""
    bodies = [urdf.link(f"l{i}") for i in range(1, 4)]
    joints = [
        urdf.joint(f"j{i}", parent, f"l{i}", more='<limit lower="-2.5" upper="2.5" velocity="2"/>')
        for i, parent in enumerate(("base", "l1", "l2"), start=1)
    ]
    return urdf.load(urdf.base, *bodies, *joints)


def test_no_limit_is_ever_broken():
    ends = []
    for result in random_rollouts(24, seed=5):
        assert broken_limits(result) == 0
        assert result.velocity_ratio_max <= 1
        assert result.position_violation_max == 0
        ends.append(result.reason)
    assert "" in ends
    assert any("stopped by position limits (joint" in reason for reason in ends)


def test_feasible_hits_succeed_and_the_optimised_reference_tracks_better(robot):
    for hit, found in feasible_hits(robot, 3, seed=2):
        optimised, constant = (
            rollout(robot, hit, q0=found.q0, q_hit=found.q_hit, reference=name)
            for name in ("optimised", "constant")
        )
        assert failure(optimised) == ""
        assert tracking(optimised) < tracking(constant)


def test_the_bare_rollout_hits(planned, hit):
    impact = planned.impact
    assert planned.reason == ""
    assert impact.miss <= 2e-3
    assert impact.direction_error <= 2
    assert impact.flux == pytest.approx(hit.flux, rel=0.01)


def test_the_impact_state_is_exact(planned, robot, hit):
    impact = planned.impact
    assert ALONG @ (impact.position - OBJECT) == pytest.approx(0, abs=1e-13)
    np.testing.assert_allclose(impact.position, hj.position(robot, impact.q, 6), atol=1e-14)
    last = planned.steps - 1
    late = impact.time - last * planned.dt
    assert 0 <= late <= planned.dt
    qd = planned.rows["qd"][last]
    np.testing.assert_allclose(impact.q, planned.rows["q"][last] + late * qd, atol=1e-12)
    velocity = hj.jacobian(robot, impact.q, 6) @ qd
    assert impact.speed == pytest.approx(velocity @ ALONG)
    angle = math.degrees(math.acos(min(1.0, velocity @ ALONG / np.linalg.norm(velocity))))
    assert impact.direction_error == pytest.approx(angle, abs=1e-4)
    assert impact.inertia == pytest.approx(hj.directional_inertia(robot, impact.q, 6, ALONG))
    assert impact.flux == pytest.approx(hj.hitting_flux(impact.inertia, 2.0, impact.speed))


def test_rows_follow_from_each_other(planned, robot):
    q, qd = planned.rows["q"], planned.rows["qd"]
    np.testing.assert_allclose(q[1:], q[:-1] + planned.dt * qd[:-1], atol=1e-12)
    assert np.linalg.norm(qd[-1]) == 0  # at rest after the follow-through
    speed = np.linalg.norm(qd[planned.steps - 1 :], axis=1)
    assert (np.diff(speed) <= 0).all()


def test_the_data_set(planned):
    data = planned.dataset
    assert {variable.attrs["units"] for variable in data.variables.values()} >= {"rad", "kg", "m"}
    assert data.sizes == {"time": len(planned.rows["q"]), "axis": 7, "coordinate": 3}
    assert data.attrs["desired_flux"] == 0.3
    assert not any("step_time" in str(name) for name in (*data.variables, *data.attrs))
    assert float(data.position_margin.min()) >= 0
    assert float(data.velocity_margin.min()) >= 0
    assert int(data.approach.sum()) == planned.steps


def test_same_input_same_bits(planned, robot, hit):
    again = rollout(robot, hit)
    for name, values in planned.rows.items():
        assert values.tobytes() == again.rows[name].tobytes(), name
    assert planned.dataset.attrs == again.dataset.attrs


@pytest.mark.parametrize("profile", ["paper", "constant"])
def test_a_start_beside_the_line_joins_it(robot, hit, profile):
    start = OBJECT - [0.03, 0.15, 0.02]
    result = rollout(robot, hit, start=start, speed_profile=profile)
    np.testing.assert_allclose(result.rows["position"][0], start, atol=1e-8)
    assert result.impact.miss < 2e-3
    slow = result.impact.flux < 0.95 * hit.flux
    assert slow == (profile == "paper")  # Eq. 5 is slow beside the line
    assert result.reason.startswith("too weak: a flux of 0.2" if slow else "")
    assert bool(result.reason) == slow


@pytest.mark.parametrize(
    ("miss", "angle", "flux", "words"),
    [
        (0.0, 0.0, 0.3, ""),
        (0.019, 4.9, 0.286, ""),
        (0.021, 0.0, 0.3, "off the line"),
        (0.0, 5.1, 0.3, "askew: the contact moves 5.1 degrees"),
        (0.0, 0.0, 0.21, "too weak: a flux of 0.21 m/s, 70 %"),
        (0.0, 0.0, 0.33, "too strong: a flux of 0.33 m/s, 110 %"),
    ],
)
def test_a_hit_has_position_direction_and_flux(hit, miss, angle, flux, words):
    impact = Impact(0.1, OBJECT, miss, angle, 3.0, 3.0, 0.5, flux, np.zeros(7), True)
    assert why_no_hit(hit, impact).startswith(words)
    assert bool(why_no_hit(hit, impact)) == bool(words)
    weak = "too weak" in words
    assert ("as the limits let it" in why_no_hit(hit, impact)) == weak


@pytest.mark.parametrize("reference", ["constant", "optimised"])
def test_the_paper_law_keeps_the_limits_too(robot, hit, reference):
    result = rollout(robot, hit, law="paper", reference=reference, weighting="gradient")
    assert result.reason == ""
    assert broken_limits(result) == 0


def test_a_contact_on_the_surface_hits(robot):
    contact = hj.Contact(6, (0.05, 0.0, 0.0))
    result = rollout(robot, Hit(contact, OBJECT, ALONG, 2.0, 0.2))
    assert result.reason == ""
    np.testing.assert_allclose(
        hj.position(robot, result.impact.q, contact), result.impact.position, atol=1e-12
    )


@pytest.mark.parametrize("law", ["qp", "paper"])
def test_an_arm_in_a_plane_hits(urdf, law):
    robot = planar(urdf)
    q0 = np.array([0.3, 0.9, 0.8])
    target = hj.position(robot, q0, 3) + np.array([-0.08, 0.02, 0.0])
    hit = Hit(3, target, [-1.0, 0.25, 0.0], 1.0, 0.1)
    result = rollout(robot, hit, q0=q0, law=law)
    assert result.reason == ""
    assert result.impact.miss < 2e-3
    assert broken_limits(result) == 0


def test_a_flux_out_of_reach_is_flagged_on_the_way(robot):
    result = rollout(robot, Hit(6, OBJECT, ALONG, 2.0, 2.0), q0=Q0)
    assert result.saturated_steps == result.steps
    assert result.impact is None or result.impact.saturated
    assert broken_limits(result) == 0


def test_the_maximum_is_told_when_the_flux_is_beyond_it(robot):
    with pytest.raises(InfeasibleError, match="beyond the maximum") as caught:
        rollout(robot, Hit(6, OBJECT, ALONG, 2.0, 3.0))
    most = caught.value.data["maximum_flux"]
    assert 0.4 < most < 3.0
    with pytest.raises(InfeasibleError, match="beyond the maximum"):
        prepare(robot, Hit(6, OBJECT, ALONG, 2.0, 1.01 * most))


def test_too_short_a_way_from_beside_is_off_the_line(robot, hit):
    result = rollout(robot, hit, start=OBJECT - [0.08, 0.0002, 0.0])
    assert result.impact.miss > 0.02
    assert result.reason.startswith("off the line")


def test_a_touch_beyond_a_limit_counts_as_at_it(robot, hit):
    q = np.array(Q0)
    q[3] = robot.upper[3]
    control = Controller(robot, hit, q)
    expected = control.step(q)
    q[3] += 5e-7
    np.testing.assert_array_equal(control.step(q), expected)
    assert expected[3] <= 0
    q[3] += 1e-3
    with pytest.raises(InputError, match="joint 4"):
        control.step(q)


@pytest.mark.parametrize(
    ("options", "name"),
    [
        ({"q0": 9 * Q0}, "q0"),
        ({"q0": Q0, "start": OBJECT}, "start"),
        ({"start": OBJECT + 0.1 * ALONG}, "start"),
        ({"q_hit": Q0}, "q_hit"),
        ({"dt": 0.04}, "dt"),
        ({"run_up": -1.0}, "run_up"),
    ],
)
def test_bad_arguments_are_named(robot, hit, options, name):
    with pytest.raises(InputError) as caught:
        rollout(robot, hit, **options)
    assert caught.value.argument == name


@pytest.mark.parametrize("target", [[-1.0, 0.0, 0.2], [2.0, 0.0, 0.5]])
def test_objects_out_of_reach(robot, target):
    with pytest.raises(InfeasibleError, match="reach"):
        rollout(robot, Hit(6, target, ALONG, 2.0, 0.3))


def test_crossing_finds_the_zero():
    assert crossing(math.cos, 2.0) == pytest.approx(math.pi / 2, abs=1e-14)
    assert crossing(lambda t: (0.1 - t) ** 3, 1.0) == pytest.approx(0.1, abs=1e-4)
    assert crossing(lambda t: 1.0 - t, 1.0) == 1.0
