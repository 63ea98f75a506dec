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
    from hitjoints.types import Array

GREATEST_LAG = 5
"""rows."""

SAME_ROBOT = 1e-2
"""m: a tool that is further off belongs to another robot, or is another point."""

ROWS_TRIED = 20
"""rows of a recording that the built-in robots are tried on."""


STEP_COST = 1e-3
"""m: a lag that steps has to bring the tool closer by this, summed over the rows; and by"""
STEP_NOISE = 20.0
"""times the median distance that a single lag leaves."""


class LagStep(NamedTuple):
    """The recorder's row from which on the lag is another, and what it is then (rows)."""

    row: int
    lag: int


class Lag(NamedTuple):
    """Rows by which the tool lags, and how far it then is from the model's (m).

    A dropped message makes the lag step within a recording.

    Attributes:
        rows: the lag of most rows.
        greatest: distance left over all rows.
        median: likewise; it tells whether the recording is the robot's.
        steps: where the lag becomes another, the start left out.
        of_rows: (N,) the lag of each of the recorder's rows, from the first that has a joint's row.
    """

    rows: int
    greatest: float
    median: float
    steps: tuple[LagStep, ...]
    of_rows: NDArray[np.int64]

    def aligned(self, recorded: Array) -> Array:
        """Return the recorder's rows (N, k) moved to the joints' rows, (M, k).

        Where none belongs to a row of the joints, because the lag steps over it, it is
        interpolated.
        """
        if not self.steps:
            return recorded[self.rows :]
        belongs = self._belongs
        last = np.append(np.diff(belongs) > 0, True)  # of two for one row, the later
        belongs, kept = belongs[last], recorded[-len(last) :][last]
        wanted = np.arange(belongs[-1] + 1)
        columns = kept.reshape(len(kept), -1).T
        moved = [np.interp(wanted, belongs, column) for column in columns]
        return np.array(moved).T.reshape(len(wanted), *recorded.shape[1:])

    @property
    def _belongs(self) -> NDArray[np.int64]:
        """The joints' row that each of the recorder's belongs to."""
        return np.asarray(self.of_rows[0] + np.arange(len(self.of_rows)) - self.of_rows)

    @property
    def known(self) -> NDArray[np.bool_]:
        """(M,): the joints' rows, as `aligned` has them, that have one of the recorder's."""
        belongs = self._belongs
        return np.isin(np.arange(belongs[-1] + 1), belongs)


def find_lag(model: Array, recorded: Array) -> Lag:
    """Return the lags that bring the model's positions (N, 3) closest to the recorded ones.

    In most rows of a recording the arm may stand still, and any lag will do: the sum of the
    distances decides, and a step has its cost.
    """
    most = min(GREATEST_LAG, len(model) - 2)
    rows = np.arange(len(recorded))
    apart = np.full((len(recorded), most + 1), np.inf)
    for lag in range(most + 1):
        apart[lag:, lag] = np.linalg.norm(model[: len(model) - lag] - recorded[lag:], axis=1)
    single = min(range(most + 1), key=lambda lag: float(apart[lag:, lag].mean()))
    cost = STEP_COST + STEP_NOISE * float(np.median(apart[single:, single]))
    if apart[single:, single].sum() <= cost:  # no step can gain what it costs
        path = np.full(len(recorded), single, dtype=np.int64)
    else:
        path = _cheapest(apart, single, cost)
    first = int(path[0])  # rows before it are older than the joints' first
    path = path[first:]
    left = apart[rows[first:], path]
    changes = np.flatnonzero(np.diff(path)) + 1
    steps = tuple(LagStep(first + int(i), int(path[i])) for i in changes)
    usual = int(np.bincount(path).argmax())
    return Lag(usual, float(left.max()), float(np.median(left)), steps, path)


def _cheapest(apart: Array, single: int, cost: float) -> NDArray[np.int64]:
    """Return each row's lag (N,): least sum of distances (N, L), with a cost for every step."""
    count, lags = apart.shape
    total = apart[lags - 1].copy()
    came = np.zeros((count, lags), dtype=np.int64)
    kept = np.arange(lags)
    for row in range(lags, count):
        stepped = int(np.argmin(total))
        better = total[stepped] + cost < total
        came[row] = np.where(better, stepped, kept)
        total = np.where(better, total[stepped] + cost, total) + apart[row]
    path = np.full(count, single, dtype=np.int64)
    path[-1] = int(np.argmin(total))
    if total[single] <= total[path[-1]]:
        path[-1] = single
    for row in range(count - 1, lags - 1, -1):
        path[row - 1] = came[row, path[row]]
    path[: lags - 1] = path[lags - 1]
    return path


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
