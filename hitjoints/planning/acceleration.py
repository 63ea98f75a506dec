"""The start of a hit whose drives need a way to reach the speed: run with their limits."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from hitjoints.errors import InfeasibleError
from hitjoints.hit import Hit
from hitjoints.hitting.approach import Approach
from hitjoints.hitting.controller import Controller

if TYPE_CHECKING:
    from collections.abc import Callable

    from hitjoints.model.robot import Contact, Robot
    from hitjoints.planning.start import Start
    from hitjoints.types import Array

CONTROL = 0.002
"""s, the control step of the runs."""
WEIGHTLESS = 1e-9
"""kg, of an object whose flux is the speed of what hits it, whatever the inertia."""
REACHED = 0.99
"""Share of the speed that counts as reached."""
LONGER = 1.5
"""Factor from one run-up to the next that is tried,"""
MOST_TRIES = 4
"""which are so many."""


def accelerated(
    robot: Robot,
    contact: Contact,
    direction: Array,
    start: Start,
    longer: Callable[[float], Start] | None,
    settled: float,
    kept: dict[str, Any],
) -> Start:
    """Return a start from which the arm, at rest there, reaches the speed within its limits.

    The controller of rollouts is run from the start. If it does not reach the speed on the line,
    a longer run-up is tried.

    Args:
        robot: the arm.
        contact: what hits.
        direction: (3,) unit vector.
        start: feasible as far as velocities go.
        longer: makes a start of another run-up (m); none if the run-up is given.
        settled: m, lateral error allowed at the hit.
        kept: the arguments of `Controller` that say which limits those are.

    Returns:
        A start with the path that was run, ending at the impact; or the last one tried, with the
        reason why it is not feasible.
    """
    target = np.round(start.position + start.run_up * direction, 9)
    hit = Hit(contact, target, direction, WEIGHTLESS, start.speed)
    tried, shown = start, start
    for _ in range(MOST_TRIES):
        if not tried.feasible:
            break
        run, why = run_from(robot, hit, tried.q, kept)
        shown = replace(tried, feasible=False, reason=why)
        if run is None:
            return shown
        slow = run.impact is not None and run.impact.speed < REACHED * start.speed
        if run.impact is not None and not why and not slow and run.impact.miss <= settled:
            return _with_path(robot, tried, run)
        if run.impact is not None and (slow or not why):
            shown = replace(
                shown,
                reason=f"the {_named(kept)} let the contact reach {run.impact.speed:.3g} m/s of "
                f"{start.speed:.3g} m/s after a run-up of {tried.run_up:.3g} m from rest",
            )
        if longer is None:
            return shown
        tried = longer(LONGER * tried.run_up)
    if not tried.feasible:
        return replace(shown, reason=f"{shown.reason}; and {tried.reason}")
    return shown


def run_from(robot: Robot, hit: Hit, q: Array, kept: dict[str, Any]) -> tuple[Approach | None, str]:
    """Return the controller's run from rest at q (n,) rad, and why it is no hit, if it is none."""
    try:
        controller = Controller(robot, hit, q, dt=CONTROL, compiled=False, **kept)
        if controller.torques is not None:
            controller.torques.check_start(q)
        run = Approach(controller, q)
        run.run()
    except InfeasibleError as error:
        return None, error.reason
    return run, run.reason


def _named(kept: dict[str, Any]) -> str:
    words = {"torque_limits": "torque", "acceleration_limits": "acceleration"}
    told = [word for name, word in words.items() if kept.get(name, False) is not False]
    return f"{' and '.join(told)} limits"


def _with_path(robot: Robot, start: Start, run: Approach) -> Start:
    assert run.impact is not None
    return replace(
        start,
        path=np.array([*(q for q, _ in run.rows), run.impact.q]),
        times=np.array([*(CONTROL * np.arange(len(run.rows))), run.impact.time]),
        velocity_ratio_max=robot.velocity_ratio(np.array([step.qd for _, step in run.rows])),
    )
