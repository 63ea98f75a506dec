"""The way to the object: step by step until the impact, or until there is a reason against it."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from hitjoints.errors import InfeasibleError
from hitjoints.hitting.controller import Controller
from hitjoints.hitting.crossing import crossing
from hitjoints.hitting.step import Step
from hitjoints.hitting.step_length import MOST_STEPS

if TYPE_CHECKING:
    from hitjoints.hit import Hit
    from hitjoints.model.robot import Robot
    from hitjoints.types import Array

MISSED = 0.02
"""m from the object at which crossing its plane is no hit any more;"""
ASKEW = 5.0
"""deg between the contact's velocity and the direction, and"""
WEAK = 0.05
"""share of the desired flux that may be missing, or too much, for the same."""
STILL = 0.02
"""Share of the needed speed below which the contact counts as standing still,"""
PATIENCE = 0.1
"""s, when it does so for this long."""
SLOWNESS = 5.0
"""Times as long as straight motion at the needed speed takes before a rollout is given up, and"""
GRACE = 1.0
"""s more, for what a start beside the line takes."""
AT_LIMIT = 1e-6
"""rad, a joint this near to its limit stands at it."""


@dataclass(frozen=True, eq=False)
class Impact:
    """The state in which the contact crosses the plane through the object.

    Attributes:
        time: s.
        position: (3,) m.
        miss: m, from there to the object.
        direction_error: deg, between the contact's velocity and the hitting direction.
        inertia: kg.
        desired_inertia: kg.
        speed: m/s along the direction.
        flux: m/s.
        q: (n,) rad.
        saturated: the desired flux was out of reach, or the limits slowed the arm down.
    """

    time: float
    position: Array
    miss: float
    direction_error: float
    inertia: float
    desired_inertia: float
    speed: float
    flux: float
    q: Array
    saturated: bool


class Approach:
    """Steps a controller until the contact crosses the plane through the object, or cannot.

    Attributes:
        rows: (q, step) of every step.
        q: (n,) rad, after the last.
        times: s, wall time of each.
        impact: as of a rollout.
        reason: as of a rollout.
    """

    def __init__(self, controller: Controller, q: Array) -> None:
        self._control, self.q = controller, np.array(q)
        self.rows: list[tuple[Array, Step]] = []
        self.times: list[float] = []
        self.impact: Impact | None = None
        self.reason = ""

    def run(self) -> None:
        """Move until there is an impact or a reason why there is none."""
        control, still = self._control, 0
        hit = control.hit
        patience = steps_of_patience(control.dt)
        distance = control.ahead(control.point.position(self.q))
        for _ in range(most_steps(distance, hit.desired_flux, control.dt)):
            if not self._advance():
                return
            here = control.point.position(self.q)
            step = self.rows[-1][1]
            if control.ahead(here) <= 0:
                self._strike()
                return
            moved = float(np.linalg.norm(here - step.position)) / control.dt
            still = still + 1 if moved < STILL * hit.speed(step.inertia) else 0
            if still >= patience:
                self.reason = before_it("stalled", control.ahead(here), control.robot, self.q)
                return
        self.reason = before_it("out of time", control.ahead(here), control.robot, self.q)

    def _advance(self) -> bool:
        control, q = self._control, self.q
        begin = time.perf_counter()
        try:
            qd = control.step(q)
        except InfeasibleError as error:
            if not self.rows:
                raise
            singular = "direction" in error.data
            self.reason = f"singular: {error.reason}" if singular else error.reason
            return False
        self.times.append(time.perf_counter() - begin)
        assert control.last is not None
        self.rows.append((q, control.last))
        self.q = control.follow(q, qd)
        return True

    def _strike(self) -> None:
        """Find the impact within the last step, at constant joint velocity."""
        control, (q, step) = self._control, self.rows[-1]
        robot, hit, h = control.robot, control.hit, control.direction
        late = crossing(
            lambda t: control.ahead(control.point.position(q + t * step.qd)), control.dt
        )
        struck = np.clip(q + late * step.qd, robot.lower, robot.upper)
        here = control.point.position(struck)
        velocity = control.point.jacobian(struck) @ step.qd
        inertia = control.point.inertia(struck, h)
        along = float(h @ velocity)
        across = float(np.linalg.norm(velocity - along * h))
        control.step(struck)
        assert control.last is not None
        miss = float(np.linalg.norm(here - control.position))
        self.impact = Impact(
            (len(self.rows) - 1) * control.dt + late,
            here,
            miss,
            math.degrees(math.atan2(across, along)),
            inertia,
            control.last.desired_inertia,
            along,
            hit.flux_of(inertia, along),
            struck,
            step.saturated,
        )
        self.reason = why_no_hit(hit, self.impact)


def steps_of_patience(dt: float) -> int:
    """Return for how many steps of dt (s) a contact may stand still."""
    return max(1, math.ceil(PATIENCE / dt))


def most_steps(distance: float, flux: float, dt: float) -> int:
    """Return after how many steps of dt (s) a way (m) for a flux (m/s) is given up."""
    return math.ceil(min((SLOWNESS * distance / flux + GRACE) / dt, MOST_STEPS))


def before_it(how: str, ahead: float, robot: Robot, q: Array) -> str:
    """Return how a way ends `ahead` (m) before the object, and at which limits q (n,) rad is."""
    at = np.flatnonzero((q - robot.lower < AT_LIMIT) | (robot.upper - q < AT_LIMIT))
    names = ", ".join(f"joint {i + 1} at {q[i]:.4g} rad" for i in at)
    stop = f", stopped by position limits ({names})" if names else ""
    return f"{how} {ahead:.3g} m before the object{stop}"


def why_no_hit(hit: Hit, impact: Impact) -> str:
    """Return what keeps an impact from being the hit that was asked for; empty if nothing does."""
    if impact.miss > MISSED:
        return (
            f"off the line: it passes the object at {impact.miss:.3g} m; start nearer to the line "
            "or further back"
        )
    if impact.direction_error > ASKEW:
        return (
            f"askew: the contact moves {impact.direction_error:.3g} degrees off the direction at "
            f"the impact, more than {ASKEW:g}"
        )
    share = impact.flux / hit.desired_flux
    if abs(share - 1.0) > WEAK:
        reached = "too strong" if share > 1.0 else "too weak"
        limited = ", as the limits let it on this way" if share < 1.0 and impact.saturated else ""
        return (
            f"{reached}: a flux of {impact.flux:.4g} m/s, {100 * share:.3g} % of what is desired"
            f"{limited}"
        )
    return ""
