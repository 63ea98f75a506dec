"""How the joints move at the impact: as fast as can be along the direction, or as is wanted."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import pinocchio as pin

from hitjoints.dynamics.kinematics import WORLD_ALIGNED
from hitjoints.errors import HitjointsError
from hitjoints.programs.hitting_speed import solve_hitting_speed
from hitjoints.programs.problem import Program
from hitjoints.programs.solver import solve
from hitjoints.tolerances import rank_floor

if TYPE_CHECKING:
    from hitjoints.model.robot import Contact, Robot
    from hitjoints.types import Array

SMALLEST = 1e-3
"""rad/s, least width of the box that weighs a joint: one at its limit is not used at all costs."""
EXACT = 1e-9
"""m/s, by which a velocity may miss the one wanted."""


class StateAtHit(NamedTuple):
    """A configuration and its joint velocity at the impact.

    Attributes:
        q: (n,) rad.
        qd: (n,) rad/s.
        J: (3, n) m/rad.
        speed: m/s along the direction.
    """

    q: Array
    qd: Array
    J: Array
    speed: float


def impact_velocity(
    J: Array, h: Array, lower: Array, upper: Array, speed: float | None = None
) -> Array | None:
    """Return joint velocities (n,) rad/s with the contact moving straight along h, certified.

    With a speed, those of least norm in units of the box that have it, J qd = speed h; where the
    solver has no certified answer, or without a speed, the fastest ones, scaled.

    Args:
        J: (3, n) m/rad.
        h: (3,), unit.
        lower: (n,) rad/s, lower <= 0 <= upper.
        upper: (n,) rad/s, lower <= 0 <= upper.
        speed: m/s, wanted; None for as fast as can be.

    Returns:
        None if there are none: the speed is too much, or the contact cannot move along h.
    """
    if speed is not None:
        least = _least_norm(J, h * speed, lower, upper)
        if least is not None:
            return least
    try:
        fastest = solve_hitting_speed(J, h, lower, upper, straight=True)
    except HitjointsError:
        return None
    if not fastest.speed > 0 or (speed is not None and fastest.speed < speed):
        return None
    return np.asarray(fastest.qd if speed is None else fastest.qd * (speed / fastest.speed))


def _least_norm(J: Array, velocity: Array, lower: Array, upper: Array) -> Array | None:
    widths = np.maximum(np.maximum(upper, -lower), SMALLEST)
    U, s, Vt = np.linalg.svd(J * widths, full_matrices=False)
    kept = s > float(rank_floor(J * widths))
    along = U.T @ velocity
    if np.abs(along[~kept]).max(initial=0.0) > EXACT:
        return None
    # Without active bounds it is the least norm itself; the rows are orthogonal, so well scaled.
    free = widths * (Vt[kept].T @ (along[kept] / s[kept]))
    if ((free >= lower) & (free <= upper)).all():
        return np.asarray(free)
    try:
        n = widths.size
        bounds = lower / widths, upper / widths
        found = solve(
            Program(np.zeros(n), *bounds, H=np.eye(n), A=Vt[kept], b=along[kept] / s[kept])
        )
    except HitjointsError:
        return None
    qd = np.clip(widths * found.x, lower, upper)
    return qd if np.linalg.norm(J @ qd - velocity) <= EXACT else None


def straightening(
    robot: Robot,
    q: Array,
    qd: Array,
    contact: Contact,
    h: Array,
    J: Array,
    widths: Array,
) -> Array:
    """Return the curvature c (n,) rad/s^2 with which q + qd s + c s^2 / 2 has no sideways one.

    Across h the contact's acceleration J c + J' qd vanishes; of all such c the smallest.

    Args:
        robot: the arm and what it hits with.
        contact: the arm and what it hits with.
        q: (n,) rad and rad/s.
        qd: (n,) rad and rad/s.
        h: (3,), unit.
        J: (3, n) m/rad at q.
        widths: (n,), the unit that each c is measured in; zero for joints that are not to bend.
    """
    model, data = robot.model, robot.data
    pin.forwardKinematics(model, data, q, qd, np.zeros(robot.n))
    bent = pin.getFrameClassicalAcceleration(
        model, data, contact.joint, contact.placement, WORLD_ALIGNED
    ).linear
    across = np.linalg.svd(h[None, :])[2][1:]
    rows = across @ J * widths
    return np.asarray(-widths * (np.linalg.pinv(rows, rcond=1e-6) @ (across @ bent)))
