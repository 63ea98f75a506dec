"""A planning problem as one program: objective, constraints and their derivatives in one call.

It is recorded, compiled and compared with Pinocchio once for an arm, a contact and a kind of
problem; the hit is among its inputs.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from hitjoints.built import chain_of, refused_by_name
from hitjoints.hitting.drive_limits import drive_limits
from hitjoints.kernels.formulas.links import dot
from hitjoints.kernels.formulas.speeds import product
from hitjoints.kernels.tape.backends import evaluate_points, prepare
from hitjoints.kernels.tape.trace import Scalar, Tracer, Vector, where_less
from hitjoints.kernels.verify import check, samples
from hitjoints.planning.objectives.stopping_room import StoppingRoom
from hitjoints.planning.objectives.traced_hit import Given, TracedHit

if TYPE_CHECKING:
    from collections.abc import Sequence

    from hitjoints.model.robot import Contact, Robot
    from hitjoints.planning.objectives.objective import Objective
    from hitjoints.types import Array

AWAY_MARGIN = 1e-6
"""The away condition is strict; h . (chi_{k+1} - chi_k) <= -1e-6 m is closed, and implies it."""

CHECKED = ("mobility", "mobility_gradient", "speed", "position", "jacobian")
"""Quantities that a program gives besides, as kernels do."""


@dataclass(frozen=True)
class Form:
    """What distinguishes the programs of an arm.

    Attributes:
        contact: what hits.
        beyond: the point the away condition compares with.
        objective: what is maximised.
        moving: the joint velocities are variables.
        away: the away condition is a constraint.
        reached: a flux is, as its shortfall in the logarithm.
        delivered: a flux is, and room to stop as well.
        seen: directions in which the contact has to be at the target, 0 for none.
        sideways: directions in which it must not move.
        blind: what it misses by in other directions is limited.
        locked: the inertia is that of locked joints, given beside x with its gradient.
    """

    contact: Contact
    beyond: Contact
    objective: type[Objective]
    moving: bool
    away: bool
    reached: bool
    delivered: bool
    seen: int
    sideways: int
    blind: bool
    locked: bool


class ProblemProgram:
    """The program of a form; threads share it.

    Args:
        robot: the arm.
        form: of the problem.

    Attributes:
        variables: m, of x.
        constraints: how many.
        logged: the constraint that is a flux, to be compared in the logarithm; None for none.
    """

    def __init__(self, robot: Robot, form: Form) -> None:
        n, self.form, self.robot = robot.n, form, robot
        self.variables = m = 2 * n if form.moving else n
        columns = m + (1 + n if form.locked else 0)
        self.shared = 12 + 3 * (form.seen + form.sideways)
        tracer = Tracer(columns + self.shared)
        x, rest = tracer.inputs[:m], tracer.inputs[columns:]
        vectors: list[Vector] = [
            (rest[i], rest[i + 1], rest[i + 2]) for i in range(0, len(rest) - 3, 3)
        ]
        h, forward, target, *rows = vectors
        mass, flux, slack = rest[-3:]
        seen, sideways = rows[: form.seen], rows[form.seen :]
        chain = chain_of(robot)
        contact, here, there = (
            chain.attach(point.joint, point.offset)
            for point in (form.contact, type(form.contact)(form.contact.joint), form.beyond)
        )
        hit = TracedHit(
            chain,
            contact,
            (here, there),
            x[:n],
            x[n:] if form.moving else None,
            Given(h, forward, target, mass, flux),
            tracer.inputs[m:columns],
        )
        value, gradient = form.objective().formula(hit)
        if form.blind:
            value = where_less(slack, _unseen(hit.missed, seen), math.nan, value)
        parts, self.logged = _constraints(form, hit, seen, sideways)
        if form.delivered or form.objective.stopping:
            room = StoppingRoom(drive_limits(robot), robot.lower, robot.upper, contact[0])
            parts += room.formulas(x[:n], x[n:])
        self.constraints = len(parts)
        outputs: list[Scalar] = [
            value,
            *_padded(gradient, m),
            *(residual for residual, _ in parts),
            *(entry for _, slope in parts for entry in _padded(slope, m)),
            hit.gap[0] if form.away or not form.objective.keeps_away else math.nan,
            hit.any_mobility,
            *hit.hit.mobility(),
            *hit.hit.mobility_gradient(),
            *hit.hit.speed(),
            *hit.hit.position(),
            *hit.hit.jacobian(),
        ]
        self.runnable = prepare(tracer.program(outputs), columns, None, effort=0)
        self._verify(columns)

    def __call__(self, x: Array, shared: Array) -> Array:
        """Evaluate at x (N, m), with what is shown beside it: the outputs (K, N), to be cut."""
        return evaluate_points(self.runnable, x, shared)

    def cut(self, found: Array) -> tuple[Array, Array, Array, Array]:
        """Return the formula (N,), gradient (N, m), residuals (N, c) and slopes (N, c, m)."""
        m, c = self.variables, self.constraints
        slope = found[1 + m + c : 1 + m + c + c * m].reshape(c, m, found.shape[1])
        return (
            found[0],
            np.ascontiguousarray(found[1 : 1 + m].T),
            np.ascontiguousarray(found[1 + m : 1 + m + c].T),
            np.ascontiguousarray(slope.transpose(2, 0, 1)),
        )

    def seen(self, found: Array) -> dict[str, Array]:
        """Return the quantities of `CHECKED`, rows first, the gap and the mobility shown."""
        m, c, n = self.variables, self.constraints, self.robot.n
        ends = np.cumsum((1 + m + c + c * m, 1, 1, 1, n, 1, 3))
        _, gap, shown, mobility, gradient, speed, position, jacobian = np.split(found, ends)
        return {
            "gap": gap[0],
            "shown": shown[0],
            "mobility": mobility[0],
            "mobility_gradient": gradient.T,
            "speed": speed[0],
            "position": position.T,
            "jacobian": jacobian.reshape(3, n, found.shape[1]).transpose(2, 0, 1),
        }

    def _verify(self, columns: int) -> None:
        model = self.robot.model
        q, h, mass = samples(model)
        rows = []
        for point, direction in zip(q, h, strict=True):
            x, shared = np.zeros((1, columns)), np.ones(self.shared)
            x[0, : len(point)], shared[:3] = point, direction
            rows.append(self.seen(self(x, shared)))
        found = {name: np.array([[row[name][0] for row in rows]]) for name in CHECKED}
        contact = self.form.contact
        check(model, [(contact.joint, contact.offset)], (q, h, mass), found)


@lru_cache(maxsize=64)
def program_for(robot: Robot, form: Form) -> ProblemProgram:
    """Return the program of a form, kept."""
    with refused_by_name(robot):
        return ProblemProgram(robot, form)


def _constraints(
    form: Form,
    hit: TracedHit,
    seen: Sequence[Vector],
    sideways: Sequence[Vector],
) -> tuple[list[tuple[Scalar, list[Scalar]]], int | None]:
    """Return residuals with their gradients, and which of them is a flux."""
    parts: list[tuple[Scalar, list[Scalar]]] = []
    for direction in seen:
        parts.append((dot(direction, hit.missed), hit.row(direction)))
    if form.moving:
        for direction in sideways:
            row, bent = hit.row(direction), [dot(direction, turned) for turned in hit.bent]
            parts.append((product(row, hit.qd), [*bent, *row]))
    if form.away:
        gap, by = hit.gap
        parts.append((gap + AWAY_MARGIN, by))
    if form.delivered:
        parts.append(hit.short_of(hit.given.flux))
    if form.reached:
        reached, rising = hit.most_flux
        parts.append((reached, [-slope for slope in rising]))
        return parts, len(parts) - 1
    return parts, None


def _unseen(missed: Vector, seen: Sequence[Vector]) -> Scalar:
    """Square of what a contact misses the target by in the directions that it does not move in."""
    square = dot(missed, missed)
    for direction in seen:
        along = dot(direction, missed)
        square = square - along * along
    return square


def _padded(entries: Sequence[Scalar], size: int) -> list[Scalar]:
    return [*entries, *[0.0] * (size - len(entries))]
