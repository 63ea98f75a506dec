"""Make a motion from rest to rest that strikes, and that can be sent."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from hitjoints.first_argument import by_first_argument
from hitjoints.hit import Hit
from hitjoints.hitting.drive_limits import drive_limits
from hitjoints.planning.plan_record import Plan
from hitjoints.planning.planner import plan_hit
from hitjoints.swings.clear_way import Room
from hitjoints.swings.swing_search import SwingSearch
from hitjoints.swings.swing_task import SwingTask
from hitjoints.vectors import number

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from hitjoints.model.robot import Robot
    from hitjoints.swings.swing_record import Swing

MARGIN = 0.005
"""m, the default clearance."""
DT = 0.001
"""s, the default spacing of samples."""
SIZE = (0.1, 0.1, 0.1)
"""m, edges of the object where none are given."""
SHORTEST, LONGEST = 1e-4, 0.02
"""s, spacing of samples."""


@by_first_argument
def swing(  # noqa: PLR0913
    robot: Robot,
    hit: Hit,
    *,
    q0: ArrayLike | None = None,
    q_hit: ArrayLike | None = None,
    acceleration: ArrayLike | None = None,
    jerk: ArrayLike | None = None,
    table_height: float | None = None,
    margin: float | None = None,
    dt: float | None = None,
    seed: int | None = None,
) -> Swing:
    """Make a motion from rest to rest that strikes, keeps all known limits, and can be sent.

    Only the state at the impact is prescribed: the contact at the object, moving straight along
    the direction, with the flux asked for or as much as can be. The arm winds up for it in joint
    space, keeps the velocity for 10 mm after the impact, and stops. What is not given is as the
    hit's setting says, or else as here.

    Args:
        robot: the arm.
        hit: what is asked; its `flux` may be None for the greatest that can be. Inertia and flux
            are those of the model of the drives in its setting.
        q0: (n,) rad, where the arm is; by default its home.
        q_hit: (n,) rad, the configuration to strike in, such as a plan's, tried before others.
        acceleration: rad/s^2 and rad/s^3, one number or (n,); by default the robot's. An unknown
            jerk limit is not kept, and said to be unknown.
        jerk: rad/s^2 and rad/s^3, one number or (n,); by default the robot's. An unknown jerk limit
            is not kept, and said to be unknown.
        table_height: m, of a table to stay above.
        margin: m, clearance to the object until the impact, to the table, and of the arm to itself;
            by default 5 mm.
        dt: s, spacing of the samples, 1e-4 to 0.02, by default 1 ms; the impact falls on one.
        seed: of the samples.

    Raises:
        InputError: an argument cannot be used, such as a start beyond limits or in collision.
        InfeasibleError: unreachable, no clear configuration, a flux beyond the maximum (which
            `data` holds as `maximum_flux`), or no stroke found, and why.
    """
    hit = hit.made_by(
        robot,
        q0=q0,
        q_hit=q_hit,
        acceleration=acceleration,
        jerk=jerk,
        table_height=table_height,
        margin=margin,
        dt=dt,
        seed=seed,
    )
    how = hit.setting
    dt = DT if how.dt is None else how.dt
    margin = MARGIN if how.margin is None else how.margin
    words = f"a spacing of {SHORTEST:g} s to {LONGEST:g} s"
    dt = number(dt, "dt", words, lambda value: SHORTEST <= value <= LONGEST)
    margin = number(margin, "margin", "a finite distance in metres")
    limits = drive_limits(robot, how.acceleration, how.jerk)
    start = robot.within_limits(robot.home if how.q0 is None else how.q0, "q0")
    size = np.array(SIZE) if hit.size is None else hit.size
    room = Room(robot, margin, how.table_height, size)
    task = SwingTask(robot, hit, limits, room, start)
    return SwingSearch(task, dt, how.seed).swing(how.q_hit)


@swing.register(Hit)
def _swing_hit(hit: Hit, robot: Robot | None = None, **options: Any) -> Swing:
    """Make a hit as it says itself; one that does not say with which joint is planned first.

    Args:
        hit: what is asked, with the arm in its setting.
        robot: the arm, if it is loaded already.
        options: as `swing`; they go before what the hit says.
    """
    if hit.contact is None:
        return _swing_plan(plan_hit(hit, robot), robot, **options)
    return swing(hit.setting.arm(robot), hit, **options)


@swing.register(Plan)
def _swing_plan(plan: Plan, robot: Robot | None = None, **options: Any) -> Swing:
    """Carry out a plan: its hit, in its configuration.

    Args:
        plan: that says yes.
        robot: the arm, if it is loaded already.
        options: as `swing`; they go before what the plan says.
    """
    arm, hit, told = plan.carried_out(robot)
    return swing(arm, hit, **(told | options))
