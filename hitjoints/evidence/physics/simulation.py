"""A planned hit in a physics engine: predicted against simulated."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from hitjoints.constants import GRAVITY
from hitjoints.errors import InfeasibleError, InputError
from hitjoints.evidence.physics.engine_drives import engine_drives, with_rotors_of
from hitjoints.evidence.physics.first_touch import ImpactState, is_level
from hitjoints.evidence.physics.setting import EngineSetting, Mode, setting
from hitjoints.evidence.physics.simulated_hit import Cause, Prediction, Simulation
from hitjoints.evidence.physics.slide import LONGEST, slide
from hitjoints.evidence.physics.strike import strike
from hitjoints.first_argument import by_first_argument
from hitjoints.goals.box_rest import BoxRest, predict_rest
from hitjoints.hit import Hit
from hitjoints.impact.collision import object_speed, rebound
from hitjoints.impact.elastic import ElasticImpact, elastic_impact
from hitjoints.model.engine import engine
from hitjoints.planning.plan_record import Plan
from hitjoints.planning.planner import plan_hit
from hitjoints.rollouts.follow import rollout
from hitjoints.swings.as_rollout import as_rollout
from hitjoints.swings.swing_record import Swing

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from hitjoints.goals.sliding import Support
    from hitjoints.model.robot import Robot
    from hitjoints.rollouts.record import Rollout
    from hitjoints.types import Array


@by_first_argument
def simulate(  # noqa: PLR0913
    robot: Robot | Swing,
    hit: Hit | None = None,
    *,
    restitution: float | None = None,
    mode: Mode = "ideal",
    size: ArrayLike | None = None,
    yaw: float | None = None,
    friction: float | None = None,
    support: Support | None = None,
    contact_time: float | None = None,
    servo_gain: float | None = None,
    contact_friction: float | None = None,
    off_centre: float | None = None,
    height: float | None = None,
    elastic: bool | None = None,
    stiffness: ArrayLike | None = None,
    rotor_inertia: ArrayLike | None = None,
    q0: ArrayLike | None = None,
    start: ArrayLike | None = None,
    q_hit: ArrayLike | None = None,
    torque_limits: bool = False,
    seed: int = 0,
) -> Simulation:
    """Move an arm to the impact, and let a physics engine (MuJoCo) do the rest.

    The arm hits a box at the contact point, which the engine sees as the link's surface; then the
    box slides on a level table until it stops. The prediction knows the restitution beforehand
    and nothing of the engine's result.

    Args:
        robot: the arm, or a swing, which is followed as it is.
        hit: what is asked, and rolled out; a swing has its own.
        restitution: eps, from 0 to 1; the hit's, or 0.5.
        mode: "ideal": the arm is free but for gravity compensation, the contact is short, central
            and without friction; "realistic": none of that, and each cause on its own as well.
        size: (3,) m, of the box: along the face's normal, sideways, up; the hit's, or 0.1 each.
        yaw: rad, by which the box is turned to the left; the hit's.
        friction: coefficient between box and table; 0 leaves the travel out; the hit's, or 0.3.
        support: what carries the box: its "face", the default, or its four "corners".
        contact_time: s; 0.0001, or 0.01 when realistic.
        servo_gain: N m s/rad, of every joint's velocity servo, which follows the rollout; 0, or 50
            when realistic.
        contact_friction: coefficient between arm and box; 0, or 0.3 when realistic.
        off_centre: m, from the line of the hit to the left to the box's centre; 0, or 0.02 when
            realistic.
        height: m, of the contact above the box's centre; 0.
        elastic: put every joint's motor behind a spring, and predict that in closed form as well;
            a contact then lasts 0.01 s when nothing else is asked for. None: if that is the model
            of the drives that the hit reckons with. By "rotor" the links carry the rotors; the
            engine has nothing for "composite", and takes the links alone.
        stiffness: of elastic joints; see `elastic_impact`.
        rotor_inertia: of elastic joints; see `elastic_impact`.
        q0: see `rollout`.
        start: see `rollout`.
        q_hit: see `rollout`.
        torque_limits: see `rollout`.
        seed: see `rollout`.

    Returns:
        The result, with `predicted`, `simulated`, `errors`, `causes` and `dataset`; where the box
        ends in `rest`, and where it should in `predicted_rest`.

    Raises:
        InputError: an argument cannot be used, or a realistic hit is not level.
        InfeasibleError: the rollout is no hit; see `rollout`.
        MissingExtraError: MuJoCo is not installed.
    """
    engine()
    starts: dict[str, Any] = {"q0": q0, "start": start, "q_hit": q_hit}
    arm, hit = _asked(robot, hit, starts)
    motors = engine_drives(arm, hit, elastic, stiffness, rotor_inertia, contact_time)
    how = setting(
        mode,
        stiffness=motors.stiffness,
        rotors=motors.rotors,
        contact_time=motors.contact_time,
        **_box_of(hit, restitution=restitution, size=size, yaw=yaw, friction=friction),
        support=support,
        servo_gain=servo_gain,
        contact_friction=contact_friction,
        off_centre=off_centre,
        height=height,
    )
    if how.stands and not is_level(hit.direction):
        raise InputError(
            "direction", hit.direction.tolist(), "a box on a level table is hit horizontally"
        )
    if isinstance(robot, Swing):
        motion = as_rollout(robot)
    else:
        motion = rollout(arm, hit, **starts, torque_limits=torque_limits, seed=seed)
    if motion.reason or motion.impact is None:
        raise InfeasibleError(f"the rollout is no hit: {motion.reason}", {"hit": False})
    if not motors.rotors:
        motion = with_rotors_of(hit, motion)
        arm = motion.robot
    impact = impact_of(motion)
    predicted = predict(motion, how)
    if predicted.travel is not None and 2 * predicted.travel > LONGEST * predicted.object_speed:
        expected = f"the box would slide for more than {LONGEST:g} s; 0 leaves the travel out"
        raise InputError("friction", how.friction, expected)
    servos = ServoReference(motion)
    # Servos may push the box again, which they could not while nothing slows it down.
    pushes = how.on_table and how.servo_gain > 0
    result = strike(arm, impact, how, servos, servos.rest if pushes else 0.0)
    slid = None if predicted.travel is None else slide(impact, how, *result.box)
    told_rest, why = predict_box(motion, impact, how, predicted)
    causes = tuple(
        Cause(
            name,
            value,
            strike(arm, impact, alone, servos),
            strike(arm, impact, without, servos),
        )
        for name, value, alone, without in how.causes()
    )
    told = predict_elastic(motion, impact, how) if motors.rotors else None
    return Simulation(
        motion, mode, how, impact, predicted, result, slid, causes, told, told_rest, why
    )


def _box_of(hit: Hit, **asked: ArrayLike | None) -> dict[str, Any]:
    """Return what is known of the box, by name: as asked for, or as the hit has it."""
    box = {name: getattr(hit, name) if value is None else value for name, value in asked.items()}
    if box["size"] is not None:
        box["size"] = tuple(np.asarray(box["size"], dtype=float).tolist())
    return box


def _asked(robot: Robot | Swing, hit: Hit | None, starts: Mapping[str, Any]) -> tuple[Robot, Hit]:
    """Return the arm and what is asked of it, be that a hit or a swing."""
    if isinstance(robot, Swing):
        for name, value in {"hit": hit, **starts}.items():
            if value is not None:
                raise InputError(name, "given", "a swing has its own")
        return robot.robot, robot.hit
    if hit is None:
        raise InputError("hit", None, "what is asked of the arm")
    return robot, hit


class ServoReference:
    """What the servos follow: the rollout, which slows the arm down after the impact.

    Attributes:
        rest: s, from the impact until the arm rests.
    """

    def __init__(self, motion: Rollout) -> None:
        self._qd, self._dt = motion.rows["qd"][motion.steps - 1 :], motion.dt
        self.rest = len(self._qd) * self._dt

    def __call__(self, time: float) -> Array:
        """Return the joint velocities (n,) rad/s at a time (s) since the impact."""
        row = int(time / self._dt)
        return np.asarray(self._qd[row] if row < len(self._qd) else np.zeros_like(self._qd[0]))


@simulate.register(Plan)
def _simulate_plan(plan: Plan, robot: Robot | None = None, **options: Any) -> Simulation:
    """Carry out a plan: its hit, in its configuration.

    Args:
        plan: that says yes.
        robot: the arm, if it is loaded already.
        options: as `simulate`; they go before what the plan says.
    """
    arm, hit, told = plan.carried_out(robot)
    told |= plan.hit.setting.told("torque_limits")
    return simulate(arm, hit, **(told | options))


@simulate.register(Hit)
def _simulate_hit(hit: Hit, robot: Robot | None = None, **options: Any) -> Simulation:
    """Make a hit as it says itself; one that does not say where the arm strikes is planned first.

    Args:
        hit: what is asked, with the arm and how to plan in its setting.
        robot: the arm, if it is loaded already.
        options: as `simulate`; they go before what the hit says.
    """
    how = hit.setting
    if how.q_hit is None:
        return _simulate_plan(plan_hit(hit, robot), robot, **options)
    told = how.told("q0", "q_hit", "torque_limits", "seed")
    return simulate(how.arm(robot), hit, **(told | options))


def impact_of(motion: Rollout) -> ImpactState:
    """Return the state in which a rollout that is a hit touches the object."""
    robot, hit = motion.robot, motion.hit
    assert motion.impact is not None
    at = motion.impact
    return ImpactState(
        robot.contact(hit.chosen_contact),
        hit.direction,
        hit.mass,
        at.q,
        motion.rows["qd"][motion.steps - 1],
        at.position,
    )


def predict(motion: Rollout, how: EngineSetting) -> Prediction:
    """Return what the model says about a rollout that is a hit (Eq. 3, 4, 11)."""
    assert motion.impact is not None
    at, mass = motion.impact, motion.hit.mass
    asked = at.inertia, mass, at.speed, how.restitution
    speed = object_speed(*asked)
    slides = is_level(motion.hit.direction) and how.friction > 0
    travel = speed**2 / (2 * how.friction * GRAVITY) if slides else None
    return Prediction(speed, rebound(*asked), at.inertia, travel, at.flux, at.speed)


def predict_box(
    motion: Rollout, impact: ImpactState, how: EngineSetting, predicted: Prediction
) -> tuple[BoxRest | None, str]:
    """Return where the box should come to rest, or None and why that cannot be told."""
    if predicted.travel is None:
        return None, "it does not slide on a level table with friction"
    hit = motion.hit.changed(
        size=how.size, yaw=how.yaw, restitution=how.restitution, friction=how.friction
    )
    places: dict[str, Any] = {name: getattr(how, name) for name in ("off_centre", "height")}
    try:
        told = predict_rest(
            motion.robot, impact.q, hit, predicted.speed, **places, support=how.support
        )
    except InfeasibleError as refused:
        return None, refused.reason
    return told, ""


def predict_elastic(motion: Rollout, impact: ImpactState, how: EngineSetting) -> ElasticImpact:
    """Return what elastic joints, and servos at their motors, make of it in closed form."""
    assert motion.impact is not None
    at = motion.impact
    return elastic_impact(
        motion.robot,
        at.q,
        impact.contact,
        impact.direction,
        impact.mass,
        at.speed,
        how.restitution,
        how.contact_time,
        how.stiffness,
        servo=(0.0, how.servo_gain),
        qd=impact.qd,
        rotor_inertia=how.rotors,
    )
