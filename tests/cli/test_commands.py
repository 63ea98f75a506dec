"""Each command bare, as a table and as JSON."""

import math
import re

import numpy as np
import pytest
import xarray as xr

import hitjoints as hj

INSPECT_KEYS = {
    "position", "rank", "inverse_inertia", "inertia", "gradient",
    "speed", "straight_speed", "flux", "straight_flux",
}  # fmt: skip


def test_help_version_and_no_command(run):
    assert "inspect" in run("--help").out
    assert "inspect" in run().out
    assert run("--version").out.startswith("hitjoints ")
    for command in (["inspect"], ["sweep", "joint"], ["sweep", "workspace"], ["robots", "check"]):
        assert run(*command, "--help").code == 0


def test_inspect_prints_units(run):
    outcome = run("inspect")
    assert outcome.code == 0
    for word in ("inertia", "kg/rad", "m/s", "KUKA LBR iiwa 14"):
        assert word in outcome.words


def test_inspect_json_agrees_with_the_api(run):
    robot, q, h = hj.load_robot("panda"), "0.1,0.4,0,-1.8,0.2,2,0.3", [1, 2, 0]
    contact = hj.Contact(7, (0.0, 0.03, 0.1))
    found = run(
        "inspect", "--robot", "panda", "--joint", "7", "--q", q, "--direction", "1,2,0",
        "--mass", "1.5", "--offset", "0,0.03,0.1", "--json",
    ).json  # fmt: skip
    assert set(found) >= INSPECT_KEYS
    q = np.array(q.split(","), float)
    np.testing.assert_allclose(found["position"], hj.position(robot, q, contact))
    np.testing.assert_allclose(found["inverse_inertia"], hj.inverse_inertia(robot, q, contact))
    inertia = hj.directional_inertia(robot, q, contact, h)
    assert found["inertia"] == pytest.approx(inertia, rel=1e-12)
    gradient = hj.directional_inertia_gradient(robot, q, contact, h)
    np.testing.assert_allclose(found["gradient"], gradient, rtol=1e-10)
    speed = hj.hitting_speed(robot, q, contact, h)
    assert found["flux"] == pytest.approx(inertia / (inertia + 1.5) * speed)
    assert 0 < found["straight_speed"] <= found["speed"]
    unit = np.array(h) / math.sqrt(5)
    assert 1 / inertia == pytest.approx(unit @ np.array(found["inverse_inertia"]) @ unit)


def test_inspect_a_plan_says_what_the_plan_says(run, tmp_path):
    file = tmp_path / "plan.json"
    planned = run(
        "plan", "--robot", "iiwa7", "--joint", "6", "--mass", "1.5", "--no-certificate",
        "--json", "--out", file,
    ).json["best"]  # fmt: skip
    found = run("inspect", "--plan", file, "--json").json
    assert found["robot"] == "iiwa7"
    assert found["q"] == planned["q"]
    for name in ("joint", "inertia", "speed", "straight_speed", "flux", "straight_flux"):
        assert found[name] == pytest.approx(planned[name], rel=1e-7), name
    assert run("inspect", "--plan", file, "--joint", "7").code == 1
    elsewhere = run("inspect", "--plan", file, "--q", "0,0.5,0,-1,0,1,0", "--json").json
    assert elsewhere["q"] == [0, 0.5, 0, -1, 0, 1, 0]


def test_inspect_infeasible_direction(run):
    # The elbow (joint 4) moves on a sphere about joint 2, so not along the line between them.
    q = [0, 0.5, 0, -1, 0, 0, 0]
    robot = hj.load_robot("iiwa14")
    radius = hj.position(robot, q, 4) - hj.position(robot, q, 2)
    along, at = (",".join(map(str, v)) for v in (radius, q))
    outcome = run("inspect", "--joint", 4, "--q", at, "--direction", along, "--json")
    assert outcome.code == 3
    found = outcome.json
    assert found["inertia"] is None
    assert found["gradient"] is None
    assert (found["speed"], found["flux"], found["rank"]) == (0, 0, 2)
    assert "infeasible direction" in found["reason"]
    assert "infeasible direction" in outcome.err


def test_robots_list(run):
    outcome = run("robots", "list", "--json")
    names = {row["name"] for row in outcome.json["robots"]}
    assert names >= {"iiwa14", "iiwa14_bullet", "iiwa7", "panda", "xarm7"}
    said = run("robots", "list").out
    assert all(name in said for name in names)


def test_robots_check(run, tmp_path):
    assert run("robots", "check").words.strip() == "iiwa14: no issues"
    assert run("robots", "check", "panda", "--json").json["issues"]
    xml = hj.load_robot("iiwa14").xml
    phantom = (
        '<inertial><mass value="1e-6"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>'
        "</inertial>"
    )
    path = tmp_path / "arm.urdf"
    path.write_text(xml.replace('<link name="flange" />', f'<link name="flange">{phantom}</link>'))
    outcome = run("robots", "check", path, "--json")
    assert outcome.code == 0
    (issue,) = (i for i in outcome.json["issues"] if i["severity"] != "note")
    assert issue["link"] == "flange"
    assert issue["severity"] == "error"
    assert "joint 7" in issue["effect"]
    assert run("robots", "check", path, "--strict").code == 3
    assert "warning: arm: flange" in run("inspect", "--robot", path).err


def test_robots_check_of_what_cannot_be_loaded(run, tmp_path):
    path = tmp_path / "arm.urdf"
    path.write_text(re.sub(r"<limit[^>]*/>", "", hj.load_robot("iiwa14").xml, count=1))
    outcome = run("robots", "check", path, "--json")
    assert outcome.code == 1
    (issue,) = outcome.json["issues"]
    assert "joint_1" in issue["problem"]
    assert "no <limit>" in issue["problem"]


def test_sweep_joint_json(run):
    found = run("sweep", "joint", "--joint", 6, "--joint", 7, "--count", 5, "--json").json
    assert [row["joint"] for row in found["joints"]] == [6, 7]
    six = found["joints"][0]
    robot = hj.load_robot("iiwa14")
    q = np.array(six["q"])
    np.testing.assert_allclose(hj.position(robot, q, 6), [0.5, 0.3, 0.5], atol=1e-9)
    for angle, inertia, speed, flux in zip(
        six["angle"], six["inertia"], six["speed"], six["flux"], strict=True
    ):
        q[5] = angle
        assert inertia == pytest.approx(hj.directional_inertia(robot, q, 6, [0, 1, 0]), rel=1e-10)
        assert speed == pytest.approx(hj.hitting_speed(robot, q, 6, [0, 1, 0]), rel=1e-10)
        assert flux == pytest.approx(inertia / (inertia + 2) * speed)


@pytest.mark.parametrize("ending", ["zarr", "nc", "csv"])
def test_sweep_joint_files(run, tmp_path, ending):
    out, plot = tmp_path / f"sweep.{ending}", tmp_path / "sweep.png"
    outcome = run("sweep", "joint", "--count", 9, "--out", out, "--plot", plot)
    assert outcome.code == 0
    assert "joint 6" in outcome.words
    assert plot.read_bytes().startswith(b"\x89PNG")
    if ending == "csv":
        assert len(out.read_text().splitlines()) == 1 + 3 * 9
        return
    opened = xr.open_zarr(out, consolidated=False) if ending == "zarr" else xr.open_dataset(out)
    assert opened.inertia.attrs["units"] == "kg"
    assert opened.sizes == {"joint": 3, "sample": 9, "axis": 7}
    assert opened.attrs["robot"] == "iiwa14"
    assert [p.name for p in tmp_path.iterdir() if p.name.startswith(".")] == []


def test_sweep_joint_part_out_of_reach(run):
    # Joint 5 sits at the elbow side: it does not get as far as joint 7.
    outcome = run("sweep", "joint", "--object", "0.75,0.3,0.5", "--json")
    assert outcome.code == 0
    reached = {row["joint"]: row["reachable"] for row in outcome.json["joints"]}
    assert reached[7]
    assert not reached[5]
    assert outcome.json["joints"][0]["inertia"][0] is None
    assert "out of reach" in run("sweep", "joint", "--object", "0.75,0.3,0.5").words


def test_sweep_workspace(run, tmp_path):
    out, plot = tmp_path / "map.zarr", tmp_path / "map.png"
    arguments = [
        "sweep", "workspace", "--x", "-0.2:0.8:6", "--y", "-0.5:0.5:5", "--z", "0.5",
        "--direction", "0,1,0", "--direction", "1,0,0", "--samples", "20", "--joint", "6",
        "--joint", "7", "--out", out, "--plot", plot, "--csv", tmp_path / "map.csv",
        "--nc", tmp_path / "map.nc",
    ]  # fmt: skip
    outcome = run(*arguments, "--json")
    assert outcome.code == 0
    assert len(outcome.json["summary"]) == 4
    assert outcome.json["command"].startswith("hitjoints")
    opened = xr.open_zarr(out)
    assert {"inertia", "speed", "flux", "reachable"} <= set(opened.data_vars)
    assert opened.sizes["x"] == 6
    with xr.open_dataset(tmp_path / "map.nc") as copy:
        for name in copy.data_vars:
            np.testing.assert_array_equal(copy[name].values, opened[name].values)
        assert copy.flux.attrs["units"] == "m/s"
    lines = (tmp_path / "map.csv").read_text().splitlines()
    assert len(lines) == 1 + 2 * 2 * 6 * 5
    assert {"flux", "q_7", "direction_vector_2"} <= set(lines[0].split(","))
    assert plot.read_bytes().startswith(b"\x89PNG")
    again = run(*arguments)
    assert again.code == 0
    assert "greatest flux" in again.words
    refused = run(*arguments, "--seed", "1")
    assert refused.code == 1
    assert "another seed" in refused.err


def test_sweep_workspace_with_a_contact_point(run):
    words = ["sweep", "workspace", "--x", "0.5", "--y", "0.2", "--z", "0.5", "--joint", 7]
    found = run(*words, "--samples", 9, "--offset", "0,0.05,0.1", "--json").json
    assert found["offsets"] == [[0, 0.05, 0.1]]
    robot, q = hj.load_robot("iiwa14"), found["summary"][0]["q"]
    contact = hj.Contact(7, (0, 0.05, 0.1))
    np.testing.assert_allclose(hj.position(robot, q, contact), [0.5, 0.2, 0.5], atol=1e-8)
    inertia = hj.directional_inertia(robot, q, contact, [0, 1, 0])
    assert found["summary"][0]["inertia"] == pytest.approx(inertia, rel=1e-9)
    assert run(*words, "--offset", "1,2").code == 1


def test_sweep_workspace_out_of_reach(run):
    outcome = run("sweep", "workspace", "--x", "2:3:2", "--y", "0:1:2", "--samples", 3, "--json")
    assert outcome.code == 3
    assert outcome.json["summary"][0]["reachable"] == 0
