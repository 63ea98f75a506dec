"""How many rollouts end: the impact within the last step, and the arm slowing down after it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from hitjoints.errors import InfeasibleError
from hitjoints.hitting.crossing import crossings
from hitjoints.rollouts.follow import FOLLOW_THROUGH
from hitjoints.rollouts.many_starts import seen_by

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from hitjoints.model.robot import Contact, Robot
    from hitjoints.rollouts.lanes import Approaches, Lanes
    from hitjoints.rollouts.tallies import Tallies
    from hitjoints.types import Array


def strike(
    robot: Robot, contact: Contact, lanes: Lanes, found: Approaches, qd: Array
) -> dict[str, Array]:
    """Return the impacts, (N, ...) by name of `Impact`'s attributes, nan where there is none.

    Args:
        robot: the arm.
        contact: what hits.
        lanes: of the rollouts.
        found: their ways to the object; a reason is added where the impact is singular.
        qd: (n, N) rad/s, of the last step.
    """
    starts, dt = lanes.starts, lanes.way.dt
    count, names = len(starts.hits), ("time", "miss", "direction_error", "inertia", "speed", "flux")
    result = {name: np.full(count, np.nan) for name in (*names, "desired_inertia")}
    result |= {"position": np.full((count, 3), np.nan), "q": np.full((count, robot.n), np.nan)}
    result["saturated"] = found.saturated
    rows = np.flatnonzero([not reason for reason in found.reason])
    if not rows.size:
        return result
    h, target, mass = starts.direction[rows], starts.target[rows], starts.mass[rows]
    before, rate = found.before[:, rows].T, qd[:, rows].T
    seen = seen_by(robot, contact)

    def ahead(t: Array) -> Array:
        here = seen(before + t[:, None] * rate, h, threads=1)["position"][0]
        return np.asarray(((target - here) * h).sum(axis=1))

    late = crossings(ahead, np.full(rows.size, dt))
    q = np.clip(before + late[:, None] * rate, robot.lower, robot.upper)
    values = seen(q, h, threads=1)
    here, inertia = values["position"][0], values["inertia"][0]
    velocity = (values["jacobian"][0] * rate[:, None, :]).sum(axis=2)
    along = (velocity * h).sum(axis=1)
    across = np.linalg.norm(velocity - along[:, None] * h, axis=1)
    outputs, right = lanes.step(lanes.inputs(rows, q.T))
    desired = outputs[lanes.step.at.numbers][1]
    for i in np.flatnonzero(~right).tolist():
        try:
            desired[i] = lanes.desired_inertia(int(rows[i]), q[i], rate[i])
        except InfeasibleError as error:
            found.reason[rows[i]] = f"singular: {error.reason}"
    for name, value in {
        "time": (found.steps[rows] - 1) * dt + late,
        "position": here,
        "miss": np.linalg.norm(here - target, axis=1),
        "direction_error": np.degrees(np.arctan2(across, along)),
        "inertia": inertia,
        "desired_inertia": desired,
        "speed": along,
        "flux": along / (1.0 + mass / inertia),
        "q": q,
    }.items():
        result[name][rows] = value
    return result


def slow_down(
    robot: Robot, contact: Contact, lanes: Lanes, found: Approaches, tallies: Tallies
) -> None:
    """Bring every arm that moved to rest, as `rollout` does, and add its rows to the tallies."""
    dt, h = lanes.way.dt, lanes.starts.direction
    low, high = robot.lower[:, None], robot.upper[:, None]
    slowest, fastest = robot.velocity_lower[:, None], robot.velocity_upper[:, None]
    seen = seen_by(robot, contact)
    count = math.ceil(FOLLOW_THROUGH / dt)
    rows: NDArray[np.int64] = np.flatnonzero(found.steps)
    q = found.after[:, rows]
    for i in range(1, count + 1):
        qd, left = tallies.qd[:, rows], max(count - i, 0)
        on = qd.any(axis=0)
        on &= np.isfinite(seen(q.T, h[rows], threads=1)["inertia"][0])
        if not on.all():
            rows, q, qd = rows[on], q[:, on], qd[:, on]
        if not rows.size:
            return
        least = np.maximum(slowest, (low - q) / dt)
        most = np.minimum(fastest, (high - q) / dt)
        qd = np.minimum(np.maximum(left / (left + 1) * qd, least), most)
        tallies.add(rows, q, qd)
        q = np.clip(q + dt * qd, low, high)
