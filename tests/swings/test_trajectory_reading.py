"""A trajectory's file says again what was written."""

import numpy as np
import pytest

from hitjoints.errors import InputError
from hitjoints.export.trajectory import Trajectory, write_trajectory
from hitjoints.export.trajectory_reading import READABLE, read_trajectory


@pytest.fixture
def written():
    rows = np.random.default_rng(0).normal(size=(4, 5, 3))
    notes = {"impact_time": 0.002, "robot": "arm", "hit": {"object": {"mass": 2.0}}}
    time = 0.001 * np.arange(5)
    return Trajectory(("a", "b", "c"), time, *rows, "torques are beyond their limits", notes)


@pytest.mark.parametrize("ending", READABLE)
@pytest.mark.parametrize("why", ["", "torques are beyond their limits"])
def test_what_was_written_is_read(written, tmp_path, ending, why):
    trajectory = Trajectory(written.names, written.time, *written.columns().values(), why,
                            written.notes)  # fmt: skip
    write_trajectory(trajectory, tmp_path / f"t{ending}")
    again = read_trajectory(tmp_path / f"t{ending}")
    assert again.names == trajectory.names
    np.testing.assert_allclose(again.time, trajectory.time, atol=1e-15)
    for name, rows in trajectory.columns().items():
        np.testing.assert_allclose(again.columns()[name], rows, rtol=1e-15)  # CSV has 16 digits
    assert (again.why, again.state, again.notes) == (why, trajectory.state, trajectory.notes)


@pytest.mark.parametrize(
    ("name", "text", "words"),
    [
        ("t.yaml", "points:", "a trajectory is read from .csv, .npz, .json"),
        ("t.csv", "time,q1,qd1,qdd1,tau1\n0,1,2,3\n", "it is no trajectory"),
        ("t.csv", "time,q1,qd1,qdd1,tau1\n0,1,2,3,4\n0,1,2,3,4\n", "its times do not ascend"),
        ("t.csv", "# impact_time: x\ntime,q1,qd1,qdd1,tau1\n0,1,2,3,4\n", "it is no trajectory"),
        ("t.json", "[]", "it is no trajectory"),
        ("t.json", '{"joint_names": ["a"], "points": []}', "it is no trajectory"),
        ("t.npz", "x", "it is no trajectory"),
        ("none.csv", None, "it is no trajectory"),
    ],
)
def test_what_is_none_is_told(tmp_path, name, text, words):
    if text is not None:
        (tmp_path / name).write_text(text)
    with pytest.raises(InputError, match=words):
        read_trajectory(tmp_path / name)
