"""One configuration through the public functions against the bare Pinocchio calls."""

from __future__ import annotations

import numpy as np

import hitjoints as hj
from benchmarks import pinocchio_loop
from benchmarks.harness import Row, compare
from hitjoints.dynamics.inertia import inertia_and_gradient_along
from hitjoints.vectors import unit

CALLS = 2000


def measure() -> list[Row]:
    """Return the cost of checking input and wrapping results."""
    robot, joint = hj.load_robot("iiwa14"), 6
    rng = np.random.default_rng(0)
    qs = rng.uniform(robot.lower, robot.upper, (CALLS, robot.n))
    h = np.array([0.0, 1.0, 0.0])
    model, data, weightless = robot.model, robot.model.createData(), robot.weightless_model

    def bare() -> None:
        for q in qs:
            pinocchio_loop.gradient(model, weightless, data, q, joint, h)

    def together() -> None:
        contact = robot.contact(joint)
        for q in qs:
            inertia_and_gradient_along(robot, robot.configuration(q), contact, unit(h))

    def separately() -> None:
        for q in qs:
            hj.directional_inertia(robot, q, joint, h)
            hj.directional_inertia_gradient(robot, q, joint, h)

    peer = ("the same Pinocchio calls, bare", bare, CALLS)
    return [
        compare(
            "inertia and gradient, one configuration",
            (name, work, CALLS),
            peer,
            meaning="cost",
            target=target,
        )
        for name, work, target in (
            ("checked, in one call", together, "<= 2.5"),
            ("two public functions", separately, ""),
        )
    ]
