"""`hitjoints replay`: keys, exit codes, words and files."""

import shutil

import pytest
import xarray as xr

import hitjoints as hj
from hitjoints.evidence.recordings.hit_files import EXAMPLES

KEYS = {
    "file", "robot", "ok", "reason", "position_error", "inertia", "recorded_inertia", "flux",
    "recorded_flux", "robot_speed", "object_speed", "restitution",
}  # fmt: skip


def test_bare(run):
    outcome = run("replay")
    assert outcome.code == 0
    for word in ("4 of 4 recorded hits", "IIWA_7_hit_101", "restitution", "no validation"):
        assert word in outcome.words
    assert "note: 4 of 4 files: friction" in outcome.err


def test_json(run):
    outcome = run("replay", EXAMPLES, "--json")
    assert outcome.code == 0
    found = outcome.json
    assert (found["files"], found["usable"]) == (4, 4)
    for hit, known in zip(found["hits"], hj.replay().hits, strict=True):
        assert set(hit) >= KEYS
        assert hit["ok"] is True
        assert hit["position_error"] < 1e-6
        assert hit["flux"] == known.flux
        assert hit["restitution"] == known.restitution
    assert "no validation" in found["remarks"]["momentum_mass"]


def test_the_rest_goes_on(run, tmp_path):
    for name in ("IIWA_7_hit_44.csv", "object_1_hit_44.csv", "IIWA_14_hit_10.csv"):
        shutil.copy(EXAMPLES / name, tmp_path)
    (tmp_path / "IIWA_7_hit_1.csv").write_text("nothing")
    outcome = run("replay", tmp_path, tmp_path / "no.csv", "--json")
    assert outcome.code == 0
    hits = {hit["file"].rpartition("/")[2]: hit for hit in outcome.json["hits"]}
    assert [name for name, hit in hits.items() if hit["ok"]] == [
        "IIWA_14_hit_10.csv",
        "IIWA_7_hit_44.csv",
    ]
    assert hits["no.csv"]["reason"] == "there is no such file"
    assert "no column RosTime" in hits["IIWA_7_hit_1.csv"]["reason"]
    alone = hits["IIWA_14_hit_10.csv"]
    assert alone["object_speed"] is alone["restitution"] is None
    assert "no file object_*_hit_10.csv" in alone["reason"]
    assert "not usable: " in run("replay", tmp_path).err


def test_none_usable(run, tmp_path):
    outcome = run("replay", tmp_path / "no.csv", tmp_path, "--json")
    assert outcome.code == 1
    assert [hit["ok"] for hit in outcome.json["hits"]] == [False, False]
    assert outcome.err.startswith("error: no file could be used: there is no such file")
    assert outcome.err.count("\n") == 1


def test_another_robot(run):
    outcome = run("replay", "--robot", "iiwa7", "--json")
    assert outcome.code == 0
    verdicts = {hit["file"].rpartition("/")[2]: hit for hit in outcome.json["hits"]}
    assert verdicts["IIWA_7_hit_44.csv"]["ok"]
    wrong = verdicts["IIWA_14_hit_10.csv"]
    assert not wrong["ok"]
    assert "fits iiwa14" in wrong["reason"]
    assert run("replay", "--robot", "panda").code == 1


def test_options_reach_the_answer(run):
    file = EXAMPLES / "IIWA_7_hit_101.csv"
    options = ("--mass", "1", "--restitution", "0.5", "--direction=0.1,1,0", "--offset=0,0,0.15")
    (hit,) = run("replay", file, *options, "--json").json["hits"]
    assert (hit["mass"], hit["mass_source"], hit["assumed_restitution"]) == (1, "given", 0.5)
    assert hit["predicted_object_speed"] == pytest.approx(1.5 * hit["flux"])
    assert hit["direction"][0] > 0.09


@pytest.mark.parametrize("ending", ["zarr", "nc", "csv"])
def test_files(run, tmp_path, ending):
    out, plot = tmp_path / f"hits.{ending}", tmp_path / "hits.png"
    outcome = run("replay", "--out", out, "--plot", plot)
    assert outcome.code == 0
    assert plot.read_bytes().startswith(b"\x89PNG")
    if ending == "csv":
        lines = out.read_text().splitlines()
        assert len(lines) == 5
        assert set(lines[0].split(",")) >= KEYS
        return
    opened = xr.open_zarr(out, consolidated=False) if ending == "zarr" else xr.open_dataset(out)
    assert opened.sizes == {"hit": 4, "row": 12, "axis": 7}
    assert opened.inertia.attrs["units"] == "kg"


def test_a_figure_without_an_object_or_a_hit(run, tmp_path):
    shutil.copy(EXAMPLES / "IIWA_7_hit_44.csv", tmp_path)
    assert run("replay", tmp_path, "--plot", tmp_path / "one.png").code == 0
    assert run("replay", tmp_path / "no.csv", "--plot", tmp_path / "none.svg").code == 1


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--mass", "0"], "mass = 0"),
        (["--restitution", "2"], "restitution = 2"),
        (["--robot", "iiwa15"], "robot = 'iiwa15'"),
        (["--offset", "1,2"], "offset"),
        (["--direction", "0,0,0"], "direction"),
        (["--out", "x.txt"], "out = x.txt"),
        (["--plot", "no/x.png"], "there is no folder"),
    ],
)
def test_bad_input(run, arguments, words):
    outcome = run("replay", *arguments, "--json")
    assert (outcome.code, outcome.out) == (1, "")
    assert words in outcome.err
    assert outcome.err.count("\n") == 1


def test_wrong_usage(run):
    assert run("replay", "--mass", "heavy").code == 2
    assert run("replay", "--no-such-option").code == 2
