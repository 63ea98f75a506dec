"""The recorder's lag, where a dropped message makes it step."""

import numpy as np
import pytest

from hitjoints.evidence.recordings.alignment import find_lag


def way(rows=200):
    """A tool that stands, runs and stands again, as the model has it."""
    time = np.linspace(0, 1, rows)
    speed = np.exp(-(((time - 0.5) / 0.12) ** 2))
    along = np.cumsum(speed) * 5e-3
    return np.column_stack([0.5 + 0.1 * along, along, 0.3 - 0.2 * along**2])


def recorded_with(model, lags):
    return model[np.maximum(0, np.arange(len(model)) - lags)]


def test_one_lag_as_ever():
    model = way()
    found = find_lag(model, recorded_with(model, np.full(200, 2)))
    assert (found.rows, found.steps, found.greatest) == (2, (), 0.0)
    np.testing.assert_array_equal(found.aligned(model), model[2:])


@pytest.mark.parametrize("before", [1, 3])
@pytest.mark.parametrize("at", [80, 100, 117])
def test_a_step_is_found_where_it_is(before, at):
    model = way()
    lags = np.where(np.arange(200) < at, before, 2)
    recorded = recorded_with(model, lags)
    found = find_lag(model, recorded)
    assert found.greatest == 0.0
    assert [step.lag for step in found.steps] == [2]
    assert abs(found.steps[0].row - at) <= 1
    moved = found.aligned(recorded)
    np.testing.assert_allclose(moved[found.known], model[: len(moved)][found.known], atol=1e-15)
    np.testing.assert_allclose(moved, model[: len(moved)], atol=2e-4)


def test_there_and_back():
    model = way()
    lags = np.where((np.arange(200) >= 85) & (np.arange(200) < 115), 2, 1)
    found = find_lag(model, recorded_with(model, lags))
    assert [step.lag for step in found.steps] == [2, 1]
    assert found.rows == 1
    assert found.greatest == 0.0


def test_noise_makes_no_steps():
    random = np.random.default_rng(0)
    model = way()
    for noise in (1e-5, 1e-4, 1e-3, 5e-3):
        recorded = recorded_with(model, np.full(200, 1)) + random.normal(0, noise, (200, 3))
        found = find_lag(model, recorded)
        assert (found.rows, found.steps) == (1, ())


def test_another_robots_way_makes_no_steps():
    model = way()
    found = find_lag(model, 1.1 * recorded_with(model, np.full(200, 2)) + 0.05)
    assert found.steps == ()
    assert found.median > 1e-2


@pytest.mark.parametrize("rows", [3, 4, 6, 9])
def test_short_recordings(rows):
    model = np.cumsum(np.ones((rows, 3)), axis=0)
    found = find_lag(model, recorded_with(model, np.full(rows, 1)))
    assert (found.rows, found.greatest) == (1, 0.0)


def test_a_step_is_reported(tmp_path, run):
    """A published recording whose recorder drops a row in the middle of the motion."""
    from hitjoints.evidence.recordings.hit_files import EXAMPLES

    robot, thing = "IIWA_14_hit_10.csv", "object_1_hit_10.csv"
    (tmp_path / thing).write_text((EXAMPLES / thing).read_text())
    lines = (EXAMPLES / robot).read_text().splitlines()
    header = lines[1].split(",")
    own = [header.index(name) for name in header if name.startswith(("EEF", "Inertia", "DirGrad"))]
    own.append(header.index("HittingFlux"))
    rows = [line.split(",") for line in lines[2:]]
    late = [list(row) for row in rows]
    for i in range(7, len(rows)):
        for column in own:
            late[i][column] = rows[i - 1][column]
    text = "\n".join([*lines[:2], *(",".join(row) for row in late)]) + "\n"
    (tmp_path / robot).write_text(text)
    (hit,) = run("replay", tmp_path, "--json").json["hits"]
    assert hit["position_error"] < 1e-6
    assert [lag for _, lag in hit["lag_steps"]] == [3]
    assert "lag: it steps within the recording" in hit["reason"]
