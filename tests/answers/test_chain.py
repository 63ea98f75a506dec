"""One file, six commands and six calls: every number that two of them tell is the same."""

import json

import numpy as np
import pytest

import hitjoints as hj
from hitjoints.hit_setting import HitSetting, RobotChoice


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    path = tmp_path_factory.mktemp("chain") / "hit.toml"
    setting = HitSetting(
        RobotChoice("iiwa14"), joints=(6, 7), objective="deliverable", dt=0.002, seed=2
    )
    hj.Hit(
        None, (0.5, 0.15, 0.4), mass=1.0, goal=(0.5, 0.25, 0.4), friction=0.3, restitution=0.4,
        size=(0.1, 0.1, 0.1), spread={"friction": 0.02}, setting=setting,
    ).save(path)  # fmt: skip
    return path


@pytest.fixture(scope="module")
def calls(path):
    hit = hj.load_hit(path)
    plan = hj.plan(hit)
    swing = hj.swing(plan)
    return {
        "hit": hit,
        "plan": plan,
        "swing": swing,
        "rollout": hj.rollout(plan),
        "simulate": hj.simulate(swing),
        "answer": hj.answer(hit),
    }


def test_six_calls_agree(calls):
    hit, plan, swing = calls["hit"], calls["plan"], calls["swing"]
    rollout, simulated, answer = calls["rollout"], calls["simulate"], calls["answer"]
    assert swing.hit.chosen_contact.joint == plan.best.joint
    assert np.abs(swing.q_hit - plan.best.q).max() < 1e-6
    assert swing.inertia == pytest.approx(plan.best.inertia, rel=1e-6)
    assert swing.flux == pytest.approx(hit.flux, rel=5e-3)
    assert swing.flux <= plan.best.deliverable_flux * (1 + 1e-6)
    assert rollout.q_hit == pytest.approx(plan.best.q, abs=1e-6)
    assert rollout.hit.desired_flux == hit.flux
    assert simulated.predicted.flux == pytest.approx(swing.flux, rel=1e-12)
    assert simulated.predicted.inertia == pytest.approx(swing.inertia, rel=1e-12)
    assert simulated.predicted.object_speed == pytest.approx(1.4 * swing.flux, rel=1e-9)
    assert answer.plan.best.as_dict() == plan.best.as_dict()
    assert answer.swing.as_dict() == swing.as_dict()
    assert answer.simulated.simulated == simulated.simulated
    told = hj.landing(swing.robot, swing.q_hit, swing.hit, swing.speed, seed=2)
    assert answer.landing.as_dict() == told.as_dict()
    assert answer.landing.nominal == pytest.approx(hit.goal, abs=2e-3)


def test_six_commands_say_what_the_calls_say(run, path, calls, tmp_path):
    plan = tmp_path / "plan.json"
    planned = run("plan", "--hit", path, "--out", plan, "--json").json
    swung = run("swing", "--plan", plan, "--json").json
    rolled = run("rollout", "--plan", plan, "--json").json
    simulated = run("simulate", "--plan", plan, "--swing", "--json").json
    answered = run("hit", path, "--json").json
    joint, q = planned["best"]["joint"], ",".join(map(repr, planned["best"]["q"]))
    seen = run("inspect", "--hit", path, "--joint", joint, "--q", q, "--json").json

    def same(mine, theirs):
        return json.loads(json.dumps(mine)) == theirs

    assert same(calls["plan"].best.as_dict(), planned["best"])
    assert planned["best"] == answered["plan"]
    files = answered["swing"].pop("files")
    assert files == []
    assert same(calls["answer"].swing.as_dict(), answered["swing"])
    for name in ("q0", "q_hit", "qd_hit", "flux", "inertia", "speed", "duration", "impact_time"):
        assert swung[name] == answered["swing"][name], name
        assert same(calls["swing"].as_dict()[name], swung[name]), name
    for name, value in calls["simulate"].simulated.items():
        assert same(value, simulated["simulated"][name]), name
        assert same(value, answered["simulated"][name]), name
    for name in ("inertia", "speed", "flux"):
        assert rolled["impact"][name] == getattr(calls["rollout"].impact, name), name
    assert seen["inertia"] == pytest.approx(planned["best"]["inertia"], rel=1e-12)
    assert seen["straight_flux"] == pytest.approx(planned["best"]["straight_flux"], rel=1e-9)
    assert same(calls["answer"].landing.as_dict(), answered["landing"])


def test_a_rollout_keeps_the_step_of_its_hit_through_a_plan(run, tmp_path):
    """The step that a file asks for counts by itself, by its plan, and by the commands."""
    setting = hj.HitSetting(hj.RobotChoice("iiwa14"), dt=0.004)
    hit = hj.Hit(6, (0.5, 0.3, 0.5), (0, 1, 0), 2.0, 0.3, setting=setting)
    planned = hj.plan(hit, certificate=False)
    planned.save(tmp_path / "plan.json")
    by_plan = hj.rollout(planned)
    assert by_plan.dt == hj.rollout(hit).dt == 0.004
    told = run("rollout", "--plan", tmp_path / "plan.json", "--json").json
    assert told["steps"] == by_plan.steps
    assert told["impact"]["time"] == pytest.approx(by_plan.impact.time, rel=1e-9)


def test_limits_that_a_hit_tells_are_its_plans_too(run, tmp_path):
    """An arm that tells no acceleration limits, planned for with those of its hit."""
    setting = hj.HitSetting(hj.RobotChoice("ur5"), acceleration=12.0)
    hit = hj.Hit(6, (0.45, 0.25, 0.3), (-0.5, 0.8, 0), 0.9, 0.4, setting=setting)
    hit.save(tmp_path / "hit.toml")
    told = run(
        "hit", tmp_path / "hit.toml", "--out", tmp_path / "out", "--no-simulate", "--json"
    ).json
    saved = tmp_path / "out" / "plan.json"
    plan, robot = hj.load_plan(saved), hj.load_robot("ur5")
    swung = hj.swing(plan)
    assert hj.swing(plan, robot).flux == swung.flux == told["swing"]["flux"]
    assert (swung.limits.acceleration == 12.0).all()
    by_command = run("swing", "--plan", saved, "--json").json
    assert (by_command["flux"], by_command["sendable"]) == (swung.flux, True)
    rolled = hj.rollout(plan)
    assert hj.rollout(plan, robot).impact.flux == rolled.impact.flux
    told = run("rollout", "--plan", saved, "--json").json
    assert told["impact"]["flux"] == pytest.approx(rolled.impact.flux, rel=1e-9)
    assert run("inspect", "--plan", saved, "--json").code == 0
    outcome = run("swing", "--plan", saved, "--robot", "panda")
    assert (outcome.code, "made for ur5" in outcome.err) == (1, True)
