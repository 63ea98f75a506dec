"""Roll a hit out in simulated time: approach, impact, and the slowing down after it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
import pinocchio as pin

from hitjoints.dynamics.contact_point import ContactPoint
from hitjoints.errors import InfeasibleError
from hitjoints.first_argument import by_first_argument
from hitjoints.hit import Hit
from hitjoints.hitting.approach import Approach
from hitjoints.hitting.controller import Controller, ReferenceName
from hitjoints.hitting.desired import Weighting
from hitjoints.hitting.laws import LawName
from hitjoints.hitting.step import Gains, Step
from hitjoints.planning.plan_record import Plan
from hitjoints.planning.planner import plan_hit
from hitjoints.rollouts.prepare import by_links, prepare
from hitjoints.rollouts.record import Rollout

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from hitjoints.model.robot import Robot
    from hitjoints.types import Array

FOLLOW_THROUGH = 0.2
"""s from the impact to rest, and"""
LONGEST = 10
"""times as long at most where limits slow the arm down as they can."""


@by_first_argument
def rollout(  # noqa: PLR0913
    robot: Robot,
    hit: Hit,
    *,
    q0: ArrayLike | None = None,
    start: ArrayLike | None = None,
    q_hit: ArrayLike | None = None,
    run_up: float | None = None,
    dt: float = 0.002,
    reference: ReferenceName = "optimised",
    law: LawName = "qp",
    weighting: Weighting = "identity",
    gains: Gains | None = None,
    speed_profile: Literal["paper", "constant"] = "constant",
    torque_limits: bool = False,
    acceleration_limits: bool | ArrayLike = False,
    seed: int = 0,
) -> Rollout:
    """Move an arm through a hit, kinematically: every joint follows its commanded velocity.

    The start is q0, or a configuration with the contact at `start`, or planned: the configuration
    of greatest straight flux that has a run-up, and the run-up. The arm starts at rest. The impact
    itself does not change the velocity (Eq. 11 tells by how much it would); the arm then slows down
    to rest, evenly or as fast as its torques let it.

    Its inertia and flux are those of the links. A hit that reckons with another model of the drives
    is made with the speed that it asks for.

    Args:
        robot: the arm.
        hit: what is asked.
        q0: see `hitting.prepare.prepare`.
        start: see `hitting.prepare.prepare`.
        q_hit: see `hitting.prepare.prepare`.
        run_up: see `hitting.prepare.prepare`.
        seed: see `hitting.prepare.prepare`.
        dt: s, the step, 2e-5 to 0.05.
        reference: see `Controller`.
        law: see `Controller`.
        weighting: see `Controller`.
        gains: see `Controller`.
        speed_profile: see `Controller`.
        torque_limits: see `Controller`.
        acceleration_limits: see `Controller`.

    Returns:
        The result, with `impact` and `dataset`. It is no hit if `reason` is not empty: off the
        line by more than 20 mm, off the direction by more than 5 degrees, off the flux by more than
        5 %, standing still (and at which limit), or out of time.

    Raises:
        InputError: an argument cannot be used, such as a start outside the limits or beyond the
            object, or a dt too large for the speed.
        InfeasibleError: see `prepare`.
    """
    asked = hit.made_by(robot, dt=dt, torque_limits=torque_limits, seed=seed)
    if q_hit is not None:
        hit = by_links(robot, hit, robot.within_limits(q_hit, "q_hit"))
    found = prepare(
        robot,
        hit,
        q0=q0,
        start=start,
        q_hit=q_hit,
        run_up=run_up,
        torque_limits=torque_limits,
        acceleration_limits=acceleration_limits,
        seed=seed,
    )
    hit = by_links(robot, hit, found.q_hit)
    controller = Controller(
        robot,
        hit,
        found.q_hit,
        dt=dt,
        inertia=ContactPoint(robot, hit.chosen_contact).inertia(found.q_hit, hit.direction),
        reference=reference,
        law=law,
        weighting=weighting,
        gains=gains,
        speed_profile=speed_profile,
        torque_limits=torque_limits,
        acceleration_limits=acceleration_limits,
        compiled=False,
    )
    controller.check_step(found.q0)
    if controller.torques is not None:
        controller.torques.check_start(found.q0)
    approach = Approach(controller, found.q0)
    approach.run()
    rows = approach.rows + _follow_through(controller, approach.q, approach.rows[-1][1].qd)
    steps = [step for _, step in approach.rows]
    parameters: dict[str, Any] = {"reference": reference, "law": law, "weighting": weighting}
    parameters |= {"dt": float(dt), "speed_profile": speed_profile, "seed": seed}
    parameters["torque_limits"] = torque_limits
    if controller.accelerations is not None:
        parameters["acceleration_limits"] = controller.accelerations.told.tolist()
    return Rollout(
        robot,
        hit,
        approach.impact,
        approach.reason,
        found.q_hit,
        controller.dt,
        len(steps),
        sum(step.saturated for step in steps),
        sum(step.braked for step in steps),
        _columns(controller, rows, len(steps)),
        np.array(approach.times),
        parameters | {"hit": asked.made_by(robot, q0=found.q0, q_hit=found.q_hit).text},
    )


@rollout.register(Hit)
def _rollout_hit(hit: Hit, robot: Robot | None = None, **options: Any) -> Rollout:
    """Make a hit as it says itself; one that does not say with which joint is planned first.

    Args:
        hit: what is asked, with the arm in its setting.
        robot: the arm, if it is loaded already.
        options: as `rollout`; they go before what the hit says.
    """
    if hit.contact is None:
        return _rollout_plan(plan_hit(hit, robot), robot, **options)
    told = hit.setting.told("q0", "q_hit", "seed") | _kept(hit)
    return rollout(hit.setting.arm(robot), hit, **(told | options))


@rollout.register(Plan)
def _rollout_plan(plan: Plan, robot: Robot | None = None, **options: Any) -> Rollout:
    """Carry out a plan: its hit, in its configuration.

    Args:
        plan: that says yes.
        robot: the arm, if it is loaded already.
        options: as `rollout`; they go before what the plan says.
    """
    arm, hit, told = plan.carried_out(robot)
    return rollout(arm, hit, **(told | _kept(hit) | options))


def _kept(hit: Hit) -> dict[str, Any]:
    """Return what a hit says of the step, and of the limits that its motions keep."""
    told = hit.setting.told("dt", "torque_limits", "acceleration")
    if "acceleration" in told:
        told["acceleration_limits"] = told.pop("acceleration")
    return told


def _follow_through(control: Controller, q: Array, qd: Array) -> list[tuple[Array, Step]]:
    """Return the steps from the impact to rest, all joints slowing down together."""
    rows: list[tuple[Array, Step]] = []
    h = control.direction
    count = math.ceil(FOLLOW_THROUGH / control.dt)
    for i in range(1, LONGEST * count):
        if not qd.any():
            break
        left = max(count - i, 0)
        qd, safe = control.slower(q, qd, left / (left + 1))
        here = control.point.position(q)
        along = float(h @ control.point.jacobian(q) @ qd)
        try:
            inertia = control.point.inertia(q, h)
        except InfeasibleError:
            break
        flux = control.hit.flux_of(inertia, along)
        rows.append(
            (q, Step(qd, here, inertia, math.nan, along, flux, 0.0, False, False, not safe))
        )
        q = control.follow(q, qd)
    return rows


def _columns(
    control: Controller, rows: list[tuple[Array, Step]], approach: int
) -> dict[str, Array]:
    columns = {name: np.array([getattr(step, name) for _, step in rows]) for name in Step._fields}
    robot, q, qd = control.robot, np.array([q for q, _ in rows]), columns["qd"]
    rates = np.diff(qd, axis=0, prepend=0.0) / control.dt
    before = qd - control.dt * rates
    states = zip(q, before, rates, strict=True)
    return columns | {
        "torque": np.array([pin.rnea(robot.model, robot.data, *state) for state in states]),
        "q": q,
        "approach": np.arange(len(rows)) < approach,
        "position_margin": np.minimum(q - robot.lower, robot.upper - q),
        "velocity_margin": np.minimum(qd - robot.velocity_lower, robot.velocity_upper - qd),
    }
