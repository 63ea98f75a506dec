"""What is written: whole or not at all, over nothing that hitjoints did not write."""

import os
import resource
import subprocess
import sys
from pathlib import Path

import h5netcdf
import numpy as np
import pytest
import xarray as xr

from hitjoints.datasets.files import check_apart, check_writable, write_dataset, write_whole
from hitjoints.datasets.netcdf import PatientFile
from hitjoints.errors import InputError

SWEEP = ["sweep", "joint", "--count", "9"]
TOO_LONG = "x" * 300


def data(**attributes):
    return xr.Dataset({"v": ("x", np.arange(5.0))}, attrs={"source": "hitjoints 0"} | attributes)


@pytest.mark.parametrize("inside", ["thesis.txt", "v/thesis.txt", "v/c/thesis", "notes/x"])
def test_a_folder_with_anything_else_in_it_is_never_replaced(run, tmp_path, inside):
    out = tmp_path / "precious.zarr"
    write_dataset(data(), out)
    (out / inside).parent.mkdir(exist_ok=True)
    (out / inside).write_text("mine")
    with pytest.raises(InputError, match="is not of hitjoints"):
        write_dataset(data(), out)
    outcome = run(*SWEEP, "--out", out)
    assert outcome.code == 1
    assert outcome.err.count("\n") == 1
    assert (out / inside).read_text() == "mine"
    assert os.listdir(tmp_path) == ["precious.zarr"]


def test_a_folder_of_another_program_is_never_replaced(run, tmp_path):
    out = tmp_path / "precious.zarr"
    data().drop_attrs().to_zarr(out, zarr_format=3, consolidated=False)
    assert run(*SWEEP, "--out", out).err.endswith("it is a folder that hitjoints did not write\n")
    assert list(xr.open_zarr(out, consolidated=False).variables) == ["v"]


def test_a_data_set_of_ours_is_replaced(run, tmp_path):
    out = tmp_path / "swept.zarr"
    for count in (9, 5):
        assert run("sweep", "joint", "--count", count, "--out", out).code == 0
    assert xr.open_zarr(out, consolidated=False).sizes["sample"] == 5
    assert os.listdir(tmp_path) == ["swept.zarr"]


def test_a_map_is_never_replaced(run, tmp_path):
    out = tmp_path / "map.zarr"
    grid = ["--x=0.5", "--y=0.3", "--z=0.5", "--samples", "2", "--joint", "6"]
    assert run("sweep", "workspace", *grid, "--out", out).code == 0
    outcome = run(*SWEEP, "--out", out)
    assert outcome.code == 1
    assert "it holds a map of sweep workspace" in outcome.err
    assert (out / "done").is_dir()


def test_an_input_is_never_an_output(run, tmp_path):
    from hitjoints.evidence.recordings.hit_files import EXAMPLES

    for file in EXAMPLES.glob("*44.csv"):
        (tmp_path / file.name).write_bytes(file.read_bytes())
    robot, thing = sorted(tmp_path.iterdir(), key=lambda path: path.name.startswith("object"))
    (tmp_path / "link.csv").symlink_to(robot)
    before = {path: path.read_bytes() for path in (robot, thing)}
    for asked in (robot, tmp_path):
        for out in (robot, thing, tmp_path / "link.csv"):
            outcome = run("replay", asked, "--out", out)
            assert outcome.code == 1
            assert "it is read, too" in outcome.err
    assert {path: path.read_bytes() for path in (robot, thing)} == before


def test_no_two_outputs_of_one_name(run, tmp_path):
    grid = ["--x=0.5", "--y=0.3", "--z=0.5", "--samples", "2", "--joint", "6"]
    (tmp_path / "link.svg").symlink_to("a.svg")
    outcome = run("simulate", "--out", tmp_path / "a.csv", "--plot", tmp_path / "a.csv")
    assert "plot = " in outcome.err
    with pytest.raises(InputError, match="written twice"):
        check_apart([(tmp_path / "a.svg", "out"), (tmp_path / "link.svg", "plot")], [])
    assert run("sweep", "workspace", *grid, "--nc", tmp_path / "a.nc").code == 0


def test_names_that_no_file_can_have(run, tmp_path):
    loop = tmp_path / "loop.zarr"
    loop.symlink_to(loop)
    pipe = tmp_path / "pipe.csv"
    os.mkfifo(pipe)
    (tmp_path / "full.csv").symlink_to("/dev/full")
    cases = {
        tmp_path / f"{TOO_LONG}.csv": "name too long",
        tmp_path / TOO_LONG / "a.csv": "name too long",
        loop: "symbolic links",
        loop / "a.csv": "symbolic links",
        pipe: "a device or a pipe",
        tmp_path / "full.csv": "a device or a pipe",
        pipe / "a.csv": "there is no folder",
    }
    for path, words in cases.items():
        outcome = run(*SWEEP, "--out", path)
        assert outcome.code == 1, path
        assert words in outcome.err, (path, outcome.err)
        assert outcome.err.count("\n") == 1
    with pytest.raises(InputError, match="null byte"):
        check_writable(tmp_path / "a\0.csv", "out", (".csv",))


def test_the_longest_name_there_can_be(tmp_path):
    for ending in (".csv", ".nc", ".zarr"):
        path = tmp_path / ("x" * (255 - len(ending)) + ending)
        write_dataset(data(), path)
        assert path.exists()


def test_a_link_is_followed_not_replaced(tmp_path):
    (tmp_path / "there").mkdir()
    (tmp_path / "here.csv").symlink_to("there/a.csv")
    write_dataset(data(), tmp_path / "here.csv")
    assert (tmp_path / "here.csv").is_symlink()
    assert os.listdir(tmp_path / "there") == ["a.csv"]
    (tmp_path / "lost.csv").symlink_to("nowhere/a.csv")
    with pytest.raises(InputError, match="there is no folder"):
        check_writable(tmp_path / "lost.csv", "out", (".csv",))


def test_a_failing_write_leaves_what_was_there(tmp_path):
    path = tmp_path / "a.csv"
    path.write_text("before")

    def fail(made: Path) -> None:
        made.write_text("half")
        raise OSError(28, "No space left on device")

    with pytest.raises(InputError, match="No space left"):
        write_whole(path, "out", fail)
    assert path.read_text() == "before"
    assert os.listdir(tmp_path) == ["a.csv"]


@pytest.mark.parametrize("ending", ["nc", "csv", "zarr"])
def test_a_disk_that_fills_up(tmp_path, ending):
    """A limit on the size of files refuses as a full disk does; the process must end by itself."""
    words = ["sweep", "joint", "--count", "20000", "--out", f"a.{ending}"]
    done = subprocess.run(
        [sys.executable, "-m", "hitjoints.cli", *words],
        check=False,
        cwd=tmp_path,
        capture_output=True,
        text=True,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096)),
        env=os.environ | {"PYTHONDONTWRITEBYTECODE": "1"},
    )
    assert done.returncode == 1, done.stderr
    assert done.stderr.splitlines()[-1].startswith("error: ")
    assert "File too large" in done.stderr
    assert not list(tmp_path.glob("[.a]*"))


@pytest.mark.parametrize("at", range(0, 40, 3))
def test_hdf5_outlives_a_refusal_at_any_write(tmp_path, monkeypatch, at):
    """The disk is full from the given write on; HDF5 notices nothing, the caller all."""
    import io

    written = []

    class Disk(io.FileIO):
        def write(self, view):
            written.append(len(view))
            if len(written) > at:
                raise OSError(28, "No space left on device")
            return super().write(view)

    class Patient(PatientFile, Disk):
        pass

    with Patient(tmp_path / "a.nc") as patient:
        try:
            with h5netcdf.File(patient, "w") as file:
                file.dimensions = {"x": 50_000}
                for i in range(10):
                    file.create_variable(f"v{i}", ("x",), float)[...] = i
        except Exception:  # HDF5 misses what it wrote; what is told is the refusal
            assert len(written) > at
        if len(written) > at:
            with pytest.raises(OSError, match="No space"):
                patient.settle()


def test_netcdf_reads_back(tmp_path):
    dataset = xr.Dataset(
        {"v": (("x", "y"), np.random.default_rng(0).normal(size=(7, 3)))},
        coords={"x": np.arange(7)},
        attrs={"flag": True, "list": [1.5, 2.0], "nested": [[1, 2]]},
    )
    write_dataset(dataset, tmp_path / "a.nc")
    again = xr.open_dataset(tmp_path / "a.nc", engine="h5netcdf")
    np.testing.assert_array_equal(again.v, dataset.v)
    assert again.attrs["flag"] == 1
    assert again.attrs["nested"] == "[[1, 2]]"


@pytest.mark.parametrize("ending", ["nc", "csv", "zarr"])
def test_a_replay_without_a_usable_file_is_written(run, tmp_path, ending):
    outcome = run("replay", tmp_path / "nothing_hit_1.csv", "--out", tmp_path / f"o.{ending}")
    assert outcome.code == 1
    assert "no file could be used" in outcome.err
    assert (tmp_path / f"o.{ending}").exists()


def test_a_request_to_end_leaves_no_scratch(tmp_path):
    """SIGTERM while an output is written: one line, and nothing beside it."""
    program = """
import os, signal, sys, threading, time
from hitjoints.cli import main
import hitjoints.datasets.files as files

def write(dataset, path):
    path.write_text("half")
    threading.Timer(0.1, os.kill, (os.getpid(), signal.SIGTERM)).start()
    time.sleep(30)

files.write_csv = write
main()
"""
    done = subprocess.run(
        [sys.executable, "-c", program, *SWEEP, "--out", "a.csv"],
        check=False,
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=60,
    )
    assert done.stderr == "error: terminated; nothing was written\n"
    assert done.returncode == 128 + 15
    assert os.listdir(tmp_path) == []
