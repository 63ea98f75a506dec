"""The model along a recorded motion, beside what the recorder wrote down."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from hitjoints.built import kernel_for
from hitjoints.evidence.recordings.alignment import Lag, find_lag, refuse_another_robot
from hitjoints.evidence.recordings.csv_table import RecordingError

if TYPE_CHECKING:
    from hitjoints.evidence.recordings.layout import Clock, RobotRecording
    from hitjoints.model.robot import Contact, Robot
    from hitjoints.types import Array


@dataclass(frozen=True, eq=False)
class RecordedMotion:
    """A robot's recording with the model's quantities, row by row.

    Attributes:
        clock: times of the joints' rows.
        direction: (3,) hitting direction.
        inertia: (N,) kg.
        gradient: (N, n) kg/rad.
        velocity: (N, 3) m/s, J qd.
        speed: (N,) m/s along the direction.
        lag: None if the tool's position was not recorded.
        velocity_error: m/s, greatest distance to the recorded velocity; None if not recorded.
        recorded: column -> (M, k), the recorder's quantities moved to the joints' rows: its row
            i + lag belongs to row i, so M = N - lag at the end.
    """

    clock: Clock
    direction: Array
    inertia: Array
    gradient: Array
    velocity: Array
    speed: Array
    lag: Lag | None
    velocity_error: float | None
    recorded: dict[str, Array]

    def at(self, time: float, values: Array) -> Array:
        """Return values, (M,) or (M, k) along the rows, at a time between them."""
        stamps = self.clock.time[: len(values)]
        columns = values.reshape(len(values), -1).T
        return np.array([np.interp(time, stamps, column) for column in columns])

    @property
    def recorded_inertia(self) -> Array | None:
        """The recorder's inertia, (M,) kg: 1 / (h^T Inertia h)."""
        if "Inertia" not in self.recorded:
            return None
        h = self.direction
        mobility = np.einsum("i,nij,j->n", h, self.recorded["Inertia"].reshape(-1, 3, 3), h)
        return 1.0 / mobility if (mobility > 0).all() else None


def model_along(
    recording: RobotRecording, robot: Robot, tool: Contact, direction: Array | None
) -> RecordedMotion:
    """Compute the model along a recording.

    Args:
        recording: of the robot.
        robot: the arm.
        tool: the point that hits.
        direction: (3,); None: the axis nearest to the tool's velocity when it is fastest.

    Raises:
        RecordingError: the recording is not this robot's.
    """
    q, qd = recording.q, recording.qd
    if q.shape[1] != robot.n:
        raise RecordingError(f"it has {q.shape[1]} joints, {robot.name} has {robot.n}")
    quick = kernel_for(robot, (tool,), ("position", "jacobian"))(q, np.array([1.0, 0.0, 0.0]))
    position, jacobian = quick["position"][0], quick["jacobian"][0]
    velocity = np.einsum("nij,nj->ni", jacobian, qd)
    lag, recorded = None, dict(recording.recorded)
    if "EEF_Position" in recording.recorded:
        lag = find_lag(position, recording.recorded["EEF_Position"])
        refuse_another_robot(robot, tool.offset, q, recording.recorded["EEF_Position"], lag)
        recorded = {name: lag.aligned(values) for name, values in recorded.items()}
    h = _nearest_axis(velocity) if direction is None else direction
    felt = kernel_for(robot, (tool,), ("inertia", "gradient"))(q, h)
    error = None
    if "EEF_Velocity" in recorded:
        apart = velocity[: len(recorded["EEF_Velocity"])] - recorded["EEF_Velocity"]
        apart = apart if lag is None else apart[lag.known]
        error = float(np.linalg.norm(apart, axis=1).max())
    return RecordedMotion(
        recording.clock,
        h,
        felt["inertia"][0],
        felt["gradient"][0],
        velocity,
        velocity @ h,
        lag,
        error,
        recorded,
    )


def _nearest_axis(velocity: Array) -> Array:
    fastest = velocity[np.argmax(np.linalg.norm(velocity, axis=1))]
    axis = int(np.argmax(np.abs(fastest)))
    return np.asarray(np.sign(fastest[axis]) * np.eye(3)[axis])
