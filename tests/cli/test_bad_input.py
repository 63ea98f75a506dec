"""Bad input: one line that names the argument, its value and what would be right."""

import os
import stat

import pytest

FLOATING = """<robot name="r"><link name="world"/><link name="base"/>
<joint name="root" type="floating"><parent link="world"/><child link="base"/></joint></robot>"""

CASES = {
    "unknown robot": (["inspect", "--robot", "iiwa15"], ["robot = 'iiwa15'", "iiwa14", "panda"]),
    "joint 0": (["inspect", "--joint", "0"], ["joint = 0", "1 to 7"]),
    "joint 9": (["inspect", "--joint", "9"], ["joint = 9", "1 to 7"]),
    "joint 9 in a sweep": (["sweep", "joint", "--joint", "9"], ["joint = 9", "1 to 7"]),
    "joint twice": (["sweep", "joint", "--joint", "6", "--joint", "6"], ["joint", "once"]),
    "short q": (["inspect", "--q", "0,0,0"], ["q = [0.,0.,0.]", "7 joint positions", "(3,)"]),
    "nan q": (["inspect", "--q", "0,0,nan,0,0,0,0"], ["q = ", "finite"]),
    "infinite q": (["inspect", "--q", "0,0,inf,0,0,0,0"], ["q = ", "finite"]),
    "q beyond a limit": (
        ["inspect", "--q", "0,2.2,0,0,0,0,0"],
        ["joint 2 is at 2.2", "[-2.0944, 2.0944]"],
    ),
    "zero direction": (["inspect", "--direction", "0,0,0"], ["direction", "must not be zero"]),
    "short direction": (["inspect", "--direction", "0,1"], ["direction", "three numbers"]),
    "nan direction": (["inspect", "--direction", "0,nan,1"], ["direction", "finite"]),
    "short offset": (["inspect", "--offset", "0,1"], ["offset", "three numbers"]),
    "an offset off any arm": (["inspect", "--offset", "1e308,0,0"], ["offset", "beyond 100 m"]),
    "a box too small": (["simulate", "--size", "1e-6,1,1"], ["size", "edges from 0.001 to 10 m"]),
    "a box too large": (["simulate", "--size", "1e12,1,1"], ["size", "edges from 0.001 to 10 m"]),
    "negative mass": (["inspect", "--mass", "-2"], ["mass = -2", "more than 0 kg"]),
    "nan mass": (["inspect", "--mass", "nan"], ["mass = nan", "more than 0 kg"]),
    "mass of a sweep": (["sweep", "joint", "--mass", "0"], ["mass = 0", "more than 0 kg"]),
    "one angle": (["sweep", "joint", "--count", "1"], ["count = 1", "at least 2"]),
    "out without an ending": (["sweep", "joint", "--out", "x"], ["out = x", ".zarr, .nc, .csv"]),
    "no such folder": (["sweep", "joint", "--plot", "no/x.png"], ["plot", "there is no folder no"]),
    "no such file": (["inspect", "--robot", "no/arm.urdf"], ["robot = no/arm.urdf", "No such"]),
    "descending grid": (["sweep", "workspace", "--x", "1:0:5"], ["x = ", "ascending"]),
    "empty grid": (["sweep", "workspace", "--x", "0:1:0"], ["x = ", "ascending"]),
    "no samples": (["sweep", "workspace", "--samples", "0"], ["samples = 0", "at least 1"]),
    "too many samples": (
        ["sweep", "workspace", "--samples", "1000000000"],
        ["samples = 1000000000", "at most 1000000"],
    ),
    "too many angles": (
        ["sweep", "joint", "--count", "2147483648"],
        ["count = 2147483648", "at most 1000000"],
    ),
    "too long an axis": (
        ["sweep", "workspace", "--y", "0:1:1000000000"],
        ["y = 1000000000", "at most 100000"],
    ),
    "too large a grid": (
        ["sweep", "workspace", "--x", "0:1:100000", "--y", "0:1:100000"],
        ["10000000000 positions", "at most 100000000"],
    ),
    "too large for the memory": (
        ["sweep", "workspace", "--x", "0:1:1000", "--y", "0:1:1000", "--z", "0:1:10"],
        ["out = ", "4.8 GB", "name a Zarr store"],
    ),
    "too many threads": (["sweep", "workspace", "--threads", "9999"], ["threads = 9999", "1024"]),
    "too large a box": (["simulate", "--size", "1e12,1,0.2"], ["size", "from 0.001 to 10 m"]),
    "too small a box": (["simulate", "--size", "1e-6,1e-6,1e-6"], ["from 0.001 to 10 m"]),
}


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("as_json", [False, True])
def test_one_line_and_exit_code_1(run, name, as_json):
    arguments, words = CASES[name]
    outcome = run(*arguments, *(["--json"] if as_json else []))
    assert outcome.code == 1
    assert outcome.out == ""
    assert outcome.err.count("\n") == 1
    assert outcome.err.startswith("error: ")
    for word in words:
        assert word in outcome.err


@pytest.mark.parametrize(
    "arguments",
    [
        ["inspect", "--q", "a,b"],
        ["inspect", "--direction", "up"],
        ["inspect", "--mass", "heavy"],
        ["inspect", "--no-such-option"],
        ["sweep", "workspace", "--x", "0:1"],
        ["sweep", "workspace", "--x", "0:inf:2"],
        ["sweep", "workspace", "--seed", "18446744073709551616"],
        ["sweep", "joint", "--seed", "-1"],
        ["no-such-command"],
        ["sweep", "joint", "--seed", "18446744073709551616"],
        ["plan", "--seed", "-1"],
    ],
)
def test_wrong_usage(run, arguments):
    outcome = run(*arguments)
    assert (outcome.code, outcome.out) == (2, "")
    assert outcome.err.startswith("usage: ")
    assert outcome.err.count("\n") == 1


@pytest.mark.parametrize(
    ("text", "reason"),
    [("<robot", "not well-formed XML"), ("<sdf/>", "it is an SDF"), (FLOATING, "base floats")],
)
def test_robot_files(run, tmp_path, text, reason):
    path = tmp_path / "arm.urdf"
    path.write_text(text)
    for command in ("inspect", "sweep joint"):
        outcome = run(*command.split(), "--robot", path)
        assert outcome.code == 1
        assert reason in outcome.err
        assert outcome.err.count("\n") == 1


def test_unreachable_point_is_a_no(run):
    outcome = run("sweep", "joint", "--object", "2,0,0", "--json")
    assert outcome.code == 3
    assert "unreachable" in outcome.json["reason"]
    assert set(outcome.json["position_error"]) == {"5", "6", "7"}


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write everywhere")
def test_unwritable_folder(run, tmp_path):
    tmp_path.chmod(stat.S_IRUSR | stat.S_IXUSR)
    outcome = run("sweep", "joint", "--out", tmp_path / "x.nc")
    assert outcome.code == 1
    assert "permission denied" in outcome.err


def test_a_folder_in_place_of_a_file(run, tmp_path):
    (tmp_path / "x.nc").mkdir()
    outcome = run("sweep", "joint", "--out", tmp_path / "x.nc")
    assert outcome.code == 1
    assert "it is a folder" in outcome.err


def test_the_disk_refuses(run, tmp_path, monkeypatch):
    """A write that fails half-way leaves nothing behind."""
    import xarray as xr

    def refuse(self, path, **_):
        path.mkdir()
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(xr.Dataset, "to_zarr", refuse)
    outcome = run("sweep", "joint", "--out", tmp_path / "x.zarr")
    assert outcome.code == 1
    assert "No space left" in outcome.err
    assert list(tmp_path.iterdir()) == []


def test_a_contact_that_rounding_says_no_joint_beyond_leaves_where_it_is(run):
    """No joint is left to cut the certificate's box by, and the box stays open."""
    words = ["plan", "--joint", 7, "--offset", "5e-324,-0.0401,0.76"]
    outcome = run(*words, "--object=-0.615,1e-18,0.714", "--json")
    assert outcome.code in (0, 3)
    assert outcome.json["candidates"][0]["joint"] == 7
