"""`hitjoints simulate`: keys, exit codes, words and files."""

import csv
import sys

import pytest
import xarray as xr
from PIL import Image

COMPARED = {"object_speed", "rebound", "inertia"}
HIT = ["--object", "0.5,0.3,0.5", "--direction", "0,1,0", "--mass", "2", "--joint", "6"]


def test_bare(run):
    outcome = run("simulate")
    assert (outcome.code, outcome.err) == (0, "")
    for word in ("joint 6 hits 2 kg", "ideal", "object speed", "rebound", "inertia", "travel"):
        assert word in outcome.words
    assert "cause" not in outcome.words


def test_json(run):
    outcome = run("simulate", *HIT, "--flux", "0.25", "--restitution", "0.3", "--ideal", "--json")
    found = outcome.json
    assert (outcome.code, outcome.err) == (0, "")
    assert COMPARED | {"travel", "flux", "speed"} <= set(found["predicted"])
    assert COMPARED | {"travel", "restitution", "contact_time"} <= set(found["simulated"])
    assert (found["restitution"], found["contact_time"]) == (0.3, 1e-4)
    assert found["mode"] == "ideal"
    assert found["hit"]
    assert found["shares"] == []
    assert found["predicted"]["flux"] == pytest.approx(0.25, rel=1e-3)
    for name in COMPARED:
        predicted, simulated = found["predicted"][name], found["simulated"][name]
        assert found["errors"][name] == pytest.approx(simulated / predicted - 1)
        assert simulated == pytest.approx(predicted, rel=5e-3)


def test_a_realistic_hit(run):
    outcome = run("simulate", "--realistic", "--servo-gain", "20", "--json")
    found = outcome.json
    assert outcome.code == 0
    assert found["contact_time"] == 0.01
    causes = {share["cause"]: share for share in found["shares"]}
    assert set(causes) == {"servo", "contact time", "contact friction", "off-centre", "table"}
    assert causes["servo"]["value"] == 20
    for share in causes.values():
        assert set(share["alone"]) == set(share["without"]) == COMPARED
    assert abs(found["errors"]["object_speed"]) > 0.02


def test_the_table_names_each_cause(run):
    outcome = run("simulate", "--off-centre", "0.03", "--contact-friction", "0.2")
    assert outcome.code == 0
    for word in ("off-centre 0.03 m", "contact friction 0.2", "without"):
        assert word in outcome.words
    assert "servo" not in outcome.words


def test_a_plan_is_hit(run, tmp_path):
    path = tmp_path / "plan.json"
    run("plan", "--joint", "7", "--objective", "straight-flux", "--out", path)
    found = run("simulate", "--plan", path, "--json").json
    assert found["joint"] == 7
    assert found["simulated"]["inertia"] == pytest.approx(found["predicted"]["inertia"], rel=0.01)
    outcome = run("simulate", "--plan", path, "--joint", "6")
    assert outcome.code == 1
    assert "the plan is for 7" in outcome.err


@pytest.mark.parametrize("ending", [".zarr", ".nc", ".csv"])
def test_the_data_set_is_written(run, tmp_path, ending):
    out = tmp_path / f"hit{ending}"
    outcome = run("simulate", "--out", out)
    assert outcome.code == 0
    assert f"written: {out}" in outcome.err
    if ending == ".csv":
        with out.open() as file:
            rows = list(csv.DictReader(file))
        assert {"time", "robot_speed", "object_speed", "force", "q_1", "q_7"} <= set(rows[0])
        return
    if ending == ".zarr":
        data = xr.open_zarr(out, consolidated=False)
    else:
        data = xr.open_dataset(out, engine="h5netcdf")
    assert data.force.attrs["units"] == "N"
    assert float(data.object_speed[-1]) > float(data.robot_speed[-1])
    data.close()


@pytest.mark.parametrize("options", [[], ["--direction", "0,1,0.3"], ["--off-centre", "0.02"]])
def test_the_figure_is_drawn(run, tmp_path, options):
    out = tmp_path / "hit.png"
    assert run("simulate", *options, "--plot", out).code == 0
    assert out.stat().st_size > 10_000


def test_the_moving_picture_moves(run, tmp_path, monkeypatch):
    monkeypatch.setattr("hitjoints.show.animation.PICTURES", 4)
    out = tmp_path / "hit.gif"
    assert run("simulate", "--animate", out).code == 0
    with Image.open(out) as film:
        assert film.n_frames >= 4
        film.seek(0)
        first = film.convert("RGB").tobytes()
        film.seek(film.n_frames - 1)
        assert film.convert("RGB").tobytes() != first


@pytest.mark.parametrize(
    ("arguments", "code", "words"),
    [
        (["--restitution", "1.5"], 1, "restitution = 1.5: it must lie from 0 to 1"),
        (["--restitution", "-0.1"], 1, "restitution = -0.1"),
        (["--restitution", "nan"], 1, "restitution = nan"),
        (["--size", "0.1,0,0.1"], 1, "size = (0.1, 0.0, 0.1): three edges from 0.001 to 10 m"),
        (["--size", "0.1,0.1"], 1, "size = 0.1,0.1"),
        (["--friction", "-1"], 1, "friction = -1"),
        (["--friction", "5e-4"], 1, "friction = 0.0005: the box would slide for more than 60 s"),
        (["--contact-friction", "nan"], 1, "contact_friction = nan"),
        (["--servo-gain", "-1"], 1, "servo_gain = -1"),
        (["--contact-time", "1"], 1, "contact_time = 1.0: a contact lasts 1e-06 s to 0.05 s"),
        (["--servo-gain", "1e6"], 1, "at most 10000 N m s/rad"),
        (["--contact-time", "0"], 1, "contact_time = 0"),
        (["--off-centre", "0.06"], 1, "the arm misses the box"),
        (["--realistic", "--direction", "0,1,1"], 1, "horizontally"),
        (["--mass", "-1"], 1, "mass = -1"),
        (["--joint", "9"], 1, "joints 1 to 7"),
        (["--robot", "iiwa15"], 1, "iiwa15"),
        (["--plot", "hit.txt"], 1, "must end in"),
        (["--animate", "hit.mp4"], 1, "must end in .gif"),
        (["--out", "no/hit.nc"], 1, "there is no folder"),
        (["--object=-1,0,0.2"], 3, "unreachable"),
        (["--flux", "3"], 3, "beyond the maximum of 0.58"),
        (["--start", "0.42,0.2998,0.5"], 3, "no hit: off the line"),
        (["--restitution", "bouncy"], 2, "--restitution"),
        (["--speed"], 2, "No such option"),
    ],
)
def test_bad_input_is_one_line(run, arguments, code, words):
    outcome = run("simulate", *arguments)
    assert outcome.code == code
    assert words in outcome.err
    assert len(outcome.err.strip().splitlines()) == 1
    assert outcome.out == ""


def test_no_is_in_the_json(run):
    outcome = run("simulate", "--flux", "3", "--json")
    assert outcome.code == 3
    assert outcome.json["maximum_flux"] == pytest.approx(0.587, abs=0.01)
    assert "beyond the maximum" in outcome.json["reason"]


def test_without_mujoco_the_install_line_is_told(run, monkeypatch):
    monkeypatch.setitem(sys.modules, "mujoco", None)
    outcome = run("simulate", "--json")
    assert (outcome.code, outcome.out) == (1, "")
    assert outcome.err == "error: mujoco is not installed: pip install 'hitjoints[sim]'\n"


def test_it_follows_a_swing(run):
    found = run("simulate", "--swing", "--json")
    assert found.code == 0
    assert found.json["predicted"]["flux"] == pytest.approx(0.3, rel=1e-6)
    assert abs(found.json["errors"]["object_speed"]) < 2e-3
    refused = run("simulate", "--swing", "--start", "0.5,0.2,0.5")
    assert refused.code == 1
    assert "give --q0" in refused.err
