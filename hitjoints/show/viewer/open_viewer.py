"""Show an arm, a hit, a plan, or a motion in the browser."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from hitjoints.errors import InputError
from hitjoints.first_argument import by_first_argument
from hitjoints.hit import Hit
from hitjoints.model.robot import Contact
from hitjoints.planning.plan_record import Plan
from hitjoints.rollouts.record import Rollout
from hitjoints.show.viewer.clip import Clip, clip_of_rollout, clip_of_swing
from hitjoints.show.viewer.live import Viewer
from hitjoints.show.viewer.serving import check_address
from hitjoints.show.viewer.stage import Stage
from hitjoints.swings.swing_record import Swing

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike

    from hitjoints.model.robot import Robot


@by_first_argument
def view(  # noqa: PLR0913
    robot: Robot,
    q: ArrayLike | None = None,
    contact: Contact | int | None = None,
    *,
    position: ArrayLike = (0.5, 0.3, 0.5),
    direction: ArrayLike = (0.0, 1.0, 0.0),
    mass: float = 2.0,
    flux: float | None = 0.3,
    host: str = "127.0.0.1",
    port: int = 8080,
) -> Viewer:
    """Show an arm in the browser, with the inertia felt at a contact, and let it plan and hit.

    Args:
        robot: the arm.
        q: (n,) rad, the configuration to begin with; home by default.
        contact: joint number or Contact; the last but one of the hitting joints by default.
        position: the hit, see `Hit`; all but the offset of the contact can be changed in the
            browser.
        direction: as position.
        mass: as position.
        flux: as position; None for as much as there can be.
        host: where to serve; the next free port if this one is taken.
        port: where to serve; the next free port if this one is taken.

    Returns:
        A `Viewer`, which serves in threads of its own until `stop` or the end of the program.

    Raises:
        InputError: an argument cannot be used.
        MissingExtraError: viser is not installed.
    """
    chosen = robot.contact(robot.usual_joint if contact is None else contact)
    hit = Hit(chosen, np.asarray(position), np.asarray(direction), mass, flux)
    return open_stage(robot, hit, q, host=host, port=port)


@view.register(Hit)
def _view_hit(hit: Hit, robot: Robot | None = None, **where: Any) -> Viewer:
    """Show a hit, not yet planned.

    Args:
        hit: what is wanted.
        robot: the arm, if it is loaded already.
        where: host and port.
    """
    if robot is None:
        if hit.setting.robot is None:
            raise InputError("robot", None, "the hit does not say with which arm")
        robot = hit.setting.robot.load()
    if hit.contact is None:
        hit = hit.with_contact(robot.contact(robot.usual_joint))
    return open_stage(robot, hit, **where)


@view.register(Plan)
def _view_plan(plan: Plan, robot: Robot | None = None, **where: Any) -> Viewer:
    """Show a plan that says yes: all its joints, and the best one in its configuration.

    Args:
        plan: what was planned.
        robot: the arm, if it is loaded already.
        where: host and port.
    """
    arm, hit, _ = plan.carried_out(robot)
    return open_stage(arm, hit, plan=plan, **where)


@view.register(Swing)
def _view_swing(swing: Swing, **where: Any) -> Viewer:
    """Show a swing: it can be played, and the box slides when it is hit.

    Args:
        swing: the motion.
        where: host and port.
    """
    return open_stage(swing.robot, swing.hit, clip=clip_of_swing(swing), **where)


@view.register(Rollout)
def _view_rollout(rollout: Rollout, **where: Any) -> Viewer:
    """Show a rollout: it can be played, and the box slides when it is hit.

    Args:
        rollout: the motion.
        where: host and port.
    """
    return open_stage(rollout.robot, rollout.hit, clip=clip_of_rollout(rollout), **where)


def open_stage(
    robot: Robot,
    hit: Hit,
    q: ArrayLike | None = None,
    *,
    contacts: Sequence[Contact] | None = None,
    plan: Plan | None = None,
    clip: Clip | None = None,
    host: str = "127.0.0.1",
    port: int = 8080,
) -> Viewer:
    """Serve an arm with a hit, and with what was planned and made for it.

    Args:
        robot: the arm.
        hit: with what hits.
        q: (n,) rad, the configuration to begin with; by default as planned, or home.
        contacts: that a plan tries; the plan's, or the robot's usual ones by default.
        plan: of this hit; what is planned for its joint is shown.
        clip: a motion.
        host: where to serve; the next free port if this one is taken.
        port: where to serve; the next free port if this one is taken.

    Raises:
        InputError: an argument cannot be used.
        MissingExtraError: viser is not installed.
    """
    check_address(host, port)
    if contacts is None and plan is not None:
        contacts = [Contact(one.joint, one.offset) for one in plan.candidates]
    stage = Stage(robot, hit, robot.within_limits(robot.home if q is None else q), contacts)
    if plan is not None:
        stage.adopt(plan)
    if q is not None:
        stage.turn(q)
    viewer = Viewer(stage, host, port)
    if clip is not None:
        viewer.show(clip)
    return viewer
