"""plan.json: found equal, independent of where it lies, and the hit that is carried out."""

import json
import random
import re

import numpy as np
import pytest

import hitjoints as hj
from benchmarks.fuzz_cases import mutated
from hitjoints.errors import InfeasibleError, InputError
from hitjoints.hit_setting import HitSetting, RobotChoice

AT, ALONG = (0.5, 0.3, 0.5), (0.0, 1.0, 0.0)


@pytest.fixture(scope="module")
def planned():
    setting = HitSetting(robot=RobotChoice(), joints=(6, 7), offset=(0, 0.02, 0.05), seed=4)
    return hj.plan(hj.Hit(None, AT, ALONG, 2.0, 0.3, setting=setting), certificate=False)


@pytest.fixture
def saved(planned, tmp_path):
    planned.save(tmp_path / "plan.json")
    return tmp_path / "plan.json"


def test_a_plan_survives_its_file(planned, saved):
    again = hj.load_plan(saved)
    assert again == planned
    assert again.hit == planned.hit
    np.testing.assert_array_equal(again.best.q, planned.best.q)
    np.testing.assert_array_equal(again.start.path, planned.start.path)
    assert again.chosen_hit.contact == hj.Contact(planned.best.joint, (0, 0.02, 0.05))


def same_numbers(one, other):
    """Tell whether two plans agree; solvers that were used before differ in the last digits."""
    assert (one.joint, one.feasible, one.offset) == (other.joint, other.feasible, other.offset)
    np.testing.assert_array_equal(one.q, other.q)
    for name in ("inertia", "speed", "straight_speed", "flux", "deliverable_flux"):
        assert getattr(one, name) == pytest.approx(getattr(other, name), rel=1e-12)


def test_it_is_run_again_from_its_own_hit(planned, saved, arm):
    again = hj.plan(hj.load_plan(saved).hit, certificate=False)
    contacts = [hj.Contact(joint, (0, 0.02, 0.05)) for joint in (6, 7)]
    old = hj.plan(arm("iiwa14"), AT, ALONG, 2.0, contacts, flux=0.3, seed=4, certificate=False,
                  start=True, surroundings=hj.Surroundings(), deliverable=True)  # fmt: skip
    for other in (again, old):
        for one, two in zip(planned.candidates, other.candidates, strict=True):
            same_numbers(one, two)
    assert again.hit == planned.hit
    assert old.hit.setting.joints == (6, 7)


def test_it_lies_where_it_likes(run, tmp_path, monkeypatch, urdf):
    xml = hj.load_robot("iiwa14").xml
    folder = tmp_path / "work"
    folder.mkdir()
    (tmp_path / "arm.urdf").write_text(xml)
    monkeypatch.chdir(folder)
    words = ["--joint", 6, "--no-certificate", "--offset", "0,0.01,0.02"]
    assert run("plan", "--robot", "../arm.urdf", *words, "--out", "plan.json").code == 0
    monkeypatch.chdir("/")
    outcome = run("rollout", "--plan", folder / "plan.json", "--json")
    assert outcome.code == 0, outcome.err
    assert outcome.json["impact"]["position"] == pytest.approx(AT, abs=2e-3)
    (tmp_path / "arm.urdf").write_text(re.sub(r'mass value="[^"]*"', 'mass value="1.5"', xml))
    outcome = run("rollout", "--plan", folder / "plan.json")
    assert outcome.code == 1
    assert "not what was it was made for" in outcome.err


@pytest.mark.parametrize("command", ["rollout", "simulate", "swing"])
def test_the_plans_hit_is_what_is_made(run, saved, planned, command):
    found = run(command, "--plan", saved, "--json").json
    assert found.get("joint", planned.best.joint) == planned.best.joint
    if command == "swing":
        assert found["hit"]["wish"]["flux"] == 0.3
        assert found["hit"]["contact"]["offset"] == [0, 0.02, 0.05]
    else:
        assert found["flux"] == 0.3
    if command == "rollout":
        assert found["impact"]["flux"] == pytest.approx(0.3, rel=0.02)


def test_view_shows_what_was_planned(run, saved, planned, tmp_path):
    outcome = run("view", "--plan", saved, "--out", tmp_path / "page.html", "--json")
    assert outcome.json["joint"] == planned.best.joint
    assert outcome.json["q"] == planned.best.q.tolist()


@pytest.mark.parametrize(
    ("typed", "words"),
    [
        (["--robot", "panda"], "the plan is made for iiwa14"),
        (["--joint", "5"], "joint = 5: the plan is for"),
        (["--offset", "0,0,0"], "the plan is for"),
        (["--object", "0.5,0.3,0.6"], "object = "),
        (["--mass", "3"], "mass = 3.0: the plan is for 2"),
        (["--direction", "1,0,0"], "direction = "),
    ],
)
def test_what_contradicts_it_is_refused(run, saved, typed, words):
    outcome = run("rollout", "--plan", saved, *typed)
    assert (outcome.code, outcome.err.count("\n")) == (1, 1)
    assert words in outcome.err


def test_a_plan_that_says_no(run, tmp_path):
    no = hj.plan(hj.load_robot("iiwa14"), (2, 0, 0), ALONG, 2.0, [7], certificate=False)
    no.save(tmp_path / "no.json")
    assert hj.load_plan(tmp_path / "no.json") == no
    with pytest.raises(InfeasibleError, match="the plan says no"):
        assert no.chosen_hit
    assert run("rollout", "--plan", tmp_path / "no.json").code == 3


@pytest.mark.parametrize(
    ("key", "value", "words"),
    [
        ("mass", "heavy", ["object.mass = 'heavy'"]),
        ("q", [10**400] * 7, ["best.q"]),
        ("q", ["a"] * 7, ["best.q.0 = 'a'"]),
        ("hit", 5, ["hit = 5"]),
        ("candidates", [], ["candidates = []"]),
        ("digest", None, ["digest = None"]),
    ],
)
def test_what_is_wrong_is_told(run, saved, key, value, words):
    plan = json.loads(saved.read_text())
    if key == "mass":
        plan["hit"]["object"]["mass"] = value
    elif key == "q":
        plan["best"]["q"] = value
    else:
        plan[key] = value
    saved.write_text(json.dumps(plan))
    outcome = run("rollout", "--plan", saved)
    assert (outcome.code, outcome.err.count("\n")) == (1, 1)
    for word in words:
        assert word in outcome.err


def test_mutated_plans_are_never_a_traceback(planned, saved):
    text, refused = saved.read_text(), 0
    for number in range(150):
        saved.write_text(mutated(random.Random(number), text), errors="surrogatepass")
        try:
            hj.load_plan(saved)
        except (InputError, InfeasibleError) as error:
            refused += 1
            message = str(error)
            assert "\n" not in message
    assert 30 < refused < 150


def test_objects_chain(run, planned, saved):
    """The same numbers from six calls and from as many commands."""
    plan = hj.load_plan(saved)
    rolled, simulated, swung = hj.rollout(plan), hj.simulate(plan), hj.swing(plan)
    told = run("rollout", "--plan", saved, "--json").json
    assert told["impact"]["flux"] == pytest.approx(rolled.impact.flux, rel=1e-9)
    assert told["impact"]["q"] == pytest.approx(list(rolled.impact.q), abs=1e-9)
    told = run("simulate", "--plan", saved, "--json").json
    assert told["predicted"]["object_speed"] == pytest.approx(
        simulated.predicted.object_speed, rel=1e-9
    )
    told = run("swing", "--plan", saved, "--json").json
    assert told["q_hit"] == pytest.approx(list(swung.q_hit), abs=1e-9)
    assert rolled.hit.contact == swung.hit.contact == planned.chosen_hit.contact
    assert rolled.impact.flux == pytest.approx(0.3, rel=0.01)
