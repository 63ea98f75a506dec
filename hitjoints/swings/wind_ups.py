"""Ways to come to a strike from rest: on what curve in joint space, and how fast."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from hitjoints.quantities import place_joint
from hitjoints.swings.impact_state import StateAtHit, straightening
from hitjoints.swings.ramps import Ramp, least_time, ramp_of

if TYPE_CHECKING:
    from hitjoints.hit import Hit
    from hitjoints.hitting.drive_limits import DriveLimits
    from hitjoints.model.robot import Robot
    from hitjoints.types import Array

FACTORS = (1.0, 1.3, 1.7, 2.3, 3.2, 4.5)
"""Times of a wind-up or a stop that are tried, in units of the least."""
RUN_UPS = (0.055, 0.075, 0.11)
"""m, ways of the contact whose wind-ups are tried besides."""
RUN_UP = 0.05
"""m, how far before the object the contact begins at least, and comes nearer all the time."""
BETWEEN = 4
"""Times between the slowest of the ones and the fastest of the others."""
AT_LIMIT, BENDING = 0.97, 0.8
"""Share of its velocity limit above which a joint does not slow down towards the impact, and of the
acceleration limits that bending may take."""
SMALL = 1e-6
"""Share of a Jacobian's size below which there is no motion."""
SWERVES = 6
"""Random curves with the same path of the contact near the impact, for each time."""


class WindUps(NamedTuple):
    """Curves q + v s + c s^2 / 2 and how s goes along time; see `Stroke`.

    Attributes:
        curvature: (K, n) rad/s^2, c.
        ramp: of (K, n) s each.
    """

    curvature: Array
    ramp: Ramp


class WindUpFamilies:
    """The wind-ups of one strike.

    Args:
        robot: the arm and the hit.
        hit: the arm and the hit.
        limits: of the drives.
        strike: how they are to end.
    """

    def __init__(self, robot: Robot, hit: Hit, limits: DriveLimits, strike: StateAtHit) -> None:
        self._robot, self._hit, self._limits, self._strike = robot, hit, limits, strike
        self._together = _ramps(robot, limits, strike, individual=False)
        self._bent, self._widths = _bent(robot, hit, limits, strike)

    def straight(self) -> WindUps:
        """Return lines, and curves whose contact's path bends sideways as little as can be."""
        alone = _ramps(self._robot, self._limits, self._strike, individual=True)
        bent, line = self._bent, np.zeros_like(self._bent)
        return _all([(bent, self._together), (bent, alone), (line, alone)])

    def through_the_line(self) -> WindUps:
        """Return parabolas that begin where the contact would if it came all the way straight."""
        (q, qd, _, speed), hit = self._strike, self._hit
        s = 0.5 * self._together.time[:, :1]
        behind = hit.position - s * speed * hit.direction
        contact = self._robot.contact(hit.chosen_contact)
        begun = place_joint(self._robot, contact, behind, start=q).q
        return WindUps(2.0 * (begun - q + qd * s) / s**2, self._together)

    def swerving(self, rng: np.random.Generator) -> WindUps:
        """Return random curves that bend the contact's path sideways no more than the least."""
        across = np.linalg.svd(self._hit.direction[None, :])[2][1:] @ self._strike.J * self._widths
        _, s, Vt = np.linalg.svd(across)
        free = Vt[int((s > SMALL * max(float(s.max(initial=0.0)), SMALL)).sum()) :]
        drawn = rng.uniform(-1.0, 1.0, (SWERVES, self._robot.n)) @ free.T @ free * self._widths
        size = np.max(np.abs(drawn) / self._limits.acceleration, axis=1, keepdims=True)
        swerves = self._bent + drawn * (BENDING / np.maximum(size, SMALL))
        return _all([(swerve, self._together) for swerve in swerves])


def _all(parts: list[tuple[Array, Ramp]]) -> WindUps:
    """Return every curve (n,) or (K, n) with its ramps (K, n)."""
    curvature = np.concatenate([np.broadcast_to(c, ramp.time.shape) for c, ramp in parts])
    times, builds = zip(*(ramp for _, ramp in parts), strict=True)
    return WindUps(curvature, Ramp(np.concatenate(times), np.concatenate(builds)))


def _ramps(robot: Robot, limits: DriveLimits, strike: StateAtHit, *, individual: bool) -> Ramp:
    """Return ramps (K, n) of increasing times, of joints together or as their room allows."""
    size = np.maximum(np.abs(strike.qd), 1e-9)
    a, j = limits.acceleration_used / size, limits.jerk_used / size
    least = float(least_time(a, j).max())
    most = np.full(robot.n, np.inf)
    if individual:
        behind = np.where(strike.qd > 0, strike.q - robot.lower, robot.upper - strike.q)
        most = 2.0 * 0.99 * behind / size
    times = {least * factor for factor in FACTORS}
    times |= {2.0 * way / strike.speed for way in RUN_UPS}
    # Near a stretched arm the contact moves ever faster the farther it is from the impact.
    slowest, evenly = least * FACTORS[-1], 2.0 * RUN_UPS[0] / strike.speed
    if slowest < evenly:
        times |= set(np.geomspace(slowest, evenly, BETWEEN + 2)[1:-1].tolist())
    longest = FACTORS[-1] * max(least, 2.0 * RUN_UP / strike.speed)
    tried = np.array([T for T in sorted(times) if least <= T <= longest])[:, None]
    return ramp_of(np.minimum(tried, most), a, j)


def _bent(robot: Robot, hit: Hit, limits: DriveLimits, strike: StateAtHit) -> tuple[Array, Array]:
    """Return the curvature with which the contact's path bends sideways as little as can be.

    Joints at their velocity limits cannot come from a higher velocity, and none can bend more than
    its acceleration allows. Beside it is what each joint can take.
    """
    v, contact = strike.qd, robot.contact(hit.chosen_contact)
    top = np.where(v > 0, limits.velocity_upper, -limits.velocity_lower)
    widths, given = limits.acceleration.copy(), (contact, hit.direction, strike.J)
    for _ in range(3):
        bent = straightening(robot, strike.q, v, *given, widths)
        faster = (np.abs(v) > AT_LIMIT * top) & (bent * v < 0)
        if not faster.any():
            break
        widths[faster] = 0.0
    bent[faster] = 0.0
    bent *= min(1.0, BENDING / float(np.max(np.abs(bent) / limits.acceleration, initial=1e-9)))
    return bent, np.where(np.abs(v) > AT_LIMIT * top, 0.0, limits.acceleration)
