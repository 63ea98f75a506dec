"""`hitjoints plan`."""

import json

import numpy as np
import pytest
import typer
from typer.testing import CliRunner

import hitjoints as hj
from hitjoints.cli.option_groups import grouped
from hitjoints.cli.plan import plan

KEYS = {
    "joint", "feasible", "reason", "q", "position_error", "inertia", "speed", "straight_speed",
    "flux", "straight_flux", "away", "evidence",
}  # fmt: skip
app = typer.Typer()
app.command()(grouped(plan))


def run(*arguments):
    return CliRunner().invoke(app, [str(argument) for argument in arguments])


def test_bare():
    outcome = run()
    assert outcome.exit_code == 0
    for word in ("joint 6", "best: the most inertia", "no: away condition", "kg", "q = "):
        assert word in outcome.stdout


def test_json_and_file(tmp_path):
    out = tmp_path / "plan.json"
    outcome = run("--json", "--out", out, "--joint", 6, "--joint", 5)
    assert outcome.exit_code == 0
    found = json.loads(outcome.stdout)
    assert json.loads(out.read_text()) == found
    assert [one["joint"] for one in found["candidates"]] == [6, 5]
    assert all(set(one) >= KEYS for one in found["candidates"])
    assert found["best"]["joint"] == 6
    assert found["best"]["feasible"] is True
    assert found["candidates"][1]["inertia"] is None
    robot = hj.load_robot("iiwa14")
    np.testing.assert_allclose(hj.position(robot, found["best"]["q"], 6), [0.5, 0.3, 0.5])
    assert list(tmp_path.iterdir()) == [out]


def test_no_is_exit_code_3():
    outcome = run("--object", "2,0,0.5", "--json")
    assert outcome.exit_code == 3
    found = json.loads(outcome.stdout)
    assert found["best"] is None
    assert all("unreachable" in one["reason"] for one in found["candidates"])
    assert "no joint can do it" in outcome.stderr


def test_no_away_plans_joint_5():
    outcome = run("--joint", 5, "--no-away", "--no-certificate", "--json")
    found = json.loads(outcome.stdout)
    assert found["best"]["joint"] == 5
    assert found["best"]["evidence"]["certificate"] is None


def test_bad_input(tmp_path):
    for arguments in (
        ("--objective", "rebound"),
        ("--objective", "force"),
        ("--mass", "0"),
        ("--out", tmp_path / "plan.txt"),
        ("--out", tmp_path / "missing" / "plan.json"),
    ):
        outcome = run(*arguments)
        assert isinstance(outcome.exception, hj.InputError), arguments
        assert outcome.stdout == ""


def test_rebound():
    options = ("--objective", "rebound", "--json", "--no-certificate")
    found = json.loads(run(*options, "--flux", "0.9", "--flux-by", "speed").stdout)
    assert found["best"]["flux"] >= 0.9
    assert (found["flux"], found["flux_by"]) == (0.9, "speed")
    # No motion from rest to rest delivers that; by itself a flux is one that a motion delivers.
    outcome = run(*options, "--flux", "0.9")
    assert outcome.exit_code == 3
    reason = json.loads(outcome.stdout)["candidates"][-1]["reason"]
    assert "delivers 0.752" in reason
    found = json.loads(run(*options, "--flux", "0.7").stdout)
    assert found["best"]["deliverable_flux"] >= 0.7
    assert found["flux_by"] == "deliverable"


def test_where_accelerations_are_not_known_flux_is_by_speed():
    hit = ("--robot", "xarm7", "--joint", "6", "--no-certificate", "--json")
    found = json.loads(run(*hit, "--flux", "0.3").stdout)
    assert found["flux_by"] == "speed"
    assert found["best"]["deliverable_flux"] is None
    assert "xarm7 are not known" in found["best"]["deliverable_reason"]
    for more in (("--objective", "deliverable"), ("--flux", "0.3", "--flux-by", "deliverable")):
        outcome = run(*hit, *more)
        assert isinstance(outcome.exception, hj.InputError)
        assert outcome.exception.argument == "acceleration"
    assert run(*hit, "--flux", "0.3", "--flux-by", "wish").exit_code != 0


def test_plot(tmp_path):
    pytest.importorskip("hitjoints.show.drawn_arm")
    picture = tmp_path / "plan.png"
    assert run("--joint", 6, "--joint", 5, "--no-certificate", "--plot", picture).exit_code == 0
    assert picture.read_bytes().startswith(b"\x89PNG")
