"""A rigorous no: interval branch and bound that excludes every configuration.

A box of configurations is excluded when the contact is nowhere in it at the object, or when the
next origin is nowhere behind it; both bounded by the natural extension and by the mean value form.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from hitjoints.built import chain_of
from hitjoints.kernels import Interval, bisect
from hitjoints.kernels.formulas.links import TracedArm, dot, minus
from hitjoints.kernels.tape.backends import over_boxes
from hitjoints.kernels.tape.trace import Scalar, Tracer, Vector
from hitjoints.planning.objectives.problem_program import AWAY_MARGIN
from hitjoints.planning.proof.branching import branch

if TYPE_CHECKING:
    from hitjoints.model.robot import Contact, Robot
    from hitjoints.planning.task import Task
    from hitjoints.types import Array

MOST_BOXES = 40_000
ROUNDING = 1e-12  # m, of the constants, which are rounded when recorded


@dataclass(frozen=True)
class Exclusion:
    """What branch and bound found.

    Attributes:
        proved: no configuration within the limits is left.
        boxes: how many were looked at.
    """

    proved: bool
    boxes: int


def exclude(task: Task, away: bool) -> Exclusion:
    """Try to prove that no configuration puts the contact at the object.

    Args:
        task: what is asked, with a position.
        away: only configurations that meet the away condition count.
    """
    assert task.target is not None
    robot, bound = task.robot, _Bounds(task, away)
    m = bound.movers
    # A continuous joint is searched over one turn.
    low, high = (end[None, :m] for end in robot.finite_limits)
    proved = False

    def look(low: Array, high: Array) -> tuple[Array, Array]:
        nonlocal proved
        least, most = bound(low, high)
        left = ((least[:3] <= 0) & (most[:3] >= 0)).all(axis=0)
        if away:
            left &= least[3] <= -AWAY_MARGIN
        proved = not left.any()
        halves = bisect(low[left], high[left])
        return halves.lower, halves.upper

    boxes = branch(low, high, look, MOST_BOXES)
    return Exclusion(proved, boxes)


class _Bounds:
    """Bounds of the contact's distance from the object along each axis, and of the away gap."""

    def __init__(self, task: Task, away: bool) -> None:
        beyond = task.beyond if away else None
        self.movers, self.count, self.program = _program(task.robot, task.contact, beyond)
        given = np.concatenate((np.asarray(task.target), task.direction))
        self.shared = [Interval(a, a) for a in given[:, None]]

    def __call__(self, low: Array, high: Array) -> tuple[Array, Array]:
        """Return lower and upper bounds (values, B) over boxes (B, m)."""
        middle = 0.5 * (low + high)
        half = np.maximum(high - middle, middle - low)
        box = [Interval(a, b) for a, b in zip(low.T, high.T, strict=True)]
        whole = self.program([*box, *self.shared], len(low))
        centre = self.program([*(Interval(a, a) for a in middle.T), *self.shared], len(low))
        size = np.maximum(np.abs(whole.lower), np.abs(whole.upper))[self.count :]
        radius = np.einsum("vmb,bm->vb", size.reshape(self.count, self.movers, -1), half)
        radius = radius * (1 + ROUNDING) + ROUNDING
        values = slice(self.count)
        return (
            np.maximum(whole.lower[values] - ROUNDING, centre.lower[values] - radius),
            np.minimum(whole.upper[values] + ROUNDING, centre.upper[values] + radius),
        )


@lru_cache(maxsize=64)
def _program(
    robot: Robot, contact: Contact, beyond: Contact | None
) -> tuple[int, int, Callable[..., Interval]]:
    """Return how many joints m move the points, how many values there are, and the program.

    It takes boxes of the m joints, the target and the direction; it gives the values and then
    their derivatives.
    """
    chain = chain_of(robot)
    points = [contact]
    if beyond is not None:
        points += [type(contact)(contact.joint), beyond]
    attached = [chain.attach(point.joint, point.offset) for point in points]
    m = max(last for last, _ in attached)
    tracer = Tracer(m + 6)
    target, (x, y, z) = tracer.inputs[m : m + 3], tracer.inputs[m + 3 :]
    # The joints that move none of the points do not enter their formulas.
    arm = TracedArm(chain, (*tracer.inputs[:m], *[0.0] * (chain.size - m)))
    places = [arm.position(last - 1, point) for last, point in attached]
    axes: list[Vector] = [(1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)]
    values: list[Scalar] = [places[0][k] - target[k] for k in range(3)]
    slopes = [_row(arm, attached[0], axis)[:m] for axis in axes]
    if beyond is not None:
        values.append(dot((x, y, z), minus(places[2], places[1])))
        near, far = (_row(arm, point, (x, y, z))[:m] for point in attached[1:])
        slopes.append([b - a for a, b in zip(near, far, strict=True)])
    flat = [slope for row in slopes for slope in row]
    return m, len(values), over_boxes(tracer.program([*values, *flat]))


def _row(arm: TracedArm, attached: tuple[int, Any], direction: Vector) -> list[Scalar]:
    """Return J^T a of a point."""
    last, point = attached
    reaches = arm.reaches(last - 1, point) if last else []
    return arm.row(reaches, arm.in_links(direction))
