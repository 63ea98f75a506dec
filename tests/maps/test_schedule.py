"""Where blocks are computed, and what ends them early."""

import _thread
import signal
import threading
import time

import numpy as np
import pytest

import hitjoints as hj
from hitjoints.errors import InputError
from hitjoints.maps.cells import Question, StoppedError, evaluate
from hitjoints.maps.grid import make_grid
from hitjoints.maps.schedule import run_blocks

H = np.array([[0.0, 1.0, 0.0]])


def question(samples):
    robot = hj.load_robot("iiwa14")
    return Question(robot, (hj.Contact(6),), H, 2.0, samples, 0)


def test_who_asks_for_no_more_blocks_does_not_wait():
    """One block takes a moment, the other for ever: closing the generator ends both."""
    asked = question(200_000)
    grid = make_grid([0.3, 0.4, 0.5], [0.3], np.linspace(0.3, 0.6, 500), 500)
    blocks = run_blocks(asked, grid, [(0, 0, 0), (1, 0, 0), (2, 0, 0)], threads=1)
    # The tests may run where Ctrl-C is ignored.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        threading.Timer(0.5, _thread.interrupt_main).start()
        begun = time.monotonic()
        with pytest.raises(KeyboardInterrupt):
            next(blocks)
    finally:
        signal.signal(signal.SIGINT, before)
    blocks.close()
    assert time.monotonic() - begun < 20


def test_evaluation_stops_when_nobody_waits():
    with pytest.raises(StoppedError):
        evaluate(question(10), np.full((3, 3), 0.4), np.arange(3), stopped=lambda: True)


@pytest.mark.parametrize("how", ["cluster", "workers"])
def test_a_cluster_that_goes_away(tmp_path, how):
    distributed = pytest.importorskip("distributed")
    robot = hj.load_robot("iiwa14")
    x = np.linspace(-0.9, 0.9, 60)
    grid = (x, x, [0.3, 0.5])
    cluster = distributed.LocalCluster(
        n_workers=1, threads_per_worker=1, processes=True, dashboard_address=None
    )
    with cluster:
        address = cluster.scheduler_address

        def progress(done: int, total: int) -> None:
            if cluster.status.name != "running" or done == total:
                return
            if how == "cluster":
                cluster.close()
            else:
                cluster.scale(0)

        with pytest.raises(InputError, match="the cluster went away or failed") as told:
            hj.sweep_workspace(
                robot, *grid, H[0], 2.0, joints=[6], samples=20,
                scheduler=address, progress=progress, out=tmp_path / "map.zarr",
            )  # fmt: skip
    assert "\n" not in str(told.value)
    hj.sweep_workspace(robot, *grid, H[0], 2.0, joints=[6], samples=20, out=tmp_path / "map.zarr")
    assert hj.open_map(tmp_path / "map.zarr").sizes["x"] == 60


@pytest.mark.parametrize("address", ["\n", "nowhere", "tcp://nowhere", "tcp://nowhere:port"])
def test_an_address_that_is_none_is_refused_at_once(address):
    pytest.importorskip("distributed")
    begun = time.monotonic()
    with pytest.raises(InputError, match="scheduler"):
        hj.sweep_workspace(
            hj.load_robot("iiwa14"), [0.4], [0.3], [0.5], joints=[6], directions=H, mass=2.0,
            samples=2, scheduler=address,
        )  # fmt: skip
    assert time.monotonic() - begun < 5
