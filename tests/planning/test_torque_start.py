"""Starts from rest: the way that the motors need, and what torque limits cost."""

from __future__ import annotations

import json
import re

import numpy as np
import pytest

import hitjoints as hj
from hitjoints.hit import Hit
from hitjoints.planning.start import SETTLED, fastest_start, plan_start
from hitjoints.planning.torque_cost import torque_cost
from hitjoints.rollouts.follow import rollout

Y = np.array([0.0, 1.0, 0.0])
HOME = hj.load_robot("iiwa14").home


def weakened(xml, share):
    return re.sub(r'effort="([^"]+)"', lambda m: f'effort="{share * float(m[1])}"', xml)


@pytest.fixture(scope="module")
def weak(arm, tmp_path_factory):
    """Return an iiwa 14 with a fifth of its torques, enough to hold itself."""
    xml = re.sub(r'effort="([^"]+)"', lambda m: f'effort="{0.2 * float(m[1])}"', arm("iiwa14").xml)
    path = tmp_path_factory.mktemp("weak") / "weak.urdf"
    path.write_text(xml)
    return hj.load_robot(path)


def test_the_path_is_one_the_motors_can_run(arm):
    robot = arm("iiwa14")
    start = plan_start(robot, robot.home, 7, Y, 0.7, torque_limits=True)
    assert start.feasible
    np.testing.assert_array_equal(start.path[0], start.q)
    assert (np.diff(start.times) > 0).all()
    rates = np.diff(start.path, axis=0) / np.diff(start.times)[:, None]
    within = rates / np.where(rates > 0, robot.velocity_upper, -robot.velocity_lower)
    assert np.abs(within).max() <= 1 + 1e-9
    target = hj.position(robot, robot.home, 7)
    assert np.linalg.norm(hj.position(robot, start.path[-1], 7) - target) <= SETTLED
    speed = (Y @ hj.jacobian(robot, start.path[-1], 7)) @ rates[-1]
    assert speed == pytest.approx(0.7, rel=0.01)
    # From rest: the first step is slower than the last.
    assert (Y @ hj.jacobian(robot, start.q, 7)) @ rates[0] < 0.6


def test_weak_motors_need_a_longer_run_up_or_say_no(weak):
    plain = plan_start(weak, HOME, 7, Y, 0.7)
    short = plan_start(weak, HOME, 7, Y, 0.7, run_up=0.003)
    assert plain.feasible
    assert short.feasible
    from_rest = plan_start(weak, HOME, 7, Y, 0.7, run_up=0.003, torque_limits=True)
    assert not from_rest.feasible
    assert re.search(r"torque limits let the contact reach 0\.\d+ m/s of 0.7 m/s", from_rest.reason)
    longer = plan_start(weak, HOME, 7, Y, 0.7, torque_limits=True)
    assert longer.feasible
    assert longer.run_up >= plain.run_up
    fastest = fastest_start(weak, HOME, 7, Y, torque_limits=True)
    assert fastest.feasible
    plain = fastest_start(weak, HOME, 7, Y)
    assert fastest.speed <= plain.speed * (1 + 1e-12)  # ProxQP's last digit is not always the same


def test_a_rollout_from_a_planned_start_has_the_flux(weak):
    hit = Hit(6, [0.5, 0.3, 0.5], Y, 2.0, 0.2)
    result = rollout(weak, hit, torque_limits=True)
    assert result.reason == ""
    assert result.impact.flux == pytest.approx(0.2, rel=0.01)
    assert result.torque_ratio_max <= 1


def test_the_cost_is_small_for_strong_motors_only(arm):
    """The panda's fastest hit runs towards a position limit before which it has to brake."""
    strong = torque_cost(arm("iiwa14"), HOME, 7, Y, 2.0)
    assert strong.flux_with == pytest.approx(strong.flux_without, rel=0.02)
    assert strong.flux_without <= strong.straight_flux * 1.01
    panda = arm("panda")
    planned = hj.plan(
        panda, [0.5, 0.3, 0.5], Y, 2.0, [6], "straight-flux", away=False, certificate=False
    )
    costly = torque_cost(panda, planned.best.q, 6, Y, 2.0)
    assert 0.5 * costly.flux_without < costly.flux_with < 0.95 * costly.flux_without


def test_motors_that_cannot_hold_the_arm_have_no_start(arm, tmp_path):
    path = tmp_path / "feeble.urdf"
    path.write_text(weakened(arm("iiwa14").xml, 0.1))
    start = plan_start(hj.load_robot(path), HOME, 7, Y, 0.7, torque_limits=True)
    assert not start.feasible
    assert "gravity asks" in start.reason


def test_the_plan_command_tells_the_cost(run):
    outcome = run("plan", "--torque-limits", "--joint", 6, "--joint", 5, "--no-certificate")
    assert outcome.code == 0
    assert "with torque limits" in outcome.words
    found = run("plan", "--torque-limits", "--joint", 6, "--no-certificate", "--json").json
    (cost,) = found["torque_costs"]
    assert cost["joint"] == 6
    assert 0 < cost["flux_with"] <= 1.01 * cost["straight_flux"]
    assert found["start"]["feasible"]
    assert run("plan", "--joint", 6, "--no-certificate", "--json").json["torque_costs"] == []


def test_the_rollout_command_keeps_the_torques(run, tmp_path):
    plot, out = tmp_path / "hit.png", tmp_path / "hit.nc"
    outcome = run("rollout", "--torque-limits", "--json", "--plot", plot, "--out", out)
    found = outcome.json
    assert outcome.code == 0
    assert found["torque_limits"] is True
    assert found["torque_ratio_max"] <= 1
    assert found["impact"]["flux"] == pytest.approx(0.3, rel=0.01)
    assert plot.stat().st_size > 10_000
    assert out.exists()
    plain = run("rollout", "--json").json
    assert plain["torque_ratio_max"] > 1  # a step cannot really reach the speed
    json.dumps(found, allow_nan=False)
    refused = run("rollout", "--torque-limits", "--law", "paper")
    assert refused.code == 1
    assert "law" in refused.err


def test_an_arm_of_one_joint_is_planned_for(urdf):
    robot = urdf.load(urdf.base, urdf.link("l1"), urdf.joint("j1", "base", "l1"))
    contact = hj.Contact(1, (0.4, 0.0, 0.0))
    found = hj.plan(
        robot, hj.position(robot, [0.2], contact), Y, 1.0, [contact], "straight-flux", away=False
    )
    assert len(found.candidates) == 1
