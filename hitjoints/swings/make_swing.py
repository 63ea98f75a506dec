"""Make a motion from rest to rest that strikes, and that can be sent."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from hitjoints.errors import InputError
from hitjoints.hitting.drive_limits import drive_limits
from hitjoints.loading.load import load_robot
from hitjoints.planning.plan_record import Plan
from hitjoints.swings.clear_way import Room
from hitjoints.swings.swing_search import SwingSearch

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import ArrayLike, NDArray

    from hitjoints.hit import Hit
    from hitjoints.model.robot import Robot
    from hitjoints.swings.swing_record import Swing

MARGIN = 0.005
"""m, the default clearance."""
SHORTEST, LONGEST = 1e-4, 0.02
"""s, spacing of samples."""


def swing(
    robot: Robot | Plan,
    hit: Hit | Plan | None = None,
    *,
    q0: ArrayLike | None = None,
    q_hit: ArrayLike | None = None,
    acceleration: ArrayLike | None = None,
    jerk: ArrayLike | None = None,
    table_height: float | None = None,
    margin: float = MARGIN,
    dt: float = 0.001,
    seed: int = 0,
) -> Swing:
    """Make a motion from rest to rest that strikes, keeps all known limits, and can be sent.

    Only the state at the impact is prescribed: the contact at the object, moving straight along
    the direction, with the flux asked for or as much as can be. The arm winds up for it in joint
    space, keeps the velocity for 10 mm after the impact, and stops.

    Args:
        robot: the arm, or a plan, which is made with its own arm.
        hit: what is asked; its `flux` may be None for the greatest that can be. A plan, too: its
            hit, in its configuration.
        q0: (n,) rad, where the arm is; by default its home.
        q_hit: (n,) rad, the configuration to strike in, such as a plan's, tried before others.
        acceleration, jerk: rad/s^2 and rad/s^3, one number or (n,); by default the robot's. An
            unknown jerk limit is not kept, and said to be unknown.
        table_height: m, of a table to stay above.
        margin: m, clearance to the object until the impact, to the table, and of the arm to itself.
        dt: s, spacing of the samples, 1e-4 to 0.02; the impact falls on one.
        seed: of the samples.

    Raises:
        InputError: an argument cannot be used, such as a start beyond limits or in collision.
        InfeasibleError: unreachable, no clear configuration, a flux beyond the maximum (which
            `data` holds as `maximum_flux`), or no stroke found, and why.
    """
    if not (math.isfinite(dt) and SHORTEST <= dt <= LONGEST):
        raise InputError("dt", dt, f"a spacing of {SHORTEST:g} s to {LONGEST:g} s")
    if not math.isfinite(margin):
        raise InputError("margin", margin, "a finite distance in metres")
    arm, asked, planned = _asked(robot, hit)
    limits = drive_limits(arm, acceleration, jerk)
    start = arm.within_limits(arm.home if q0 is None else q0, "q0")
    room = Room(arm, margin, table_height)
    search = SwingSearch(arm, asked, limits, room, start, dt, seed)
    return search.swing(planned if q_hit is None else q_hit)


def _asked(
    robot: Robot | Plan, hit: Hit | Plan | None
) -> tuple[Robot, Hit, NDArray[np.float64] | None]:
    """Return the arm, the hit, and the planned configuration (n,) if there is one."""
    if isinstance(robot, Plan):
        if hit is not None:
            raise InputError("hit", "given", "a plan has its own")
        return _asked(_arm_of(robot), robot)
    if isinstance(hit, Plan):
        hit.check_robot(robot)
        asked = hit.chosen_hit
        return robot, asked, None if hit.best is None else hit.best.q
    if hit is None:
        raise InputError("hit", None, "what is asked of the arm")
    return robot, hit, None


def _arm_of(plan: Plan) -> Robot:
    """Return the arm of a plan; one made in Python knows its name only."""
    if plan.hit.setting.robot is not None:
        return plan.load_robot()
    return plan.check_robot(load_robot(plan.robot))
