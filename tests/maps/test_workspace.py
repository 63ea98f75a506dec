"""Workspace maps: their numbers against single-configuration quantities, and their stores."""

import hashlib
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import hitjoints as hj
from hitjoints.errors import InputError
from hitjoints.maps.grid import make_grid
from hitjoints.maps.workspace import best_joint

AXES = (np.linspace(-0.3, 0.9, 5), np.linspace(-0.6, 0.6, 4), [0.3, 0.6])
H = np.array([[0.0, 1.0, 0.0], [1.0, 1.0, 0.0]])


@pytest.fixture(scope="module")
def robot():
    return hj.load_robot("iiwa14")


@pytest.fixture(scope="module")
def swept(robot):
    return hj.sweep_workspace(robot, *AXES, H, 2.0, samples=30, seed=3)


def test_dimensions_units_and_origin(swept, robot):
    assert dict(swept.sizes) == {
        "joint": 3, "direction": 2, "x": 5, "y": 4, "z": 2, "axis": 7, "xyz": 3
    }  # fmt: skip
    assert all("units" in swept[name].attrs for name in swept.variables)
    assert swept.attrs["robot_digest"] == robot.digest
    np.testing.assert_allclose(np.linalg.norm(swept.direction_vector, axis=1), 1)
    assert {"inertia", "speed", "flux", "reachable", "away"} <= set(swept.data_vars)


def test_the_best_configuration_gives_the_numbers_beside_it(swept, robot):
    checked = 0
    for k in swept.joint.values:
        for d in swept.direction.values:
            for x, y, z in np.ndindex(5, 4, 2):
                cell = swept.sel(joint=k, direction=d).isel(x=x, y=y, z=z)
                if not float(cell.reachable):
                    assert np.isnan(cell.flux)
                    assert np.isnan(cell.q).all()
                    continue
                q, h = cell.q.values, cell.direction_vector.values
                at = [float(cell.x), float(cell.y), float(cell.z)]
                np.testing.assert_allclose(hj.position(robot, q, int(k)), at, atol=2e-9)
                assert (q >= robot.lower).all()
                assert (q <= robot.upper).all()
                inertia = hj.directional_inertia(robot, q, int(k), h)
                speed = hj.hitting_speed(robot, q, int(k), h)
                straight = hj.hitting_speed(robot, q, int(k), h, straight=True)
                assert float(cell.inertia) == pytest.approx(inertia, rel=1e-9)
                assert float(cell.speed) == pytest.approx(speed, rel=1e-9)
                assert float(cell.flux) == pytest.approx(hj.hitting_flux(inertia, 2.0, speed))
                assert float(cell.straight_speed) == pytest.approx(straight, rel=1e-6)
                checked += 1
    assert checked > 50


def test_statistics_are_ordered(swept):
    reached = swept.reachable > 0
    assert bool(reached.any())
    assert not bool(reached.all())
    assert bool(((swept.inertia_min <= swept.inertia_median) | ~reached).all())
    assert bool(((swept.inertia_median <= swept.inertia_max) | ~reached).all())
    assert bool(((swept.flux_median <= swept.flux) | ~reached).all())
    assert bool(((swept.speed <= swept.speed_max) | ~reached).all())
    assert bool(((swept.straight_speed <= swept.speed * (1 + 1e-9)) | ~reached).all())
    assert bool(((swept.away_flux <= swept.flux) | (swept.away != 1)).all())


def test_samples_against_a_plain_loop(robot):
    """The statistics of a cell from its samples, by other code: place_joint and a loop."""
    at = np.array([0.5, 0.3, 0.5])
    cell = hj.sweep_workspace(robot, [at[0]], [at[1]], [at[2]], H[0], 2.0, joints=[6], samples=40)
    placed = hj.place_joint(robot, 6, np.tile(at, (40, 1)), seed=0)
    inertia = [hj.directional_inertia(robot, q, 6, H[0]) for q in placed.q]
    speed = [hj.hitting_speed(robot, q, 6, H[0]) for q in placed.q]
    flux = hj.hitting_flux(inertia, 2.0, speed)
    away = [(hj.position(robot, q, 7) - hj.position(robot, q, 6)) @ H[0] < 0 for q in placed.q]
    expected = {
        "inertia_min": min(inertia),
        "inertia_median": np.median(inertia),
        "inertia_max": max(inertia),
        "flux": flux.max(),
        "flux_median": np.median(flux),
        "away": float(any(away)),
        "away_flux": flux[away].max(),
    }
    for name, value in expected.items():
        assert float(cell[name].squeeze()) == pytest.approx(value, rel=1e-9), name


def test_best_joint(swept):
    best = best_joint(swept)
    some = swept.flux.notnull().any("joint")
    assert bool((best.notnull() == some).all())
    picked = swept.flux.sel(joint=best.where(some, 6).astype(int))
    assert bool(((picked == swept.flux.max("joint")) | ~some).all())


@pytest.mark.parametrize("threads", [1, 2])
def test_threads_and_blocks_do_not_matter(robot, swept, monkeypatch, threads):
    import hitjoints.maps.workspace as module

    monkeypatch.setattr(module, "POSITIONS_PER_BLOCK", 7)
    again = hj.sweep_workspace(robot, *AXES, H, 2.0, samples=30, seed=3, threads=threads)
    xr.testing.assert_identical(again.drop_attrs(), swept.drop_attrs())


def test_grid_blocks_cover_every_position_once():
    grid = make_grid(np.arange(7), np.arange(5), np.arange(3), 8)
    numbers = np.concatenate([grid.positions(index)[1] for index in grid.indices()])
    assert sorted(numbers) == list(range(7 * 5 * 3))
    positions = np.concatenate([grid.positions(index)[0] for index in grid.indices()])
    expected = np.stack(np.unravel_index(numbers, grid.shape), axis=1)
    np.testing.assert_array_equal(positions, expected)


def fingerprint(store: Path) -> dict[str, str]:
    return {
        str(path.relative_to(store)): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in sorted(store.rglob("*"))
        if path.is_file()
    }


LIMIT = 300  # s, for any process here
ARGUMENTS = [
    "sweep", "workspace", "--x=-0.9:0.9:40", "--y=-0.9:0.9:40", "--z=0.1:0.9:10", "--samples", "30",
    "--threads", "1", "--out", "map.zarr", "--json",
]  # fmt: skip


def command(folder: Path) -> subprocess.Popen[bytes]:
    words = [sys.executable, "-m", "hitjoints.cli", *ARGUMENTS]
    return subprocess.Popen(words, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE)


def test_killed_runs_continue_to_the_same_store(tmp_path):
    whole, broken = tmp_path / "whole", tmp_path / "broken"
    whole.mkdir()
    broken.mkdir()
    process = command(whole)
    process.communicate(timeout=LIMIT)
    assert process.returncode == 0
    kills = 0
    for blocks in (0, 1, 3):
        process = command(broken)
        # Kill as soon as so many blocks are marked, wherever in the next one it then is.
        end = time.monotonic() + LIMIT
        while process.poll() is None and time.monotonic() < end:
            done = len(list((broken / "map.zarr" / "done").glob("c/*/*/*")))
            if (broken / "map.zarr" / "zarr.json").exists() and done > blocks:
                os.kill(process.pid, signal.SIGKILL)
            time.sleep(0.002)
        kills += process.returncode == -signal.SIGKILL
        process.communicate(timeout=LIMIT)
    assert kills == 3
    process = command(broken)
    process.communicate(timeout=LIMIT)
    assert process.returncode == 0
    assert fingerprint(broken / "map.zarr") == fingerprint(whole / "map.zarr")


def test_a_finished_store_is_not_computed_again(robot, tmp_path, monkeypatch):
    out = tmp_path / "map.zarr"
    first = hj.sweep_workspace(robot, *AXES, H, 2.0, samples=5, out=out).load()
    monkeypatch.setattr("hitjoints.maps.schedule.evaluate", lambda *_: pytest.fail("computed"))
    xr.testing.assert_identical(
        hj.sweep_workspace(robot, *AXES, H, 2.0, samples=5, out=out).load(), first
    )


def test_another_map_is_refused(robot, tmp_path):
    out = tmp_path / "map.zarr"
    hj.sweep_workspace(robot, *AXES, H, 2.0, samples=2, out=out)
    for change in ({"samples": 3}, {"seed": 1}):
        with pytest.raises(InputError, match=f"another {next(iter(change))}"):
            hj.sweep_workspace(robot, *AXES, H, 2.0, **({"samples": 2} | change), out=out)
    with pytest.raises(InputError, match="another offsets, joints"):
        hj.sweep_workspace(robot, *AXES, H, 2.0, samples=2, joints=[6], out=out)
    with pytest.raises(InputError, match="another mass"):
        hj.sweep_workspace(robot, *AXES, H, 1.0, samples=2, out=out)
    with pytest.raises(InputError, match="another title, robot, robot_digest"):
        hj.sweep_workspace(hj.load_robot("iiwa7"), *AXES, H, 2.0, samples=2, out=out)
    other = tmp_path / "other.zarr"
    other.mkdir()
    (other / "notes.txt").write_text("mine")
    with pytest.raises(InputError, match="not a map of hitjoints"):
        hj.sweep_workspace(robot, *AXES, H, 2.0, samples=2, out=other)
    assert (other / "notes.txt").read_text() == "mine"


def test_memory_is_that_of_a_block_not_of_the_map(robot, monkeypatch, tmp_path):
    """Peak memory traced by tracemalloc, of a map and of one 8 times as large."""
    import tracemalloc

    import hitjoints.maps.workspace as module

    monkeypatch.setattr(module, "POSITIONS_PER_BLOCK", 100)

    def peak(count: int) -> int:
        axes = np.linspace(0.4, 0.5, 10), np.linspace(-0.2, 0.2, 10), np.linspace(0.4, 0.6, count)
        tracemalloc.start()
        hj.sweep_workspace(
            robot, *axes, H[0], 2.0, joints=[6], samples=1000, out=tmp_path / f"{count}.zarr"
        )
        _, top = tracemalloc.get_traced_memory()
        tracemalloc.stop()
        return top

    peak(1)
    assert peak(16) < 1.2 * peak(2)


def test_dask_cluster_with_a_killed_worker(robot, tmp_path):
    distributed = pytest.importorskip("distributed")
    x, y, z = np.linspace(-0.9, 0.9, 40), np.linspace(-0.9, 0.9, 40), [0.3, 0.5, 0.7]
    here = hj.sweep_workspace(robot, x, y, z, H[0], 2.0, samples=20).load()
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None
    ) as cluster:
        victims = [worker.pid for worker in cluster.workers.values()]
        killed = []

        def progress(done: int, total: int) -> None:
            if not killed and done < total:
                killed.append(victims[0])
                os.kill(victims[0], signal.SIGKILL)

        there = hj.sweep_workspace(
            robot, x, y, z, H[0], 2.0, samples=20,
            scheduler=cluster.scheduler_address, progress=progress, out=tmp_path / "map.zarr",
        )  # fmt: skip
        assert killed
        xr.testing.assert_identical(there.load().drop_attrs(), here.drop_attrs())


def test_no_scheduler_answers(robot, monkeypatch):
    pytest.importorskip("distributed")
    monkeypatch.setattr("hitjoints.maps.schedule.CONNECT_TIMEOUT", 0.2)
    with pytest.raises(InputError, match="no Dask scheduler"):
        hj.sweep_workspace(
            robot, *AXES, H[0], 2.0, samples=2, scheduler="tcp://127.0.0.1:9", joints=[6]
        )
