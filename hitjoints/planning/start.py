"""Where a hit starts: behind the object, with the run-up the hitting field needs (Eq. 5-6)."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any

import numpy as np

from hitjoints.dynamics.kinematics import jacobian, position
from hitjoints.errors import InfeasibleError, InputError, SolverError
from hitjoints.hitting.field import HittingField
from hitjoints.planning.acceleration import accelerated
from hitjoints.programs.hitting_speed import solve_hitting_speed, step_bounds
from hitjoints.programs.problem import Program
from hitjoints.programs.solver import solve
from hitjoints.told import Told
from hitjoints.tolerances import rank_floor, told_apart
from hitjoints.vectors import number, unit

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from hitjoints.model.robot import Contact, Robot
    from hitjoints.types import Array

SETTLED = 2e-3
"""m, the lateral error a run-up may leave at most."""
AIM = 0.99 * SETTLED
"""m, the lateral error a run-up is made for, so that rounding does not make it too short."""
ALLOWANCE = 0.01
"""m, the lateral error the default run-up is made for when none is given."""
POSTURE = 1.0
"""Pull of the joints towards the middle of their ranges, 1/m: per metre the contact moves."""
OFF_THE_LINE = 1e-4
"""m: an arm that deviates more from the straight path does not follow it."""
SHARES = (0.98, 0.9, 0.8, 0.7, 0.6, 0.5, 0.4, 0.3, 0.2, 0.1)
"""Of the maximum straight speed, tried for the fastest start."""
WITHIN = 1.0 - 1e-9
"""Share of the velocity limits used, so that differences of rounded positions stay within them."""


@dataclass(frozen=True, eq=False, repr=False)
class Start(Told):
    """The start of a hit and the way from there.

    Attributes:
        q: (n,) rad, the start configuration: the first row of `path`.
        position: (3,) m, of the contact there.
        speed: m/s, of the contact at the hit, along the direction.
        run_up: m, from there to the hit; shorter than asked for when not feasible.
        path: (S, n) rad, within the limits: to the hitting configuration, evenly timed; or, with
            torque limits, as the controller runs it, to the impact.
        times: (S,) s, from 0.
        lateral_miss: m, by how much the field misses when the contact starts `lateral` aside.
        velocity_ratio_max: greatest |qd| of the path in units of its limit, at most 1.
        feasible: the run-up is as long as asked for, and long enough.
        reason: what is in the way; empty when feasible.
    """

    q: Array
    position: Array
    speed: float
    run_up: float
    path: Array
    times: Array
    lateral_miss: float
    velocity_ratio_max: float
    feasible: bool
    reason: str

    @property
    def words(self) -> str:
        """Where it is, in a line."""
        state = f"; {self.reason}" if self.reason else ""
        return f"{self.run_up:.3g} m behind the object, for {self.speed:.4g} m/s{state}"

    def as_dict(self) -> dict[str, Any]:
        """Return the attributes by name, arrays as lists."""
        values = {item.name: getattr(self, item.name) for item in fields(self)}
        return {k: v.tolist() if hasattr(v, "tolist") else v for k, v in values.items()}


def plan_start(  # noqa: PLR0913
    robot: Robot,
    q: ArrayLike,
    contact: Contact | int,
    direction: ArrayLike,
    speed: float,
    *,
    run_up: float | None = None,
    lateral: float = 0.0,
    dt: float = 0.005,
    torque_limits: bool = False,
    acceleration_limits: bool | ArrayLike = False,
) -> Start:
    """Plan where a hit starts, by moving back from the hitting configuration along the line.

    On the line the field asks for the desired speed along the direction, so the path has it all
    the way; `Start.path` is straight to `OFF_THE_LINE`, and its free motion keeps the joints near
    the middle of their ranges. It is one path of many: infeasible means that this one is.

    Args:
        robot: the arm.
        q: (n,) rad, the hitting configuration, within the limits.
        contact: joint number or Contact.
        direction: (3,), the hitting direction.
        speed: m/s at the hit, along the direction, > 0.
        run_up: m, > 0. When not given, what the default field needs to bring a lateral error of
            `lateral` (at least 1 cm) below 2 mm.
        lateral: m, how far from the line the contact may be at the start, >= 0.
        dt: s, longest time between rows of the path.
        torque_limits: start at rest, far enough back for the motors to reach the speed.
        acceleration_limits: start at rest, far enough back to reach the speed within these: True
            for the robot's, or rad/s^2, one number or (n,).

    Raises:
        InputError: an argument cannot be used.
    """
    if torque_limits or acceleration_limits is not False:
        kept = {"torque_limits": torque_limits, "acceleration_limits": acceleration_limits}
        return _from_rest(robot, q, contact, direction, speed, run_up, lateral, dt, kept)
    h, here = unit(direction), position(robot, q, contact)
    speed, dt = _positive("speed", speed), _positive("dt", dt)
    number(lateral, "lateral", "a length in m, not below zero", lambda value: value >= 0)
    field = HittingField(here, speed * h)
    needed = field.distance_to_settle(max(lateral, ALLOWANCE), AIM)
    wanted = needed if run_up is None else _positive("run_up", run_up)
    path, reason = approach_path(robot, q, contact, h, wanted, speed=speed, dt=dt)
    steps = math.ceil(wanted / (speed * dt) - 1e-9)
    interval = wanted / (speed * steps)
    reached = speed * interval * (len(path) - 1)
    aside = np.linalg.svd(h[None, :])[2][1] * lateral
    miss = field.predicted_miss(here - reached * h + aside)
    if not reason and miss > SETTLED:
        reason = (
            f"a run-up of {reached:.3g} m leaves {miss:.2g} m of a lateral error of {lateral:.2g} m"
            f"; it takes {needed:.3g} m to leave less than {SETTLED:g} m"
        )
    return Start(
        q=path[0],
        position=position(robot, path[0], contact),
        speed=speed,
        run_up=reached,
        path=path,
        times=np.linspace(0.0, interval * (len(path) - 1), len(path)),
        lateral_miss=miss,
        velocity_ratio_max=robot.velocity_ratio(np.diff(path, axis=0) / interval),
        feasible=not reason,
        reason=reason,
    )


def _from_rest(  # noqa: PLR0913
    robot: Robot,
    q: ArrayLike,
    contact: Contact | int,
    direction: ArrayLike,
    speed: float,
    run_up: float | None,
    lateral: float,
    dt: float,
    kept: dict[str, Any],
) -> Start:
    def kinematic(run_up: float | None) -> Start:
        return plan_start(
            robot, q, contact, direction, speed, run_up=run_up, lateral=lateral, dt=dt
        )

    first = kinematic(run_up)
    longer = kinematic if run_up is None else None
    return accelerated(robot, robot.contact(contact), unit(direction), first, longer, SETTLED, kept)


def fastest_start(
    robot: Robot,
    q: ArrayLike,
    contact: Contact | int,
    direction: ArrayLike,
    *,
    torque_limits: bool = False,
) -> Start:
    """Plan the start of the fastest straight hit whose run-up is feasible.

    The maximum straight speed of the hitting configuration itself is rarely reached: further back
    the same arm is slower. So shares of it are tried, the greatest first.

    Arguments and errors as `plan_start`. When no share is feasible, the start of the least share
    is returned with its reason.
    """
    contact, q, h = robot.contact(contact), robot.within_limits(q), unit(direction)
    limits = robot.velocity_lower, robot.velocity_upper
    top = solve_hitting_speed(jacobian(robot, q, contact), h, *limits, straight=True).speed
    if not robot.velocity_upper.any():
        lack = "every velocity limit is zero or missing, so that no joint moves"
        raise InfeasibleError(f"{robot.name}: {lack}; a TOML may give velocity = [...] (rad/s)")
    if not top > 0:
        raise InfeasibleError(f"joint {contact.joint} cannot move straight along the direction")
    for share in SHARES:
        start = plan_start(robot, q, contact, h, share * top, torque_limits=torque_limits)
        if start.feasible:
            break
    return start


def approach_path(
    robot: Robot,
    q: ArrayLike,
    contact: Contact | int,
    direction: ArrayLike,
    distance: float,
    *,
    speed: float = 0.1,
    dt: float = 0.05,
) -> tuple[Array, str]:
    """Return the straight approach that ends in a configuration, found by moving back from it.

    Every step is the bounded least-squares problem: the joint velocity nearest to the posture
    motion, of those within the position and velocity limits that move the contact along the line.

    Args:
        robot: as `plan_start`.
        q: as `plan_start`.
        contact: as `plan_start`.
        direction: as `plan_start`.
        distance: m, > 0.
        speed: m/s, of the contact.
        dt: s, longest time between rows.

    Returns:
        (S, n) rad, first row furthest back, last row q; and why it is shorter than `distance`, or
        an empty text when it is not.

    Raises:
        InputError: an argument cannot be used.
    """
    contact, q, h = robot.contact(contact), robot.within_limits(q), unit(direction)
    if h.shape != (3,):
        raise InputError("direction", f"shape {h.shape}", "one direction of three numbers")
    distance, speed = _positive("distance", distance), _positive("speed", speed)
    steps = math.ceil(distance / (speed * _positive("dt", dt)) - 1e-9)
    interval = distance / (speed * steps)
    end, rows, reason = position(robot, q, contact), [q], ""
    for i in range(1, steps + 1):
        target = end - (i / steps * distance) * h
        try:
            before = _step_back(robot, rows[-1], contact, target, speed, interval)
        except (InfeasibleError, SolverError):
            reason = _obstacle(robot, rows[-1], contact, h, speed, interval)
        else:
            if np.linalg.norm(position(robot, before, contact) - target) > OFF_THE_LINE:
                reason = "the arm is at a singularity and cannot follow the line"
        if reason:
            reached = (i - 1) / steps * distance
            reason = f"the run-up ends after {reached:.3g} m of {distance:.3g} m: {reason}"
            break
        rows.append(before)
    return np.array(rows[::-1]), reason


def _step_back(
    robot: Robot, q: Array, contact: Contact, target: Array, speed: float, dt: float
) -> Array:
    """Return the configuration (n,) one step earlier, whose contact is at the target (3,)."""
    low, high = _bounds_back(robot, q, dt)
    ranged = np.isfinite(robot.lower) & np.isfinite(robot.upper)
    middle = q.copy()
    middle[ranged] = (robot.lower[ranged] + robot.upper[ranged]) / 2
    posture = POSTURE * speed * (middle - q)
    shift = (target - position(robot, q, contact)) / dt
    before = q
    for _ in range(2):  # the second time with the Jacobian of the middle of the step
        jac = jacobian(robot, (q + before) / 2, contact)
        left, s, right = np.linalg.svd(jac, full_matrices=False)
        kept = s > rank_floor(jac)
        rows, sides = s[kept, None] * right[kept], left[:, kept].T @ shift
        found = solve(Program(-posture, low, high, H=np.eye(robot.n), A=rows, b=sides))
        before = np.clip(q + dt * found.x, robot.lower, robot.upper)
    return before


def _bounds_back(robot: Robot, q: Array, dt: float) -> tuple[Array, Array]:
    slowest, fastest = -WITHIN * robot.velocity_upper, -WITHIN * robot.velocity_lower
    return step_bounds(q, robot.lower, robot.upper, slowest, fastest, dt)


def _obstacle(robot: Robot, q: Array, contact: Contact, h: Array, speed: float, dt: float) -> str:
    slowest, fastest = -WITHIN * robot.velocity_upper, -WITHIN * robot.velocity_lower
    low, high = _bounds_back(robot, q, dt)
    stopped = np.flatnonzero((low > slowest) | (high < fastest))
    jac = jacobian(robot, q, contact)
    top = solve_hitting_speed(jac, -h, slowest, fastest, straight=True).speed
    if stopped.size and top >= speed:
        names = ", ".join(f"joint {i + 1} at {q[i]:.4g} rad" for i in stopped)
        return f"stopped by position limits ({names})"
    if top >= speed:
        return (
            "one step further back the velocity limits leave the contact on the line too little "
            f"to go on at {speed:.3g} m/s"
        )
    wish, most = told_apart(speed, top)
    return (
        f"the velocity limits let the contact move straight along the direction at {most} m/s "
        f"at most there, too little to go on at {wish} m/s"
    )


def _positive(name: str, value: float) -> float:
    return number(value, name, "a finite number above zero", lambda found: found > 0)
