"""What many rollouts of one contact start from: every row as `prepare` finds it, or why not."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from hitjoints.built import kernel_for
from hitjoints.dynamics.contact_point import ContactPoint
from hitjoints.errors import HitjointsError, InputError
from hitjoints.hitting.manipulability_posture import nearest_best
from hitjoints.hitting.step_length import wrong_step
from hitjoints.quantities import place_joint
from hitjoints.rollouts.prepare import AT_THE_OBJECT, prepare
from hitjoints.vectors import points

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from hitjoints.hit import Hit
    from hitjoints.kernels import Kernel
    from hitjoints.model.robot import Contact, Robot
    from hitjoints.types import Array


@dataclass(frozen=True, eq=False)
class Starts:
    """Rows ready to move.

    Attributes:
        hits: what is asked, N of them.
        target: (N, 3) m.
        direction: (N, 3).
        mass: (N,) kg.
        flux: (N,) m/s.
        q0: (N, n) rad.
        q_hit: (N, n) rad.
        inertia: (N,) kg, in the hitting configuration.
        posture: (N, n) rad, what the null space pulls to.
        ahead: (N,) m, the way to the object.
        refused: (N,) why a row cannot start; empty if it can.
    """

    hits: Sequence[Hit]
    target: Array
    direction: Array
    mass: Array
    flux: Array
    q0: Array
    q_hit: Array
    inertia: Array
    posture: Array
    ahead: Array
    refused: list[str]


def prepare_rows(
    robot: Robot, contact: Contact, hits: Sequence[Hit], q0: Array, q_hit: Array | None, dt: float
) -> Starts:
    """Find hitting configurations where they are not given, and postures, for many hits at once.

    Args:
        robot: the arm.
        contact: that all of them hit with.
        hits: N of them.
        q0: (N, n) rad.
        q_hit: (N, n) rad; by default found from q0, as `prepare` does.
        dt: s.
    """
    count, refused = len(hits), [""] * len(hits)
    target, direction = (
        np.array([getattr(hit, name) for hit in hits]) for name in ("position", "direction")
    )
    mass, flux = np.array([hit.mass for hit in hits]), np.array([hit.desired_flux for hit in hits])
    point = ContactPoint(robot, contact)

    def refuse(rows: Iterable[int]) -> None:
        """Let `prepare` say what is wrong with some rows, in its words."""
        for i in rows:
            try:
                end = None if q_hit is None else q_hit[i]
                found = prepare(robot, hits[i], q0=q0[i], q_hit=end)
                point.inertia(found.q_hit, hits[i].direction)
            except HitjointsError as error:
                refused[i] = str(error)

    outside = _outside(robot, q0)
    begin = np.clip(q0, robot.lower, robot.upper)
    if q_hit is None:
        rows = np.zeros(count, dtype=np.int64)
        placed = place_joint(robot, contact, points(target, "position"), start=begin, rows=rows)
        end, bad = placed.q, outside | ~placed.solved
    else:
        end, bad = np.clip(q_hit, robot.lower, robot.upper), outside | _outside(robot, q_hit)
    seen = seen_by(robot, contact)
    here, there = (seen(q, direction, threads=1) for q in (begin, np.array(end)))
    ahead = ((target - here["position"][0]) * direction).sum(axis=1)
    off = np.linalg.norm(there["position"][0] - target, axis=1)
    still = np.isinf(there["inertia"][0]) | np.isinf(here["inertia"][0])
    refuse(np.flatnonzero(bad | (ahead <= 0) | (off > AT_THE_OBJECT) | still).tolist())
    with np.errstate(invalid="ignore"):
        speed = np.minimum((1.0 + mass / here["inertia"][0]) * flux, here["speed"][0])
    for i, (v, way) in enumerate(zip(speed.tolist(), ahead.tolist(), strict=True)):
        wrong = "" if refused[i] else wrong_step(v, way, dt)
        if wrong:
            refused[i] = str(InputError("dt", dt, wrong))
    inertia, posture = there["inertia"][0], _postures(robot, contact, target, end, refused)
    return Starts(hits, target, direction, mass, flux, begin, end, inertia, posture, ahead, refused)


def seen_by(robot: Robot, contact: Contact) -> Kernel:
    """Return what many rollouts ask of a contact: one kernel for all of it."""
    return kernel_for(robot, (contact,), ("position", "jacobian", "inertia", "speed"))


def _outside(robot: Robot, q: Array) -> NDArray[np.bool_]:
    return np.asarray(((q < robot.lower) | (q > robot.upper)).any(axis=1))


def _postures(
    robot: Robot, contact: Contact, target: Array, near: Array, refused: list[str]
) -> Array:
    """Return the postures of greatest manipulability (N, n) for targets (N, 3)."""
    posture = near.copy()
    places, which = np.unique(target, axis=0, return_inverse=True)
    which = which.ravel()  # a column in NumPy 2.0
    order = np.argsort(which, kind="stable")
    cuts = np.flatnonzero(np.diff(which[order])) + 1
    for place, rows in zip(places.tolist(), np.split(order, cuts), strict=True):
        able = np.array([i for i in rows if not refused[i]], dtype=np.int64)
        if not able.size:
            continue
        try:
            posture[able] = nearest_best(robot, contact, tuple(place), near[able])
        except HitjointsError as error:
            for i in able:
                refused[i] = str(error)
    return posture
