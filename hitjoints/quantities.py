"""The quantities of a hit for one configuration or a million: the border where input is checked.

One configuration (n,) goes to Pinocchio, and to compiled formulas once a quantity has been asked
for thousands of times; rows of them (N, n) go to the batch kernels.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from hitjoints.built import chain_of, kernel_for
from hitjoints.errors import InputError
from hitjoints.tolerances import moves
from hitjoints.vectors import all_finite, points, unit

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from hitjoints.kernels import Placement
    from hitjoints.model.robot import Contact, Robot

MOST_KEPT = 64
"""Quantities of a robot whose calls are counted: who makes a new contact for each call gains none
by compiling."""


def directional_inertia(
    robot: Robot, q: ArrayLike, contact: Contact | int, direction: ArrayLike
) -> Any:
    """Return lambda_h = 1 / (h^T J M^-1 J^T h), the inertia felt at a contact along a direction.

    Args:
        robot: the arm.
        q: (n,) or (N, n) rad. Limits are not asked for: the inertia exists beyond them too.
        contact: joint number or Contact.
        direction: (3,), or (N, 3) for rows; of any length but zero.

    Returns:
        kg: a float for one configuration, (N,) for rows. A row whose direction is infeasible
        holds inf.

    Raises:
        InputError: no such joint, wrong shapes, or a number that is not finite.
        InfeasibleError: one configuration, in which the contact cannot move along the direction.

    Source: Khatib, Inertial properties in robotic manipulation, IJRR 14(1), 1995; Eq. 1.
    """
    quick = _quick(robot, contact, "inertia", q, direction)
    if quick is not None:
        return quick
    contact, q, h = _shaped(robot, q, contact, direction)
    if q.ndim == 2:
        return _batch(robot, contact, "inertia", q, h)
    from hitjoints.dynamics.inertia import inertia_along

    return inertia_along(robot, q, contact, h)


def directional_inertia_gradient(
    robot: Robot, q: ArrayLike, contact: Contact | int, direction: ArrayLike
) -> NDArray[np.float64]:
    """Return the exact gradient of the directional inertia by the joint positions.

    Args:
        robot: the arm.
        q: (n,) or (N, n) rad.
        contact: joint number or Contact.
        direction: (3,), or (N, 3) for rows; of any length but zero.

    Returns:
        kg/rad: (n,) for one configuration, (N, n) for rows. A row whose direction is infeasible
        holds nan.

    Raises:
        InputError: no such joint, wrong shapes, or a number that is not finite.
        InfeasibleError: one configuration, in which the contact cannot move along the direction.
    """
    quick = _quick(robot, contact, "gradient", q, direction)
    if quick is not None:
        return np.asarray(quick)
    contact, q, h = _shaped(robot, q, contact, direction)
    if q.ndim == 2:
        return _batch(robot, contact, "gradient", q, h)
    from hitjoints.dynamics.inertia import inertia_and_gradient_along

    return inertia_and_gradient_along(robot, q, contact, h)[1]


def hitting_speed(
    robot: Robot,
    q: ArrayLike,
    contact: Contact | int,
    direction: ArrayLike,
    straight: bool = False,
) -> Any:
    """Return the maximum speed of a contact along a direction within the velocity limits (Eq. 9).

    Args:
        robot: as `directional_inertia`.
        q: as `directional_inertia`.
        contact: as `directional_inertia`.
        direction: as `directional_inertia`.
        straight: demand that the contact moves along the direction alone, not sideways as well.

    Returns:
        m/s: a float for one configuration, (N,) for rows. Zero for an infeasible direction.

    Raises:
        InputError: as `directional_inertia`.
        SolverError: the linear program's answer could not be certified.
    """
    output = "straight_speed" if straight else "speed"
    quick = _quick(robot, contact, output, q, direction)
    if quick is not None:
        return quick
    contact, q, h = _shaped(robot, q, contact, direction)
    if q.ndim == 2:
        return _batch(robot, contact, output, q, h)
    from hitjoints.dynamics.kinematics import jacobian
    from hitjoints.programs.hitting_speed import box_speed, solve_hitting_speed

    jac = jacobian(robot, q, contact)
    limits = robot.velocity_lower, robot.velocity_upper
    if not moves(jac, h @ jac):
        return 0.0
    if straight:
        return solve_hitting_speed(jac, h, *limits, straight=True).speed
    return box_speed(h @ jac, *limits)[0]


def place_joint(
    robot: Robot,
    joint: Contact | int,
    positions: ArrayLike,
    seed: int = 0,
    *,
    start: ArrayLike | None = None,
    rows: NDArray[np.int64] | None = None,
    threads: int | None = None,
) -> Placement:
    """Find configurations that put a joint (or contact) at given positions: batched IK (Eq. 8).

    Args:
        robot: the arm.
        joint: joint number or Contact.
        positions: (3,) or (N, 3) m. Repeat a position to sample its self-motion.
        seed: of the random starts. Same seed, same answer, whatever the number of threads.
        start: (n,) or (N, n) rad, where the first attempt starts; at random when not given.
        rows: (N,) numbers that key the random starts, 0..N-1 when not given. Who splits a batch
            passes the numbers in the whole, and gets the same answer.
        threads: worker threads; all available processors when not given.

    Returns:
        `.q` (N, n) rad within the limits, without a start the turns of 2 pi nearest to home;
        `.solved` (N,) to 1e-9 m; `.error` (N,) m. A row that is not solved holds the closest
        configuration found.

    Raises:
        InputError: no such joint, wrong shapes, or a number that is not finite.
    """
    contact = robot.contact(joint)
    targets = np.atleast_2d(points(positions, "positions"))
    if start is not None:
        start = robot.configuration(start, "start")
        if start.ndim == 2 and len(start) != len(targets):
            raise InputError("start", f"{len(start)} rows", f"one, or {len(targets)} as positions")
    from hitjoints.kernels import place

    placed = place(
        robot.model,
        (contact.joint, contact.offset),
        targets,
        seed=seed,
        start=start,
        rows=rows,
        threads=threads,
        chain=chain_of(robot),
        data=robot.data,
    )
    return placed if start is not None else replace(placed, q=robot.nearest_turn(placed.q))


def checked(
    robot: Robot, q: ArrayLike, contact: Contact | int, direction: ArrayLike
) -> tuple[Contact, NDArray[np.float64], NDArray[np.float64]]:
    """Return contact, configurations and unit directions; errors as `directional_inertia`."""
    contact, q, h = _shaped(robot, q, contact, direction)
    return contact, robot.configuration(q), h


def _shaped(
    robot: Robot, q: ArrayLike, contact: Contact | int, direction: ArrayLike
) -> tuple[Contact, NDArray[np.float64], NDArray[np.float64]]:
    """Return the same; rows (N, n) may hold numbers that are not finite."""
    contact, q, h = robot.contact(contact), robot.configuration(q, finite=False), unit(direction)
    if q.ndim == 1:
        q = robot.configuration(q)
    if h.ndim == 2 and (q.ndim == 1 or len(h) != len(q)):
        expected = "one direction" if q.ndim == 1 else f"one direction, or {len(q)} as in q"
        raise InputError("direction", f"{len(h)} rows", expected)
    return contact, q, h


def _batch(robot: Robot, contact: Contact, output: str, q: Any, h: Any) -> NDArray[np.float64]:
    def check(start: int, stop: int) -> None:
        if not all_finite(q[start:stop]):
            robot.configuration(q)  # which raises

    values = kernel_for(robot, (contact,), (output,))(q, h, check=check)[output][0]
    return np.asarray(values)


def _quick(
    robot: Robot, contact: Contact | int, output: str, q: ArrayLike, direction: ArrayLike
) -> Any:
    """Return the compiled answer for one configuration; None if the ordinary way has to answer."""
    if type(q) is not np.ndarray or q.ndim != 1:
        return None
    try:
        quick = robot.kept.get((output, contact))
    except TypeError:  # no number, no contact
        return None
    if quick is None:
        if len(robot.kept) >= MOST_KEPT:
            return None
        from hitjoints.evaluator import Quick

        quick = robot.kept[output, contact] = Quick(robot, contact, output)
    return quick(q, direction)
