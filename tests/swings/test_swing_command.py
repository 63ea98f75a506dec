"""`hitjoints swing`: keys, exit codes, words, files."""

from __future__ import annotations

import json

import numpy as np
import pytest

from hitjoints.export.trajectory import Trajectory, read_trajectory_csv, write_trajectory

KEYS = {
    "sendable", "why", "duration", "impact_time", "q0", "q_hit", "qd_hit", "torque_ratio_max",
    "acceleration_ratio_max", "velocity_ratio_max", "jerk_ratio_max", "position_violation_max",
    "clearance", "files", "flux", "joint", "robot",
}  # fmt: skip
JOINTS = [f"joint_{i}" for i in range(1, 8)]


@pytest.fixture(scope="module")
def made(arm):
    import hitjoints as hj

    hit = hj.Hit(6, [0.5, 0.3, 0.5], [0, 1, 0], 2.0, 0.3, size=[0.1, 0.1, 0.1])
    return hj.swing(arm("iiwa14"), hit)


def test_bare(run):
    found = run("swing")
    assert found.code == 0
    for word in ("joint 6 hits 2 kg", "flux, 0.3 m/s desired", "sendable yes", "not known"):
        assert word in found.words
    assert found.err == "note: iiwa14 does not tell: jerk; not kept, or left out\n"


def test_json_and_csv_say_the_same(run, tmp_path, made):
    out, plot = tmp_path / "hit.csv", tmp_path / "hit.png"
    found = run("swing", "--json", "--out", out, "--plot", plot)
    said = found.json
    assert found.code == 0
    assert set(said) >= KEYS
    assert said["sendable"] is True
    assert said["why"] == ""
    assert said["jerk_ratio_max"] is None
    assert said["files"] == [str(out), str(plot)]
    assert plot.stat().st_size > 10_000
    lines = out.read_text().splitlines()
    assert lines[0] == "# hitjoints, sendable"
    header = next(line for line in lines if not line.startswith("#"))
    names = [f"{name}{i}" for name in ("q", "qd", "qdd", "tau") for i in range(1, 8)]
    assert header == ",".join(["time", *names])
    time, columns = read_trajectory_csv(out)
    row = round(said["impact_time"] / said["dt"])
    np.testing.assert_allclose(columns["q"][row], said["q_hit"], rtol=1e-14)
    np.testing.assert_allclose(columns["qd"][row], said["qd_hit"], rtol=1e-14)
    np.testing.assert_allclose(time, made.times, rtol=1e-12)
    np.testing.assert_allclose(columns["tau"], made.torque, rtol=1e-12, atol=1e-12)
    # Third differences of what is in the file still are the jerk.
    jerk = np.diff(columns["q"], 3, axis=0) / said["dt"] ** 3
    assert np.abs(jerk).max() <= made.limits.jerk.max() * 1.001


def test_every_file_holds_the_same_motion(made, tmp_path):
    paths = {ending: tmp_path / f"hit.{ending}" for ending in ("csv", "npz", "yaml", "json")}
    for path in paths.values():
        made.save(path)
    stored = np.load(paths["npz"])
    message = json.loads(paths["json"].read_text())
    yaml = paths["yaml"].read_text()
    assert list(stored["joint_names"]) == message["joint_names"] == JOINTS
    assert message["hitjoints"]["sendable"] is True
    for name, key in (("q", "positions"), ("qd", "velocities"), ("qdd", "accelerations"),
                      ("tau", "effort")):  # fmt: skip
        rows = np.array([point[key] for point in message["points"]])
        assert rows.tobytes() == np.ascontiguousarray(stored[name]).tobytes()
        _, columns = read_trajectory_csv(paths["csv"])
        np.testing.assert_allclose(columns[name], rows, rtol=1e-14, atol=1e-300)
        assert yaml.count(f"{key}: [") == len(rows)
    times = [p["time_from_start"]["sec"] + 1e-9 * p["time_from_start"]["nanosec"]
             for p in message["points"]]  # fmt: skip
    np.testing.assert_allclose(times, made.times, atol=1e-9)


def test_yaml_is_yaml(made, tmp_path):
    yaml = pytest.importorskip("yaml")
    path = tmp_path / "hit.yaml"
    made.save(path)
    message = yaml.safe_load(path.read_text())
    assert set(message) == {"header", "joint_names", "points"}
    assert message["joint_names"] == JOINTS
    np.testing.assert_allclose(message["points"][-1]["positions"], made.joints.q[-1])


def test_what_is_not_sendable_says_so_in_its_file(tmp_path):
    one = np.zeros((1, 1))
    bad = Trajectory(("j1",), np.zeros(1), one, one, one, one, "torques are beyond their limits")
    for ending in ("csv", "yaml"):
        write_trajectory(bad, tmp_path / f"bad.{ending}")
        first = (tmp_path / f"bad.{ending}").read_text().splitlines()[0]
        assert first == "# hitjoints, not sendable: torques are beyond their limits"
    write_trajectory(bad, tmp_path / "bad.json")
    assert json.loads((tmp_path / "bad.json").read_text())["hitjoints"]["sendable"] is False


def test_a_plan_is_carried_out(run, tmp_path):
    plan = tmp_path / "plan.json"
    asked = ("--object=0.45,-0.2,0.6", "--direction=1,0,0", "--mass", 1, "--joint", 7)
    assert run("plan", *asked, "--objective", "straight-flux", "--out", plan).code == 0
    found = run("swing", "--plan", plan, "--flux", 0.2, "--json")
    assert found.json["joint"] == 7
    turns = np.subtract(found.json["q_hit"], json.loads(plan.read_text())["best"]["q"])
    off = np.abs((turns + np.pi) % (2 * np.pi) - np.pi).max()
    taken = [note for note in found.json["notes"] if "another is taken" in note]
    assert (off < 1e-6) == (not taken)
    assert ("another is taken" in found.err) == bool(taken)


@pytest.mark.parametrize(
    ("arguments", "code", "words"),
    [
        (["--robot", "xarm7"], 1, "does not tell its acceleration limits"),
        (["--acceleration", "0"], 1, "acceleration = 0.0"),
        (["--acceleration", "1,2"], 1, "or 7 of them"),
        (["--jerk", "-5"], 1, "jerk = -5"),
        (["--dt", "1"], 1, "dt = 1.0"),
        (["--q0", "9,9,9,9,9,9,9"], 1, "joint 1 is at 9"),
        (["--size", "0,1,1"], 1, "size"),
        (["--flux", "1e-18"], 1, "at least 1e-06"),
        (["--flux", "1e-5"], 3, "slower than 5 mm/s"),
        (["--out", "hit.txt"], 1, "must end in .csv, .npz, .yaml, .json"),
        (["--out", "/nowhere/hit.csv"], 1, "no folder"),
        (["--flux", "3"], 3, "beyond the maximum of 0.58"),
        (["--object=2,0,0.5"], 3, "unreachable"),
    ],
)
def test_bad_input_is_one_line(run, arguments, code, words):
    found = run("swing", *arguments)
    assert found.code == code
    assert words in found.err
    assert len(found.err.strip().splitlines()) == 1
    assert found.out == ""


def test_the_maximum_is_in_the_json(run):
    found = run("swing", "--flux", "3", "--json")
    assert found.code == 3
    assert 0.5 < found.json["maximum_flux"] < 0.6
