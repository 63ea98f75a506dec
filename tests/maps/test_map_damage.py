"""Stores of maps: two runs at once, damage of every kind, and what is refused."""

import hashlib
import random
import shutil
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from threading import Barrier

import numpy as np
import pytest
import xarray as xr

import hitjoints as hj
from hitjoints.datasets.lock import locked
from hitjoints.errors import InputError
from hitjoints.maps.map_kinds import WORKSPACE

AXES = (np.linspace(-0.3, 1.5, 5), np.linspace(-0.6, 0.6, 4), [0.3, 0.6])
H = np.array([0.0, 1.0, 0.0])


@pytest.fixture(scope="module")
def robot():
    return hj.load_robot("iiwa14")


@pytest.fixture(autouse=True)
def small_blocks(monkeypatch):
    monkeypatch.setattr("hitjoints.maps.workspace.POSITIONS_PER_BLOCK", 6)


def sweep(robot, out, **options):
    given = {"samples": 3, "joints": [5, 6], "threads": 1} | options
    return hj.sweep_workspace(robot, *AXES, H, 2.0, out=out, **given)


@pytest.fixture(scope="module")
def whole(robot, tmp_path_factory):
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("hitjoints.maps.workspace.POSITIONS_PER_BLOCK", 6)
        out = tmp_path_factory.mktemp("whole") / "map.zarr"
        sweep(robot, out)
    return out


def fingerprint(store: Path) -> dict[str, str]:
    return {
        str(path.relative_to(store)): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in sorted(store.rglob("*"))
        if path.is_file()
    }


def test_runs_at_once(robot, whole, tmp_path):
    """One of them writes, the others are refused or find it done; the store is as if alone."""
    refused = 0
    for race in range(6):
        out = tmp_path / f"{race}.zarr"
        barrier = Barrier(2)

        def run(_: int, out: Path = out, barrier: Barrier = barrier) -> str:
            barrier.wait()
            try:
                sweep(robot, out)
            except InputError as error:
                return str(error)
            return ""

        with ThreadPoolExecutor(2) as pool:
            said = list(pool.map(run, range(2)))
        assert "" in said
        assert set(said) <= {"", f"out = {out}: another run is writing it"}
        refused += sum(map(bool, said))
        assert fingerprint(out) == fingerprint(whole)
    assert refused > 0
    assert len(list(tmp_path.iterdir())) == 6


def test_a_map_that_is_being_written_is_refused(robot, whole, tmp_path):
    out = shutil.copytree(whole, tmp_path / "map.zarr")
    with locked(out), pytest.raises(InputError, match="another run is writing it"):
        sweep(robot, out)
    sweep(robot, out)


def chunks(store: Path, names=(*WORKSPACE.blockwise, "done")) -> list[Path]:
    return [p for name in names for p in sorted((store / name / "c").rglob("*")) if p.is_file()]


def flip(path: Path) -> None:
    data = bytearray(path.read_bytes())
    data[random.Random(len(data)).randrange(len(data))] ^= 0x10
    path.write_bytes(data)


DAMAGE = {
    "deleted": Path.unlink,
    "emptied": lambda path: path.write_bytes(b""),
    "cut short": lambda path: path.write_bytes(path.read_bytes()[:-3]),
    "noise": lambda path: path.write_bytes(b"noise" * 20),
    "one bit": flip,
    "a folder": lambda path: (path.unlink(), path.mkdir()),
}


@pytest.mark.parametrize("kind", DAMAGE)
def test_damaged_blocks_are_computed_again(robot, whole, tmp_path, kind):
    out = shutil.copytree(whole, tmp_path / "map.zarr")
    hurt = random.Random(kind).sample(chunks(out), 12)
    for path in hurt:
        DAMAGE[kind](path)
    with pytest.raises(InputError, match=r"blocks of this map are missing or damaged.*sweep_work"):
        hj.open_map(out)
    if kind == "a folder":
        for path in hurt:
            path.rmdir()
    xr.testing.assert_identical(sweep(robot, out).load(), hj.open_map(whole).load())
    # A bit of a chunk can be one that zstd does not use: then its values were never wrong.
    assert kind == "one bit" or fingerprint(out) == fingerprint(whole)


def test_each_chunk_counts(robot, whole, tmp_path):
    """No chunk can go without being missed."""
    hj.open_map(whole)
    for path in random.Random(0).sample(chunks(whole), 10):
        kept = path.read_bytes()
        path.unlink()
        try:
            with pytest.raises(InputError, match="1 blocks of this map"):
                hj.open_map(whole)
        finally:
            path.write_bytes(kept)


@pytest.mark.parametrize(
    "inside",
    ["flux/zarr.json", "q/zarr.json", "done/zarr.json", "x/zarr.json", "x/c/0", "joint/c/0",
     "direction_vector/c/0/0"],
)  # fmt: skip
@pytest.mark.parametrize("kind", ["deleted", "emptied", "noise"])
def test_damaged_descriptions_are_refused_by_name(robot, whole, tmp_path, inside, kind):
    out = shutil.copytree(whole, tmp_path / "map.zarr")
    DAMAGE[kind](out / inside)
    name = inside.partition("/")[0]
    for use in (hj.open_map, lambda path: sweep(robot, path)):
        with pytest.raises(InputError, match=f"{name} of this map is missing or damaged"):
            use(out)


@pytest.mark.parametrize("text", ["", "[]", "{}", '{"attributes": 3}', '{"attributes": {}}', "["])
def test_a_group_of_another_program_is_refused(robot, whole, tmp_path, text):
    out = shutil.copytree(whole, tmp_path / "map.zarr")
    (out / "zarr.json").write_text(text)
    for use in (hj.open_map, lambda path: sweep(robot, path)):
        with pytest.raises(InputError, match="not a map of hitjoints"):
            use(out)
    assert len(chunks(out)) == len(chunks(whole))


def test_files_of_others_in_a_map_stay(robot, whole, tmp_path):
    out = shutil.copytree(whole, tmp_path / "map.zarr")
    (out / "thesis.partial").write_text("mine")
    (out / "flux" / "c" / "thesis.partial").write_text("mine")
    scratch = out / "flux" / "c" / "0" / f"0.{'a' * 32}.partial"
    scratch.write_text("half a chunk")
    sweep(robot, out)
    assert (out / "thesis.partial").exists()
    assert (out / "flux" / "c" / "thesis.partial").exists()
    assert not scratch.exists()


def test_an_empty_folder_is_filled(robot, whole, tmp_path):
    out = tmp_path / "map.zarr"
    out.mkdir()
    sweep(robot, out)
    assert fingerprint(out) == fingerprint(whole)


def test_in_memory_and_on_disk_agree(robot, whole, tmp_path, monkeypatch):
    monkeypatch.setenv("TMPDIR", str(tmp_path / "nowhere"))
    xr.testing.assert_identical(sweep(robot, None), hj.open_map(whole).load())


def test_a_disk_that_fills_up_while_a_map_grows(robot, whole, tmp_path, monkeypatch):
    import zarr

    out, write, room = tmp_path / "map.zarr", zarr.Array.__setitem__, 40

    def refuse(self, *arguments):
        nonlocal room
        room -= 1
        if room < 0:
            raise OSError(28, "No space left on device")
        write(self, *arguments)

    monkeypatch.setattr(zarr.Array, "__setitem__", refuse)
    with pytest.raises(InputError, match="No space left"):
        sweep(robot, out)
    with pytest.raises(InputError, match="blocks of this map are missing"):
        hj.open_map(out)
    monkeypatch.undo()
    monkeypatch.setattr("hitjoints.maps.workspace.POSITIONS_PER_BLOCK", 6)
    sweep(robot, out)
    assert fingerprint(out) == fingerprint(whole)
