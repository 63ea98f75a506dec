"""The maximum hitting speed (Eq. 9), anyhow or straight along the direction."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from hitjoints.errors import InfeasibleError, InputError
from hitjoints.programs.infeasibility import show_blocked
from hitjoints.programs.problem import Program, Residuals, residuals
from hitjoints.programs.solver import solve
from hitjoints.programs.straight_answer import certified_motion
from hitjoints.tolerances import rank_floor
from hitjoints.vectors import real, unit

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from hitjoints.programs.problem import Matrix, Vector

# One step up to a limit, q + ((q_u - q) / dt) dt, ends beyond it by a few units in the last place;
# URDFs write limits such as pi/2 with fewer digits than the controllers that stop there.
AT_LIMIT = 1e-9


@dataclass(frozen=True, eq=False)
class HittingSpeed:
    """The fastest motion of a contact along a direction.

    Attributes:
        speed: m/s, h^T J qd of this qd; negative if the limits leave only motion away.
        qd: (n,) rad/s, within the limits to the last bit.
        residuals: how well the answer is certified.
    """

    speed: float
    qd: Vector
    residuals: Residuals


def box_speed(pull: ArrayLike, lower: ArrayLike, upper: ArrayLike) -> tuple[float, Vector]:
    """Return the maximum of pull . qd within velocity limits, in closed form (Eq. 9).

    Args:
        pull: (n,) m/rad, J^T h.
        lower: (n,) rad/s. Equal limits lock a joint at that speed.
        upper: (n,) rad/s. Equal limits lock a joint at that speed.

    Returns:
        The speed in m/s and a velocity (n,) rad/s that attains it. A joint without pull moves as
        little as its limits allow.

    Raises:
        InputError: shapes that do not fit, or a number that is not finite.
        InfeasibleError: a lower limit above the upper one.
    """
    g = _finite("pull", pull)
    low, high = _finite("lower", lower, g.size), _finite("upper", upper, g.size)
    return _over_the_box(Program(-g, low, high))


def step_bounds(
    q: ArrayLike,
    position_lower: ArrayLike,
    position_upper: ArrayLike,
    velocity_lower: ArrayLike,
    velocity_upper: ArrayLike,
    dt: float,
) -> tuple[Vector, Vector]:
    """Return the joint velocities that keep both limits for one step (Eq. 12).

    The velocity limits intersected with (q_l - q) / dt <= qd <= (q_u - q) / dt. The result is
    empty (lower > upper) if velocity limits without 0 demand a motion the position forbids.

    Args:
        q: (n,) rad.
        position_lower: (n,) rad, infinite where there is no limit.
        position_upper: (n,) rad, infinite where there is no limit.
        velocity_lower: (n,) rad/s, finite.
        velocity_upper: (n,) rad/s, finite.
        dt: s, the step, > 0.

    Returns:
        lower, upper: (n,) rad/s.

    Raises:
        InputError: wrong shapes, a number that is not finite, dt not positive, or a joint that
            starts outside its position limits.
    """
    q = _finite("q", q)
    n = q.size
    low = _vector("position_lower", position_lower, n)
    high = _vector("position_upper", position_upper, n)
    slow = _finite("velocity_lower", velocity_lower, n)
    fast = _finite("velocity_upper", velocity_upper, n)
    if not (np.isfinite(dt) and dt > 0):
        raise InputError("dt", dt, "a step must be finite and longer than zero")
    outside = ~((low - AT_LIMIT <= q) & (q <= high + AT_LIMIT))  # nan limits count as outside
    if outside.any():
        i = int(np.argmax(outside))
        raise InputError("q", f"joint {i + 1} at {q[i]}", f"must lie in [{low[i]}, {high[i]}]")
    back, ahead = np.minimum(low - q, 0.0) / dt, np.maximum(high - q, 0.0) / dt
    return np.maximum(slow, back), np.minimum(fast, ahead)


def build_hitting_speed(
    jacobian: ArrayLike,
    direction: ArrayLike,
    lower: ArrayLike,
    upper: ArrayLike,
    straight: bool = False,
) -> Program:
    """Return the linear program of the maximum hitting speed (Eq. 9): minimise -h^T J qd.

    Args:
        jacobian: (3, n) m/rad, linear velocity of the contact per joint velocity.
        direction: (3,), of any length but zero.
        lower: (n,) rad/s.
        upper: (n,) rad/s.
        straight: add the rows B^T J qd = 0, B (3, 2) an orthonormal complement of h: no motion
            sideways. B is turned so that its rows are orthogonal, and a row below `rank_floor` is
            zero: sideways the arm cannot move there, whatever its round-off says.

    Raises:
        InputError: wrong shapes, or a number that is not finite.
    """
    J = real(jacobian, "jacobian", "three rows, one column per joint")
    if J.ndim != 2 or J.shape[0] != 3:
        raise InputError("jacobian", f"shape {J.shape}", "three rows, one column per joint")
    _finite("jacobian", J.ravel())
    h = unit(direction)
    if h.shape != (3,):
        raise InputError("direction", f"shape {h.shape}", "one direction of three numbers")
    n = J.shape[1]
    low, high = _finite("lower", lower, n), _finite("upper", upper, n)
    if not straight:
        return Program(-(h @ J), low, high)
    return Program(-(h @ J), low, high, A=_sideways(J, h), b=np.zeros(2))


def solve_hitting_speed(
    jacobian: ArrayLike,
    direction: ArrayLike,
    lower: ArrayLike,
    upper: ArrayLike,
    straight: bool = False,
) -> HittingSpeed:
    """Return the maximum hitting speed (Eq. 9) and a joint velocity that attains it.

    Arguments as `build_hitting_speed`.

    Raises:
        InputError: wrong shapes, or a number that is not finite.
        InfeasibleError: no velocity within the limits meets the rows.
        SolverError: the answer could not be certified.
    """
    quick = certified_motion(jacobian, direction, lower, upper) if straight else None
    if quick is None:
        program = build_hitting_speed(jacobian, direction, lower, upper, straight)
        if not straight:
            speed, qd = _over_the_box(program)
            own = residuals(program, qd, program.b, program.d, -program.c)
            return HittingSpeed(speed, qd, own)
        given = (jacobian, direction, lower, upper)
        quick = certified_motion(*(np.array(values, dtype=float) for values in given))
    if quick is not None:
        speed, qd, primal, gap = quick
        return HittingSpeed(speed, qd, Residuals(primal, 0.0, gap))
    found = solve(program)
    return HittingSpeed(-float(program.c @ found.x), found.x, found.residuals)


def _over_the_box(program: Program) -> tuple[float, Vector]:
    """Return the speed and velocity of a program without rows, in closed form."""
    blocked = show_blocked(program)
    if blocked is not None:
        raise InfeasibleError(blocked.reason, {"shortfall": blocked.shortfall})
    g, low, high = -program.c, program.lower, program.upper
    qd = np.where(g > 0, high, np.where(g < 0, low, np.clip(0.0, low, high)))
    return float(g @ qd), qd


def _sideways(J: Matrix, h: Vector) -> Matrix:
    B = np.linalg.svd(h[None, :])[2][1:].T
    _, s, Vt = np.linalg.svd(B.T @ J, full_matrices=False)
    rows = np.zeros((2, J.shape[1]))
    rows[: s.size] = np.where(s > rank_floor(J), s, 0.0)[:, None] * Vt
    return rows


def _vector(name: str, values: ArrayLike, size: int | None = None) -> Vector:
    array = real(values, name, "one number per joint")
    if array.ndim != 1 or size not in (None, array.size):
        expected = "one number per joint" + ("" if size is None else f", {size} of them")
        raise InputError(name, f"shape {array.shape}", expected)
    return array


def _finite(name: str, values: ArrayLike, size: int | None = None) -> Vector:
    array = _vector(name, values, size)
    if not np.isfinite(array).all():
        raise InputError(name, array.tolist(), "every number must be finite")
    return array
