"""What the viewer asks the rest of the library for: a plan of all joints, and a motion."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hitjoints.planning.planner import plan
from hitjoints.planning.room.surroundings import Surroundings
from hitjoints.rollouts.follow import rollout
from hitjoints.show.viewer.clip import Clip, clip_of_rollout, clip_of_swing
from hitjoints.swings.make_swing import MARGIN, swing

if TYPE_CHECKING:
    from hitjoints.hit import Hit
    from hitjoints.model.robot import Contact, Robot
    from hitjoints.planning.plan_record import Plan
    from hitjoints.types import Array

FROM_HERE = "swing from here"
MOTIONS = ("swing", FROM_HERE, "rollout")


def made_clip(robot: Robot, wish: Hit, q_hit: Array, q_now: Array, motion: str) -> Clip:
    """Make a motion that strikes in a configuration that was planned.

    Args:
        robot: the arm.
        wish: what is wanted; its setting says how the motion is made.
        q_hit: (n,) rad.
        q_now: (n,) rad, where a swing "from here" starts.
        motion: one of `MOTIONS`.

    Raises:
        InfeasibleError: there is none.
        InputError: the arm or the hit lacks what the motion needs.
    """
    setting = wish.setting
    if motion == "rollout":
        limits, seed = setting.torque_limits, setting.seed
        return clip_of_rollout(rollout(robot, wish, q_hit=q_hit, torque_limits=limits, seed=seed))
    made = swing(
        robot,
        wish,
        q0=q_now if motion == FROM_HERE else setting.q0,
        q_hit=q_hit,
        table_height=setting.table_height,
        margin=MARGIN if setting.margin is None else setting.margin,
        seed=setting.seed,
        **({} if setting.dt is None else {"dt": setting.dt}),
    )
    return clip_of_swing(made)


def planned(robot: Robot, wish: Hit, contacts: tuple[Contact, ...]) -> Plan:
    """Plan a wish for every contact.

    Args:
        robot: the arm.
        wish: what is wanted; its setting says how to plan.
        contacts: to try.

    Raises:
        InputError: the objective needs what is not known.
    """
    setting = wish.setting
    asked = setting.deliverable
    made: Plan = plan(
        robot,
        wish.position,
        wish.direction,
        wish.mass,
        joints=contacts,
        objective=setting.objective,
        flux=wish.flux,
        away=setting.away,
        seed=setting.seed,
        certificate=False,
        surroundings=Surroundings.of(wish),
        deliverable=robot.acceleration is not None if asked is None else asked,
    )
    return made
