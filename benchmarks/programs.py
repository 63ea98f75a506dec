"""The maximum straight hitting speed, a linear program, against SciPy's HiGHS."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
from scipy.optimize import linprog

import hitjoints as hj
from benchmarks.harness import Row, compare
from hitjoints.kernels import build_kernel
from hitjoints.programs.speed import solve_hitting_speed

COUNT = 200
H = np.array([0.0, 1.0, 0.0])
SIDEWAYS = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])


def measure() -> list[Row]:
    """Return the gain of ProxQP with our certificate, and of the batch kernel."""
    robot = hj.load_robot("iiwa14")
    q = np.random.default_rng(0).uniform(robot.lower, robot.upper, (COUNT, robot.n))
    jacobians = [hj.jacobian(robot, row, 6) for row in q]
    limits = robot.velocity_lower, robot.velocity_upper
    kernel = build_kernel(robot.model, [(6, (0.0, 0.0, 0.0))], ("straight_speed",))

    def certified() -> None:
        for jac in jacobians:
            solve_hitting_speed(jac, H, *limits, straight=True)

    def highs() -> None:
        bounds: Any = np.column_stack(limits)
        for jac in jacobians:
            linprog(-H @ jac, A_eq=SIDEWAYS @ jac, b_eq=[0, 0], bounds=bounds, method="highs")

    many = np.repeat(q, 500, axis=0)
    peer = ("SciPy HiGHS", highs, COUNT)
    return [
        compare("straight hitting speed", ("ProxQP, certified", certified, COUNT), peer),
        compare(
            "straight hitting speed, batch",
            ("llvm kernel, one thread", partial(kernel, many, H, threads=1), len(many)),
            peer,
        ),
    ]
