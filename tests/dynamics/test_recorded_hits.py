"""Four recorded hits of real arms (epfl-lasa/air_hockey): kinematics and flux agree with them.

The recorder's inertia is not compared: it comes from another model, with an inertia at the flange
that these robots do not have. Its flux is a function of its inertia, which is checked.
"""

import numpy as np
import pytest

from hitjoints.dynamics.kinematics import jacobian, position
from hitjoints.impact.collision import hitting_flux
from hitjoints.model.robot import Contact

HITS = ["iiwa14_hit_a", "iiwa14_hit_b", "iiwa7_hit_a", "iiwa7_hit_b"]
ROBOTS = {"IIWA_14": "iiwa14", "IIWA_7": "iiwa7"}


def column(rows, name):
    return np.array([row[name] for row in rows])


@pytest.fixture(params=HITS)
def hit(request, hits):
    return hits[request.param]


def test_all_hits_are_here(hits):
    assert sorted(hits) == sorted(HITS)
    assert all(hit["source"]["repo"] == "epfl-lasa/air_hockey" for hit in hits.values())


def test_rows_are_consecutive(hit):
    np.testing.assert_allclose(np.diff(column(hit["robot_rows"], "RosTime")), 0.005, atol=2e-4)


def test_kinematics(hit, arm):
    """The end-effector columns lag the joint columns by one or two samples."""
    robot, tool = arm(ROBOTS[hit["robot"]]), Contact(7, tuple(hit["tool_offset_m"]))
    assert tool.offset == (0, 0, 0.150)
    lag, rows = hit["eef_signal_lag_samples"], hit["robot_rows"]
    assert lag in (1, 2)
    joint_rows, tool_rows = rows[:-lag], rows[lag:]
    assert len(joint_rows) >= 9
    q, qd = (column(joint_rows, name) for name in ("JointPosition", "JointVelocity"))
    places = [position(robot, row, tool) for row in q]
    speeds = [jacobian(robot, row, tool) @ rate for row, rate in zip(q, qd, strict=True)]
    np.testing.assert_allclose(places, column(tool_rows, "EEF_Position"), rtol=0, atol=1e-6)
    np.testing.assert_allclose(speeds, column(tool_rows, "EEF_Velocity"), rtol=0, atol=1e-6)


def test_joints_stay_within_the_limits(hit, arm):
    robot = arm(ROBOTS[hit["robot"]])
    for row in hit["robot_rows"]:
        robot.within_limits(row["JointPosition"])


def test_flux(hit):
    """HittingFlux is lambda / (lambda + m_o) |v| with lambda = 1 / Inertia_yy."""
    rows = hit["robot_rows"]
    matrices = column(rows, "Inertia").reshape(-1, 3, 3)
    inertia = 1 / matrices[:, 1, 1]
    speed = np.linalg.norm(column(rows, "EEF_Velocity"), axis=1)
    found = hitting_flux(inertia, hit["object_mass_kg"], speed)
    np.testing.assert_allclose(found, column(rows, "HittingFlux"), rtol=0, atol=1e-5)
    assert found.max() > 0.5
