"""How many rows the recorder's tool lags its joints, and whether the recording is this robot's.

All of the recorder's own quantities (position, velocity, inertia, gradient, flux) lag alike.
"""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from hitjoints.dynamics.kinematics import position
from hitjoints.evidence.recordings.csv_table import RecordingError
from hitjoints.loading.catalogue import robot_names
from hitjoints.loading.load import load_robot
from hitjoints.model.robot import Contact

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from hitjoints.model.robot import Robot

    Array = NDArray[np.float64]

GREATEST_LAG = 5
"""rows."""

SAME_ROBOT = 1e-2
"""m: a tool that is further off belongs to another robot, or is another point."""

ROWS_TRIED = 20
"""rows of a recording that the built-in robots are tried on."""


class Lag(NamedTuple):
    """Rows by which the tool lags, and how far it then is from the model's (m).

    The mean chooses the lag, since in most rows of a recording the arm may stand still; the median
    tells whether it is the robot's; the greatest is what is left over all rows.
    """

    rows: int
    greatest: float
    median: float
    mean: float


def find_lag(model: Array, recorded: Array) -> Lag:
    """Return the lag that brings the model's positions (N, 3) closest to the recorded ones."""
    lags = []
    for rows in range(min(GREATEST_LAG, len(model) - 2) + 1):
        apart = np.linalg.norm(model[: len(model) - rows] - recorded[rows:], axis=1)
        lags.append(Lag(rows, float(apart.max()), float(np.median(apart)), float(apart.mean())))
    return min(lags, key=lambda lag: lag.mean)


def refuse_another_robot(
    robot: Robot, offset: tuple[float, float, float], q: Array, recorded: Array, lag: Lag
) -> None:
    """Refuse a recording whose tool is not where the robot's is.

    Raises:
        RecordingError: with the built-in robot that fits, if one does.
    """
    if lag.median <= SAME_ROBOT:
        return
    fitting = [name for name in _fitting(offset, q, recorded) if name != robot.name]
    advice = f"it fits {' and '.join(fitting)}" if fitting else "no built-in robot fits"
    raise RecordingError(
        f"not a recording of {robot.name} with the tool at ({', '.join(f'{v:g}' for v in offset)})"
        f" m: the tool is {lag.median:.3g} m off; {advice}"
    )


def _fitting(offset: tuple[float, float, float], q: Array, recorded: Array) -> list[str]:
    span = slice(max(0, len(q) // 2 - ROWS_TRIED), len(q) // 2 + ROWS_TRIED)
    q, recorded = q[span], recorded[span]
    names = []
    for name in robot_names():
        robot = _built_in(name)
        if robot.n == q.shape[1]:
            tool = Contact(robot.n, offset)
            model = np.array([position(robot, row, tool) for row in q])
            if find_lag(model, recorded).median <= SAME_ROBOT:
                names.append(name)
    return names


@cache
def _built_in(name: str) -> Robot:
    return load_robot(name)
