"""`hitjoints rollout`: keys, exit codes, words and files."""

from __future__ import annotations

import csv
import json

import numpy as np
import pytest
import xarray as xr

from hitjoints.cli import main

IMPACT = {
    "time", "position", "miss", "direction_error", "inertia", "desired_inertia", "speed", "flux",
    "q",
}  # fmt: skip
KEYS = {
    "impact", "steps", "saturated_steps", "velocity_ratio_max", "position_violation_max",
    "step_time_us",
}  # fmt: skip


@pytest.fixture
def run(capsys):
    """Run one of the two commands as the `hitjoints` script does: (code, stdout, stderr)."""

    def call(*arguments):
        with pytest.raises(SystemExit) as leaving:
            main([str(argument) for argument in arguments])
        printed = capsys.readouterr()
        return leaving.value.code or 0, printed.out, printed.err

    return call


def test_bare(run):
    code, out, err = run("rollout")
    assert code == 0
    assert err.startswith("warning: not sendable: accelerations are up to 56.2 times their limits")
    assert len(err.splitlines()) == 1
    for word in ("joint 6 hits 2 kg", "miss", "mm", "flux, 0.3 m/s desired", "0 of them saturated"):
        assert word in " ".join(out.split())


def test_json(run):
    code, out, _ = run("rollout", "--json")
    found = json.loads(out)
    assert code == 0
    assert set(found) >= KEYS
    assert set(found["impact"]) >= IMPACT
    assert set(found["step_time_us"]) == {"median", "p99"}
    assert found["impact"]["miss"] <= 2e-3
    assert found["impact"]["flux"] == pytest.approx(0.3, rel=0.01)
    assert found["velocity_ratio_max"] <= 1
    assert found["position_violation_max"] == 0


def test_a_plan_is_carried_out(run, tmp_path):
    made = tmp_path / "plan.json"
    asked = ("--object=0.45,-0.2,0.6", "--direction=1,0,0", "--mass", 1, "--joint", 7)
    assert run("plan", *asked, "--objective", "straight-flux", "--out", made)[0] == 0
    code, out, _ = run("rollout", "--plan", made, "--flux", 0.2, "--json")
    found = json.loads(out)
    assert code == 0
    assert found["joint"] == 7
    np.testing.assert_allclose(found["q_hit"], json.loads(made.read_text())["best"]["q"])
    np.testing.assert_allclose(found["impact"]["position"], [0.45, -0.2, 0.6], atol=2e-3)
    code, _, err = run("rollout", "--plan", made, "--joint", 6)
    assert code == 1
    assert "joint = 6" in err
    code, _, err = run("rollout", "--plan", made, "--robot", "panda")
    assert code == 1
    assert "made for iiwa14" in err


@pytest.mark.parametrize("ending", [".zarr", ".nc", ".csv"])
def test_the_data_set_is_written(run, tmp_path, ending):
    out = tmp_path / f"hit{ending}"
    start = ("--start", "0.5,0.24,0.5", "--reference", "constant")
    code, printed, err = run("rollout", *start, "--out", out, "--json")
    assert code == 0
    assert f"written: {out}" in err
    steps = json.loads(printed)["steps"]
    if ending == ".csv":
        with out.open() as file:
            rows = list(csv.DictReader(file))
        assert {"time", "q_1", "q_7", "qd_1", "position_3", "inertia"} <= set(rows[0])
        assert sum(row["approach"] == "True" for row in rows) == steps
        return
    if ending == ".zarr":
        data = xr.open_zarr(out, consolidated=False)
    else:
        data = xr.open_dataset(out, engine="h5netcdf")
    assert int(data.approach.sum()) == steps
    assert data.inertia.attrs["units"] == "kg"
    assert data.attrs["reference"] == "constant"
    data.close()


def test_the_figure_is_drawn(run, tmp_path):
    out = tmp_path / "hit.png"
    assert run("rollout", "--plot", out)[0] == 0
    assert out.stat().st_size > 10_000


@pytest.mark.parametrize(
    ("arguments", "code", "words"),
    [
        (["--q0", "9,9,9,9,9,9,9"], 1, "joint 1 is at 9"),
        (["--q0", "0,0,0"], 1, "7 joint positions"),
        (["--flux", "0"], 1, "flux = 0.0"),
        (["--mass", "-1"], 1, "mass = -1"),
        (["--dt", "0.04"], 1, "dt = 0.04"),
        (["--dt", "0"], 1, "dt = 0.0"),
        (["--dt", "1e-7"], 1, "a step of 2e-05 s to 0.05 s"),
        (["--flux", "1e-18"], 1, "at least 1e-06 m/s"),
        (["--flux", "1e-6", "--start", "0.5,0.2,0.5"], 1, "more than the 200 s of 100000 steps"),
        (["--joint", "9"], 1, "joints 1 to 7"),
        (["--law", "pid"], 1, "paper, qp"),
        (["--reference", "best"], 1, "constant, optimised"),
        (["--direction", "0,0,0"], 1, "must not be zero"),
        (["--start", "0.5,0.4,0.5"], 1, "beyond the object"),
        (["--plan", "missing.json"], 1, "plan --out` wrote is needed"),
        (["--out", "hit.txt"], 1, "must end in"),
        (["--object=-1,0,0.2"], 3, "unreachable"),
        (["--object=-1,0,0.2", "--q0=-0.34,1.41,-1.38,1.6,0.48,1.97,1.32"], 3, "out of reach"),
        (["--flux", "3"], 3, "beyond the maximum of 0.58"),
        (["--joint", "5"], 3, "away condition impossible"),
        (["--speed"], 2, "No such option"),
    ],
)
def test_bad_input_is_one_line(run, arguments, code, words):
    left, out, err = run("rollout", *arguments)
    assert left == code
    assert words in err
    assert len(err.strip().splitlines()) == 1
    assert out == ""


def test_the_maximum_flux_is_in_the_json(run):
    code, out, _ = run("rollout", "--flux", "3", "--json")
    found = json.loads(out)
    assert code == 3
    assert found["maximum_flux"] == pytest.approx(0.587, abs=0.01)
    assert "beyond the maximum" in found["reason"]


def test_a_miss_leaves_with_3_and_its_reason(run):
    # Eight centimetres aside and a fifth of a millimetre behind: no time to join the line.
    code, out, err = run("rollout", "--start", "0.42,0.2998,0.5", "--json")
    found = json.loads(out)
    assert code == 3
    assert found["reason"].startswith("off the line")
    assert found["reason"] in err
    assert found["impact"]["miss"] > 0.02
