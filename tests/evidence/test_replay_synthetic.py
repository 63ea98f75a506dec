"""Recordings of hits that are known exactly: what replay finds in them.

Tolerances: a latch of 1/360 s moves the slope of a line over 40 ms by up to 4 %, and a contact is
known to about one row of 5 ms.
"""

import statistics

import numpy as np
import pytest
import xarray as xr

import hitjoints as hj
from benchmarks.recordings import measure, write_recordings
from hitjoints.datasets.files import write_dataset
from hitjoints.evidence.recordings.dataset import NUMBERS, TEXTS, hits_dataset
from tests.oracles.synthetic_recordings import GRAVITY, Truth, write_recording

ROW, LATCH = 0.005, 0.04
TRUTHS = [
    Truth(robot="iiwa7", push=0.0, friction=0.0, lag=0, noise=0.0, seed=1),
    Truth(robot="iiwa14", push=0.0, friction=0.15, lag=5, seed=2),
    Truth(robot="iiwa7", push=0.02, friction=0.15, lag=2, seed=3),
    Truth(robot="iiwa14", push=0.02, friction=0.3, lag=1, restitution=0.7, seed=4),
    Truth(robot="iiwa14", push=0.015, speed=0.4, restitution=0.9, lag=3, seed=5),
    Truth(robot="iiwa7", push=0.025, mass=1.915, restitution=0.0, speed=1.2, seed=6),
]


@pytest.fixture(scope="module", params=range(len(TRUTHS)))
def case(request, tmp_path_factory):
    """Return what is true, what was written and what was found."""
    truth, folder = TRUTHS[request.param], tmp_path_factory.mktemp("hits")
    written = write_recording(folder, 3, truth)
    (hit,) = hj.replay(folder).hits
    return truth, written, hit


def test_robot(case):
    truth, written, hit = case
    assert hit.ok
    assert hit.robot == truth.robot
    assert hit.lag == truth.lag
    assert hit.position_error < 1e-12
    assert hit.velocity_error < 1e-12
    assert hit.mass == pytest.approx(truth.mass, rel=1e-9)
    assert hit.recorded_flux_error < 1e-12
    assert hit.inertia == pytest.approx(written.inertia, rel=0.02)  # one row later
    assert hit.robot_speed == pytest.approx(truth.speed, rel=0.005)
    assert hit.flux == pytest.approx(written.flux, rel=0.01)
    assert hit.desired_flux == 0.7


def test_contact(case):
    truth, _, hit = case
    assert hit.contact_time == pytest.approx(truth.contact, abs=1.2 * ROW)
    assert hit.hit_time_delay == pytest.approx(0.05, abs=1.2 * ROW)
    assert hit.contact_source == "object"


def test_object(case):
    truth, written, hit = case
    late = hit.contact_time + hit.object_time - truth.contact
    expected = written.object_speed - truth.friction * GRAVITY * late
    assert hit.object_speed == pytest.approx(expected, rel=LATCH)
    assert hit.object_direction_error < 3
    assert hit.travel == pytest.approx(written.travel, abs=3e-3)
    if truth.friction:
        assert hit.came_to_rest
        assert hit.friction == pytest.approx(truth.friction, rel=0.08)
    else:
        assert not hit.came_to_rest
        assert hit.friction is None
        assert "does not stand out" in hit.reason


def test_restitution(case):
    """With what friction takes until object_time given back: it may be a half of it."""
    truth, _, hit = case
    found = hit.restitution_at_contact if truth.friction else hit.restitution
    assert found == pytest.approx(truth.restitution, abs=LATCH * (1 + truth.restitution))
    if truth.friction:
        assert hit.restitution < truth.restitution - 0.05


def test_momentum_balance_of_a_robot_that_does_not_push(case):
    """With no controller it is nearly the inertia: exactly so in what was written."""
    truth, written, hit = case
    lost = truth.speed - written.robot_speed_after
    assert truth.mass * written.object_speed / lost == pytest.approx(written.inertia)
    # Within 25 ms the arm has moved on by 2 cm, and the speed of the tool with it.
    assert hit.robot_speed - hit.robot_speed_after == pytest.approx(lost, abs=0.015)
    assert hit.momentum_ratio == pytest.approx(1, abs=0.15)


def test_without_the_object_the_robot_tells_the_contact(case):
    truth, written, hit = case
    path = written.object_file
    text = path.read_text()
    path.unlink()
    try:
        (alone,) = hj.replay(written.file).hits
    finally:
        path.write_text(text)
    assert alone.ok
    assert alone.contact_source == "robot"
    assert alone.contact_time == pytest.approx(truth.contact, abs=2 * ROW)
    assert alone.robot_speed == pytest.approx(hit.robot_speed, rel=0.03)
    assert alone.object_speed is alone.restitution is alone.travel is None
    assert "no file object_*_hit_3.csv beside it" in alone.reason


def test_sliding_to_the_end_of_the_recording(tmp_path):
    """Friction by the deceleration: the object is still moving when the recording ends."""
    truth = Truth(restitution=0.9, friction=0.1, duration=1.1, seed=3)
    write_recording(tmp_path, 1, truth)
    (hit,) = hj.replay(tmp_path).hits
    assert not hit.came_to_rest
    assert hit.friction == pytest.approx(0.1, rel=0.05)


def test_another_direction_is_refused_by_what_the_object_does(tmp_path):
    write_recording(tmp_path, 1, Truth())
    (hit,) = hj.replay(tmp_path, direction=[0, 1, 0]).hits
    assert not hit.ok
    assert "the object moves against the hitting direction" in hit.reason


@pytest.fixture(scope="module")
def twenty(tmp_path_factory):
    folder = tmp_path_factory.mktemp("many")
    write_recordings(folder, 20)
    steps = []
    result = hj.replay(folder, progress=lambda done, total: steps.append((done, total)))
    return result, steps


def test_many(twenty):
    result, steps = twenty
    assert len(result.usable) == len(result.hits) == 20
    assert steps == [(i, 20) for i in range(1, 21)]
    assert {hit.robot for hit in result.hits} == {"iiwa7", "iiwa14"}


def test_each_is_predicted_by_the_others(twenty):
    hits = twenty[0].hits
    for i, hit in enumerate(hits):
        others = [other.restitution for j, other in enumerate(hits) if j != i]
        assert hit.assumed_restitution == pytest.approx(statistics.median(others))


@pytest.mark.parametrize("ending", ["zarr", "nc"])
def test_dataset(twenty, tmp_path, ending):
    result, _ = twenty
    path = tmp_path / f"hits.{ending}"
    write_dataset(result.dataset, path)
    read = xr.open_zarr(path, consolidated=False) if ending == "zarr" else xr.open_dataset(path)
    assert set(read.data_vars) >= {*NUMBERS, *TEXTS, "inertia_along", "gradient"}
    assert read.sizes == {"hit": 20, "row": 300, "axis": 7}
    for i, hit in enumerate(result.hits):
        assert str(read.file.values[i]) == hit.file
        assert float(read.flux[i]) == hit.flux
        now = np.interp(0.0, read.time[i], read.inertia_along[i])
        assert now == pytest.approx(hit.inertia)
    assert all(read[name].attrs["units"] for name in NUMBERS)


def test_a_table_has_a_line_per_hit(twenty, tmp_path):
    path = tmp_path / "hits.csv"
    write_dataset(hits_dataset(twenty[0].hits, along=False), path)
    assert len(path.read_text().splitlines()) == 21


def test_the_same_again(twenty, tmp_path):
    write_recordings(tmp_path, 20)
    for one, other in zip(twenty[0].hits, hj.replay(tmp_path).hits, strict=True):
        first, second = one.as_dict(), other.as_dict()
        for name in ("file", "object_file"):
            del first[name], second[name]
        assert first == second


def test_the_benchmark_measures_the_command():
    spent, rate = measure(20)
    assert spent.value < 60
    assert rate.value == pytest.approx(20 / spent.value)
