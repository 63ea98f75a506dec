"""`hitjoints view`: what it shows of files, and what it serves and writes."""

import json
import shlex
import signal
import subprocess
import sys
import threading
import urllib.request
from contextlib import contextmanager

import numpy as np
import pytest

import hitjoints as hj
from hitjoints.evidence.recordings.hit_files import EXAMPLES

PORT = 18_130
LIMIT = 60  # s, for a process that serves


def test_command_writes_a_page(run, tmp_path):
    page = tmp_path / "arm.html"
    outcome = run("view", "--robot", "panda", "--joint", 7, "--out", page, "--json")
    assert outcome.code == 0
    assert outcome.json["joint"] == 7
    assert outcome.json["url"].startswith("http://127.0.0.1:")
    assert outcome.json["motion"] is None
    assert "<html" in page.read_text().lower()
    assert outcome.err == f"written: {page}\n"


@pytest.fixture(scope="module")
def files(run_once):
    """A hit, and what is planned and made for it, each in its file."""
    return run_once


@pytest.fixture(scope="module")
def run_once(tmp_path_factory):
    folder = tmp_path_factory.mktemp("shown")
    robot = hj.load_robot("iiwa14")
    hit = hj.Hit(6, [0.5, 0.3, 0.5], [0, 1, 0], 2.0, 0.3)
    hit.save(folder / "hit.toml")
    planned = hj.plan(robot, hit.position, hit.direction, 2.0, [6], flux=0.3, certificate=False)
    planned.save(folder / "plan.json")
    swing = hj.swing(planned, robot)
    for ending in ("csv", "npz", "json"):
        swing.save(folder / f"swing.{ending}")
    from hitjoints.datasets.files import write_dataset

    rollout = hj.rollout(planned, robot)
    for ending in ("zarr", "nc"):
        write_dataset(rollout.dataset, folder / f"rollout.{ending}")
    return folder, planned, swing, rollout


@pytest.mark.parametrize("given", [["hit.toml"], ["--hit", "hit.toml"]])
def test_a_hit_is_planned_and_made(files, run, tmp_path, given):
    folder, *_ = files
    words = [folder / word if word.endswith("toml") else word for word in given]
    outcome = run("view", *words, "--out", tmp_path / "page.html", "--json")
    assert outcome.code == 0
    assert [one["joint"] for one in outcome.json["candidates"]] == [5, 6, 7]
    assert outcome.json["joint"] == 6
    assert outcome.json["motion"]["kind"] == "swing"


@pytest.mark.parametrize("given", [[], ["--plan"]])
def test_a_plan_is_shown_as_it_is(files, run, tmp_path, given):
    folder, planned, *_ = files
    outcome = run("view", *given, folder / "plan.json", "--out", tmp_path / "page.html", "--json")
    assert outcome.code == 0
    assert outcome.json["q"] == planned.best.q.tolist()
    assert len(outcome.json["candidates"]) == 1
    assert outcome.json["candidates"][0]["inertia"] == planned.best.inertia


@pytest.mark.parametrize("name", ["swing.csv", "swing.npz", "swing.json"])
def test_a_trajectory_is_played(files, run, tmp_path, name):
    folder, _, swing, _ = files
    outcome = run("view", folder / name, "--out", tmp_path / "page.html", "--json")
    motion = outcome.json["motion"]
    assert outcome.json["robot"] == "iiwa14"
    assert motion["kind"] == "swing"
    assert motion["impact_time"] == pytest.approx(swing.impact_time)
    assert motion["speed"] == pytest.approx(swing.speed, rel=1e-9)
    assert motion["duration"] >= swing.duration - 1e-9


@pytest.mark.parametrize("name", ["rollout.zarr", "rollout.nc"])
def test_a_rollout_is_played(files, run, tmp_path, name):
    folder, *_, rollout = files
    outcome = run("view", folder / name, "--out", tmp_path / "page.html", "--json")
    motion = outcome.json["motion"]
    assert motion["kind"] == "rollout"
    assert motion["impact_time"] == pytest.approx(rollout.impact.time)
    np.testing.assert_allclose(outcome.json["q"], rollout.rows["q"][0])


@pytest.mark.parametrize("name", ["IIWA_14_hit_10", "IIWA_7_hit_44"])
def test_a_recorded_hit_is_played(run, tmp_path, name):
    path = EXAMPLES / f"{name}.csv"
    outcome = run("view", path, "--out", tmp_path / "page.html", "--json")
    (told,) = hj.replay(path).hits
    assert outcome.json["robot"] == told.robot
    assert outcome.json["motion"]["kind"] == "recorded hit"
    assert outcome.json["motion"]["speed"] == pytest.approx(told.robot_speed)
    assert outcome.json["motion"]["impact_time"] == pytest.approx(told.contact_time)


def test_a_recorded_object_moves_as_it_was_seen():
    from hitjoints.evidence.recordings.layout import read_object
    from hitjoints.show.viewer.recorded_clip import recorded_clip

    (told,) = hj.replay(EXAMPLES / "IIWA_7_hit_44.csv").hits
    clip = recorded_clip(EXAMPLES / "IIWA_7_hit_44.csv", hj.load_robot("iiwa7"))
    track = read_object(EXAMPLES / "object_1_hit_44.csv")
    way = track.position[-1, :2] - track.position[0, :2]
    np.testing.assert_allclose(clip.moved(clip.duration)[0][:2], way, atol=2e-3)
    later = clip.impact_time + told.object_time
    step = 0.015  # three of its rows, which jitter
    speed = (clip.moved(later + step)[0] - clip.moved(later - step)[0]) @ clip.hit.direction
    assert speed / (2 * step) == pytest.approx(told.object_speed, rel=0.1)


@pytest.mark.parametrize(
    ("name", "typed", "words"),
    [
        ("swing.csv", ["--mass", "3"], "mass = 3.0: the swing is of 2"),
        ("swing.csv", ["--object", "0.5,0.3,0.6"], "object = 0.5,0.3,0.6: the swing is of"),
        ("swing.npz", ["--robot", "ur5"], "it moves 7 joints, and ur5 has 6"),
        ("rollout.nc", ["--joint", "5"], "joint = [5]: the rollout is of 6"),
        ("plan.json", ["--mass", "3"], "mass = 3.0: the plan is for 2"),
        ("none.csv", [], "none.csv: there is no such file"),
        ("picture.png", [], "one of these is needed: a hit.toml"),
        ("other.json", [], "it is no trajectory"),
        ("other.nc", [], "it is no rollout"),
        ("cut.csv", [], "it is no trajectory"),
    ],
)
def test_what_does_not_fit_is_told_in_a_line(files, run, tmp_path, name, typed, words):
    folder = files[0]
    (folder / "picture.png").write_bytes(b"x")
    (folder / "other.json").write_text("{}")
    (folder / "other.nc").write_text("no")
    (folder / "cut.csv").write_text("time,q1,q2\n0,1\n")
    outcome = run("view", folder / name, *typed, "--out", tmp_path / "page.html")
    assert outcome.code == 1, outcome.err
    assert words in outcome.err
    assert len(outcome.err.splitlines()) == 1
    assert not (tmp_path / "page.html").exists()


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize("ignored", [False, True])
def test_command_serves_until_a_signal(number, ignored):
    """Also when it starts with SIGINT ignored, as what a script runs in the background does."""
    words = [sys.executable, "-m", "hitjoints.cli", "view", "--port", str(PORT + 50), "--json"]
    ignore = "trap '' INT;" if ignored else ""
    words = ["sh", "-c", f"{ignore} exec {shlex.join(words)}"]
    with served(words) as it:
        found = json.loads(it.stdout.readline())
        page = urllib.request.urlopen(found["url"], timeout=10).read()
        it.send_signal(number)
        rest, said = it.communicate(timeout=20)
    assert b"<html" in page.lower()
    assert (it.returncode, rest) == (0, "")
    assert said == f"serving: {found['url']} until Ctrl-C\n"


@contextmanager
def served(words):
    """Run a server, and end it whatever becomes of the test."""
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    with subprocess.Popen(words, text=True, **pipes) as it:
        late = threading.Timer(LIMIT, it.kill)
        late.start()
        try:
            yield it
        finally:
            late.cancel()
            it.kill()


@pytest.mark.parametrize("option", ["--mass", "--flux"])
@pytest.mark.parametrize("value", ["1e-5", "0.005", "1e9"])
def test_small_and_large_numbers_are_shown(run, tmp_path, option, value):
    outcome = run("view", option, value, "--out", tmp_path / "arm.html", "--json")
    assert outcome.code == 0
    assert outcome.json["joint"] == 6


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--q", "9,0,0,0,0,0,0"], "joint 1 is at 9, outside its limits"),
        (["--port", "0"], "port = 0: a port is from 1 to 65535"),
        (["--host", "no.such.host.invalid"], "host = no.such.host.invalid: "),
        (["--out", "arm.txt"], "out = arm.txt: the name must end in .html"),
        (["--joint", "8"], "joint = 8: iiwa14 has joints 1 to 7"),
        (["--direction", "0,0,0"], "direction"),
        (["--mass", "-1"], "mass = -1.0"),
    ],
)
def test_bad_input(run, arguments, words):
    outcome = run("view", *arguments)
    assert outcome.code == 1
    assert words in outcome.err
    assert len(outcome.err.splitlines()) == 1
    assert outcome.out == ""
