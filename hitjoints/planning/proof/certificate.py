"""A rigorous upper bound of Eq. 14: interval branch and bound over the joints beyond the contact.

With the joints that place the contact fixed, its inertia depends on the others alone, and so does
every other objective: the pull J^T h and with it the speed are constant, the flux grows with the
inertia. The formulas are recorded once for an arm and a contact.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from hitjoints.built import chain_of
from hitjoints.kernels import Interval
from hitjoints.kernels.formulas.links import TracedArm, dot, minus
from hitjoints.kernels.formulas.mass_matrix import variation
from hitjoints.kernels.outputs import record
from hitjoints.kernels.tape.backends import over_boxes
from hitjoints.kernels.tape.trace import Scalar, Tracer
from hitjoints.planning.objectives.problem_program import AWAY_MARGIN
from hitjoints.planning.objectives.traced_hit import LEAST_MOBILITY
from hitjoints.planning.proof.branching import branch

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from hitjoints.model.robot import Contact, Robot
    from hitjoints.planning.task import Task
    from hitjoints.types import Array

GAP = 0.01
"""The bound is tight enough when it exceeds the value found by no more than this share."""

MOST_BOXES = 120_000
ROUNDING = 1e-9
"""Share by which bounds are widened for the constants, which are rounded when recorded."""


@dataclass(frozen=True)
class Certificate:
    """What branch and bound proved.

    Attributes:
        inertia: kg, the value found.
        upper_bound: kg; no posture of the joints searched, within their limits (and the away
            condition), has more.
        gap: upper_bound / inertia - 1.
        proved: the gap is at most 1 %.
        joints: the joints searched (1-based); the others are fixed.
        boxes: how many were bounded.
    """

    inertia: float
    upper_bound: float
    gap: float
    proved: bool
    joints: tuple[int, ...]
    boxes: int

    def as_dict(self) -> dict[str, Any]:
        """Return the attributes by name."""
        return asdict(self)


def free_joints(task: Task) -> tuple[int, ...]:
    """Return the joints (1-based) that leave the contact where it is."""
    contact = task.contact
    last = chain_of(task.robot).attach(contact.joint, contact.offset)[0]
    return tuple(range(last + 1, task.robot.n + 1))


def certify(task: Task, q: Array, joints: tuple[int, ...] | None = None) -> Certificate:
    """Bound the inertia over the postures of some joints, the others fixed as in q.

    Args:
        task: what is asked; its away condition restricts the postures if it is set.
        q: (n,) rad, the configuration found, the best known.
        joints: which to search (1-based), all of them beyond the contact; every joint that
            leaves the contact where it is when not given.
    """
    joints = free_joints(task) if joints is None else joints
    at = np.array(joints, dtype=int) - 1
    bound = _Bound(task, q, at)
    robot = task.robot
    # A continuous joint is searched over one turn.
    low, high = (end[None, at] for end in robot.finite_limits)
    found = 1.0 / float(bound.at(q[None, at]).upper[0, 0])
    closed, left = found, 0.0

    def look(low: Array, high: Array) -> tuple[Array, Array]:
        nonlocal closed, left
        upper, admissible, reduction = bound(low, high)
        todo = admissible & (upper > (1.0 + GAP) * found)
        closed = max(closed, float(upper[admissible & ~todo].max(initial=0.0)))
        left = float(upper[todo].max(initial=0.0))
        if not len(at):  # no joint to cut by: what rounding leaves open stays open
            return low[:0], high[:0]
        return _cut(low[todo], high[todo], reduction[todo])

    visited = branch(low, high, look, MOST_BOXES)
    bounded = max(closed, left)
    return Certificate(
        found,
        bounded,
        bounded / found - 1.0,
        bounded <= (1.0 + GAP) * found,
        joints,
        visited,
    )


class _Bound:
    """Bounds over boxes of the joints `at`, the others as in q.

    For every u, 2 g . u - u^T M u is at most the mobility g^T M^-1 g; with u = M^-1 g at a box's
    centre it touches it there. It needs no factor of M over intervals, and its derivative varies
    little: its mean value form is the sharpest bound known here.
    """

    def __init__(self, task: Task, q: Array, at: NDArray[np.intp]) -> None:
        self.q, self.joints, self.away = q, at, task.away
        self.point, self.program = _programs(
            task.robot, task.contact, task.beyond if task.away else None, tuple(at.tolist())
        )
        self.h = [_exactly(np.array([a])) for a in task.direction]

    def at(self, x: Array) -> Interval:
        """Bounds (1 + n, B) of the mobility (1/kg) and of the response u at points x (B, d)."""
        massless = _exactly(np.zeros(1))
        return self.point([*self._box(x, x), *self.h, massless], len(x))

    def __call__(self, low: Array, high: Array) -> tuple[Array, NDArray[np.bool_], Array]:
        """Return upper bounds (B,) of the inertia, which boxes may hold an admissible posture,
        and what each side (B, d) contributes to the width of the bound.
        """
        middle, sides = 0.5 * (low + high), low.shape[1]
        half = np.maximum(high - middle, middle - low)
        response = [_exactly(u) for u in self.at(middle).lower[1:]]
        centre = self.program([*self._box(middle, middle), *self.h, *response], len(low))
        whole = self.program([*self._box(low, high), *self.h, *response], len(low))
        steepest = np.maximum(np.abs(whole.lower), np.abs(whole.upper))[1 : 1 + sides].T
        reduction = np.where(half > 0, steepest * half, 0.0)
        least = np.fmax(whole.lower[0], centre.lower[0] - reduction.sum(axis=1) * (1 + ROUNDING))
        with np.errstate(divide="ignore"):
            upper = np.where(least > LEAST_MOBILITY, 1.0 / least, np.inf) * (1 + ROUNDING)
        admissible = np.ones(len(low), dtype=bool)
        if self.away:
            admissible = whole.lower[1 + sides] <= -AWAY_MARGIN + ROUNDING
        return upper, admissible, reduction

    def _box(self, low: Array, high: Array) -> list[Interval]:
        """Return every joint's interval, of the others' the one number."""
        box = [_exactly(np.array([angle])) for angle in self.q]
        for joint, a, b in zip(self.joints, low.T, high.T, strict=True):
            box[joint] = Interval(a, b)
        return box


def _exactly(x: Array) -> Interval:
    return Interval(x, x)


@lru_cache(maxsize=64)
def _programs(
    robot: Robot, contact: Contact, beyond: Contact | None, joints: tuple[int, ...]
) -> tuple[Callable[..., Interval], Callable[..., Interval]]:
    """Return programs over boxes of all joints, and the direction.

    The first takes a mass as well, and gives the mobility and the response u. The second takes u,
    and gives the lower bound of the mobility, its derivatives by some joints (counted from 0),
    and with a point beyond the contact the away condition's gap.
    """
    chain, n = chain_of(robot), robot.n
    attached = chain.attach(contact.joint, contact.offset)
    point = over_boxes(record(chain, [attached], ("mobility", "response")))
    tracer = Tracer(2 * n + 3)
    h = tracer.inputs[n], tracer.inputs[n + 1], tracer.inputs[n + 2]
    arm = TracedArm(chain, tracer.inputs[:n])
    reaches = arm.reaches(attached[0] - 1, attached[1]) if attached[0] else []
    u: list[Scalar] = list(tracer.inputs[n + 3 :])
    value, *gradient = variation(arm, reaches, arm.in_links(h), u)
    outputs = [value, *(gradient[i] for i in joints)]
    if beyond is not None:
        ends = [
            chain.attach(end.joint, end.offset) for end in (type(contact)(contact.joint), beyond)
        ]
        here, there = (arm.position(last - 1, place) for last, place in ends)
        outputs.append(dot(h, minus(there, here)))
    return point, over_boxes(tracer.program(outputs))


def _cut(low: Array, high: Array, reduction: Array) -> tuple[Array, Array]:
    """Cut every box in two across the side that blurs its bound most."""
    rows = np.arange(len(low))
    unknown = ~np.isfinite(reduction).all(axis=1, keepdims=True)
    side = np.argmax(np.where(unknown, high - low, reduction), axis=1)
    # An inertia that is flat is cut for the away condition's sake.
    flat = reduction[rows, side] <= 0
    side = np.where(flat, np.argmax(high - low, axis=1), side)
    middle = 0.5 * (low[rows, side] + high[rows, side])
    first, second = high.copy(), low.copy()
    first[rows, side] = second[rows, side] = middle
    return np.concatenate((low, second)), np.concatenate((first, high))
