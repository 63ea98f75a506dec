"""From a wish to a verdict, and back: what is promised can be had."""

import json
import re
import sys

import numpy as np
import pytest

import hitjoints as hj
from hitjoints.answers.nearest import nearest_hit
from hitjoints.errors import InfeasibleError, InputError
from hitjoints.hit_loading import load_hit

WISH = """
schema = 1
[robot]
source = "iiwa14"
[contact]
joints = [7]
[object]
position = [0.5, 0.2, 0.4]
mass = 1.0
size = [0.1, 0.1, 0.1]
restitution = 0.4
friction = 0.3
spread = { friction = 0.02, offset = 0.003 }
[wish]
goal = [0.5, GOAL, 0.4]
"""


def wish(folder, goal):
    path = folder / "wish.toml"
    path.write_text(WISH.replace("GOAL", repr(goal)))
    return path


@pytest.fixture(scope="module")
def granted(tmp_path_factory):
    return hj.answer(load_hit(wish(tmp_path_factory.mktemp("granted"), 0.4)))


@pytest.fixture(scope="module")
def refused(tmp_path_factory):
    return hj.answer(load_hit(wish(tmp_path_factory.mktemp("refused"), 4.2)))


def test_a_goal_in_reach_is_granted(granted):
    assert granted.verdict == "sendable"
    assert granted.swing.flux == pytest.approx(granted.hit.desired_flux, rel=5e-3)
    assert granted.landing.nominal == pytest.approx([0.5, 0.4, 0.4], abs=3e-3)
    assert 0.5 < granted.landing.within <= 1
    told = granted.as_dict()
    assert told["plan"]["joint"] == told["joint"] == told["swing"]["joint"] == 7
    assert told["flux"] == told["swing"]["flux"]
    assert told["object_speed"] == pytest.approx(1.4 * told["flux"])
    assert "sendable" in granted.words
    json.dumps(told["landing"])


def test_a_goal_out_of_reach_is_refused_with_what_can_be_had(refused):
    assert refused.verdict == "no"
    assert refused.swing is None
    assert "beyond the maximum" in refused.reason
    assert 0 < refused.nearest.distance < 4.0
    assert "instead" in refused.words


def test_what_can_be_had_instead_is_granted(refused, tmp_path):
    reach = refused.nearest.goal[1]
    again = hj.answer(load_hit(wish(tmp_path, float(0.2 + 0.97 * (reach - 0.2)))))
    assert again.verdict == "sendable"


def test_what_a_motion_cannot_do_is_not_offered_instead(monkeypatch, granted):
    """Limits would allow it, and no stroke was found: what is offered is what a motion delivers."""
    module = sys.modules["hitjoints.answers.single_hit"]
    real, hit = module.swing, granted.hit

    def stubborn(robot, asked, **options):
        if asked.flux is not None:
            raise InfeasibleError("no stroke found")
        return real(robot, hit.with_flux(0.5 * hit.desired_flux), **options)

    monkeypatch.setattr(module, "swing", stubborn)
    found = hj.answer(hit, granted.robot)
    assert found.verdict == "no"
    assert found.nearest.flux == pytest.approx(0.5 * hit.desired_flux, rel=1e-6)
    assert found.nearest.distance == pytest.approx(0.25 * 0.2, rel=1e-5)


def test_the_heaviest_object_is_that_of_eq_4():
    hit = hj.Hit(7, (0.5, 0.2, 0.4), (0, 1, 0), 4.0, flux=0.5)
    found = nearest_hit(hit, 7, inertia=3.0, flux=0.4)
    speed = hj.required_speed(3.0, 4.0, 0.4)
    assert hj.hitting_flux(3.0, found.mass, speed) == pytest.approx(0.5)
    assert found.goal is None
    assert nearest_hit(hit, 7, inertia=3.0, flux=0.1).mass is None


def test_no_arm_is_said():
    with pytest.raises(InputError, match="with which arm"):
        hj.answer(hj.Hit(7, (0.5, 0.2, 0.4), (0, 1, 0), 1.0, 0.2))


def test_the_command_writes_all_of_it_and_runs_again_from_what_it_wrote(run, tmp_path):
    out = tmp_path / "out"
    first = run("hit", wish(tmp_path, 0.4), "--out", out, "--json")
    assert first.code == 0
    told = json.loads(first.out)
    assert sorted(path.name for path in out.iterdir()) == [
        "answer.json", "hit.png", "hit.toml", "plan.json", "trajectory.csv", "trajectory.json",
    ]  # fmt: skip
    assert told["verdict"] == "sendable"
    again = run("hit", out / "hit.toml", "--json")
    assert again.code == 0
    same = json.loads(again.out)
    assert told["swing"].pop("files") == [str(out / f"trajectory.{end}") for end in ("csv", "json")]
    assert same["swing"].pop("files") == same.pop("files") == []
    told.pop("files")
    assert same == told
    assert told["simulated"]["object_speed"] == pytest.approx(told["object_speed"], rel=5e-3)
    lines = [
        line
        for line in (out / "trajectory.csv").read_text().splitlines()
        if not line.startswith("#")
    ]
    rows = np.genfromtxt(lines, delimiter=",", names=True)
    at = int(np.argmin(np.abs(rows["time"] - told["swing"]["impact_time"])))
    q = [rows[f"q{i + 1}"][at] for i in range(7)]
    assert q == pytest.approx(told["swing"]["q_hit"], abs=1e-9)


def test_a_no_ends_with_3(run, tmp_path):
    outcome = run("hit", wish(tmp_path, 9.0), "--json")
    assert outcome.code == 3
    told = json.loads(outcome.out)
    assert told["verdict"] == "no"
    assert told["nearest"]["distance"] > 0


def test_a_new_file_runs_unchanged(run, tmp_path):
    path = tmp_path / "hit.toml"
    made = run("hit", "--new", path, "--json")
    assert made.code == 0
    assert json.loads(made.out)["files"] == [str(path)]
    assert run("hit", path, "--json").code == 0
    again = run("hit", "--new", path)
    assert again.code == 1
    assert "not overwritten" in again.err


def test_outputs_that_cannot_be_written_are_refused_first(run, tmp_path):
    path = wish(tmp_path, 0.4)
    for out, words in ((path, "a folder is needed"), (tmp_path / "a" / "b", "there is no folder")):
        outcome = run("hit", path, "--out", out)
        assert outcome.code == 1
        assert words in outcome.err


def test_a_turned_box_is_compared_by_the_law_of_boxes(run, tmp_path):
    """Eq. 3 alone would be off by the share that goes into its spin."""
    pytest.importorskip("mujoco")
    hit = hj.Hit(
        7, (0.5, 0.2, 0.4), mass=1.0, goal=(0.5, 0.4, 0.4), restitution=0.5, friction=0.3,
        size=(0.12, 0.1, 0.08), yaw=0.15, setting=hj.HitSetting(hj.RobotChoice("iiwa14")),
    )  # fmt: skip
    hit.save(tmp_path / "hit.toml")
    told = run("hit", tmp_path / "hit.toml", "--json").json["simulated"]
    assert told["errors"]["object_speed"] < -0.02
    (off,) = re.findall(r"object speed .* m/s \((\S+) %\)", run("hit", tmp_path / "hit.toml").out)
    assert abs(float(off)) < 0.5
