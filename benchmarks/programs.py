"""The programs of a hit: the straight speed (linear) and Eq. 12 (quadratic), against solvers."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

import hitjoints as hj
from benchmarks.compiled_eq12 import CompiledEq12, flat
from benchmarks.contest import Check, Peer, contest, near
from benchmarks.harness import Remark, Row, Work
from benchmarks.peers import osqp, programs
from hitjoints.evaluator import WORTH_COMPILING
from hitjoints.kernels import build_kernel
from hitjoints.programs.hitting_speed import build_hitting_speed, solve_hitting_speed
from hitjoints.programs.joint_velocity import build_joint_velocity
from hitjoints.programs.problem import Program
from hitjoints.programs.solver import solve
from hitjoints.programs.straight_answer import WORTH_COMPILING as FORMULAS_COMPILED
from hitjoints.programs.warm import WarmProgram

if TYPE_CHECKING:
    from hitjoints.types import Array

TARGETS = {
    ("straight hitting speed, one call", "DAQP"): ">= 0.5",
    ("Eq. 12 (quadratic), from scratch", "ProxQP by hand"): ">= 0.4",
    ("Eq. 12 along a hit", "DAQP, from scratch"): ">= 2",
}
"""What the gain over a solver should be at least."""
COUNT = 100
JOINT, MASS, FLUX, DT = 6, 2.0, 0.3, 0.002  # kg, m/s, s
H, AT = np.array([0.0, 1.0, 0.0]), np.array([0.5, 0.3, 0.5])
SIGNIFICANT = 1e-5  # what answers may differ by, relative to the largest number
FEASIBLE = 1e-6  # what rows and bounds may be missed by

LINEAR: dict[str, Callable[[], Any]] = {
    "HiGHS through SciPy": programs.Highs,
    "DAQP": programs.Daqp,
    "Clarabel": programs.Clarabel,
}
QUADRATIC: dict[str, Callable[[], Any]] = {
    "DAQP": programs.Daqp,
    "quadprog": programs.Quadprog,
    "ProxQP by hand": programs.ProxQP,
    "Clarabel": programs.Clarabel,
    "qpsolvers + OSQP": osqp.QpSolvers,
}
REPEATED: dict[str, Callable[[], Any]] = {
    "DAQP, from scratch": programs.Daqp,
    "quadprog, from scratch": programs.Quadprog,
    "ProxQP by hand, warm": programs.ProxQPInPlace,
    "OSQP set up once": osqp.OsqpInPlace,
}


def measure() -> list[Row | Remark]:
    """Return the gain of certified answers from scratch, of the batch kernel, and along a hit."""
    robot = hj.load_robot("iiwa14")
    q = np.random.default_rng(0).uniform(robot.lower, robot.upper, (COUNT, robot.n))
    speeds = [straight_speed(robot, row) for row in q]
    velocities = [eq12(robot, row) for row in q]
    return [
        *straight(robot, q, speeds),
        *one_call(robot, q, speeds),
        *batch(robot, q, speeds),
        *_meet("Eq. 12 (quadratic), from scratch", velocities, QUADRATIC),
        *along_a_hit(robot),
    ]


def straight(robot: hj.Robot, q: Array, speeds: Sequence[Program]) -> list[Row | Remark]:
    """Return the gain of the certified speed and velocities, from Jacobians as programs are."""
    limits = robot.velocity_lower, robot.velocity_upper
    given = [hj.jacobian(robot, row, JOINT) for row in q]

    def ours() -> list[Array]:
        return [solve_hitting_speed(J, H, *limits, straight=True).qd for J in given]

    for _ in range(FORMULAS_COMPILED // len(q) + 1):
        ours()
    what, named = "straight hitting speed (linear)", ("closed form, certified", ours, len(q))
    return contest(what, named, _peers(what, speeds, LINEAR), optimal(speeds))


def one_call(robot: hj.Robot, q: Array, speeds: Sequence[Program]) -> list[Row | Remark]:
    """Return the gain of the ordinary function, asked often enough to be compiled."""

    def ours() -> list[float]:
        return [hj.hitting_speed(robot, row, JOINT, H, straight=True) for row in q]

    for _ in range(WORTH_COMPILING // len(q) + 1):
        ours()
    best = np.array([-program.objective(solve(program).x) for program in speeds])

    def check(answer: Any) -> str:
        if isinstance(answer[0], float):  # ours: the speeds themselves
            return near(best, SIGNIFICANT)(answer)
        return optimal(speeds)(answer)

    named, what = ("hj.hitting_speed, compiled", ours, len(q)), "straight hitting speed, one call"
    return contest(what, named, _peers(what, speeds, LINEAR), check)


def batch(robot: hj.Robot, q: Array, speeds: Sequence[Program]) -> list[Row | Remark]:
    """Return the gain of the straight speed of many configurations at once."""
    kernel = build_kernel(robot.model, [(JOINT, (0.0, 0.0, 0.0))], ("straight_speed",))
    many = np.repeat(q, 500, axis=0)
    ours = ("llvm kernel, one thread", partial(kernel, many, H, threads=1), len(many))
    what, names = "straight hitting speed, batch", ("HiGHS through SciPy", "DAQP")
    peers = _peers(what, speeds, {name: LINEAR[name] for name in names})
    best = np.array([-program.objective(solve(program).x) for program in speeds])

    def check(answer: Any) -> str:
        if isinstance(answer, dict):  # ours: the speeds themselves
            return near(np.repeat(best, 500), SIGNIFICANT)(answer["straight_speed"][0])
        return optimal(speeds)(answer)

    return contest(what, ours, peers, check)


def along_a_hit(robot: hj.Robot) -> list[Row | Remark]:
    """Return the gain where each program differs little from the one before."""
    hit = hj.Hit(JOINT, AT, H, MASS, FLUX)
    path = hj.rollout(robot, hit, dt=DT)
    q = path.rows["q"][: path.steps]
    series = [eq12(robot, row) for row in q]
    warm = WarmProgram(robot.n, 1)

    def ours() -> list[Array | None]:
        return [warm.solve(*arguments(program)) for program in series]

    compiled, given = CompiledEq12(robot.n), [_given(robot, row) for row in q]

    def fast() -> list[Array]:
        return [compiled(numbers) for numbers in given]

    rows: list[Row | Remark] = []
    for what, name, work in (
        ("Eq. 12 along a hit", "compiled, as in a control step", fast),
        ("Eq. 12 along a hit, any program", "warm, residuals checked", ours),
    ):
        peers = _peers(what, series, REPEATED)
        rows += contest(what, (name, work, len(series)), peers, optimal(series), repeats=15)
    return rows


def straight_speed(robot: hj.Robot, q: Array) -> Program:
    """Return the linear program of the straight hitting speed (Eq. 9) at q (n,) rad."""
    limits = robot.velocity_lower, robot.velocity_upper
    return build_hitting_speed(hj.jacobian(robot, q, JOINT), H, *limits, straight=True)


def eq12(robot: hj.Robot, q: Array) -> Program:
    """Return the quadratic program of Eq. 12 at q (n,) rad, for a field straight along h."""
    inertia = hj.directional_inertia(robot, q, JOINT, H)
    f = float(hj.required_speed(inertia, MASS, FLUX)) * H
    lower = np.maximum(robot.velocity_lower, (robot.lower - q) / DT)
    upper = np.minimum(robot.velocity_upper, (robot.upper - q) / DT)
    J = hj.jacobian(robot, q, JOINT)
    return build_joint_velocity(J, f, H, inertia, MASS, FLUX, lower, upper)


def _given(robot: hj.Robot, q: Array) -> Array:
    """Return the same program for the compiled formulas."""
    program = eq12(robot, q)
    inertia = hj.directional_inertia(robot, q, JOINT, H)
    f = float(hj.required_speed(inertia, MASS, FLUX)) * H
    J = hj.jacobian(robot, q, JOINT)
    return flat(J, f, H, float(program.b[0]), program.lower, program.upper)


def optimal(many: Sequence[Program]) -> Check:
    """Return a check of answers x: within rows and bounds, and of the least cost."""
    best = [solve(program) for program in many]

    def check(answers: Sequence[Any]) -> str:
        for program, x, found in zip(many, answers, best, strict=True):
            if x is None or not np.isfinite(x).all():
                return "a program is not solved"
            missed = np.abs(program.A @ x - program.b).max(initial=0.0)
            missed = max(missed, (program.lower - x).max(), (x - program.upper).max())
            if missed > FEASIBLE:
                return f"rows or bounds missed by {missed:.1g}"
            if program.H is not None:  # strictly convex: there is one answer
                wrong = near(found.x, SIGNIFICANT)(x)
            else:
                wrong = near([found.objective], SIGNIFICANT)([program.objective(x)])
            if wrong:
                return wrong
        return ""

    return check


def arguments(program: Program) -> tuple[Any, ...]:
    """Return what solvers are called with."""
    return program.H, program.c, program.A, program.b, program.lower, program.upper


def _meet(
    what: str, many: Sequence[Program], solvers: dict[str, Callable[[], Any]]
) -> list[Row | Remark]:
    def ours() -> list[Array]:
        return [solve(program).x for program in many]

    for _ in range(FORMULAS_COMPILED // len(many) + 1):
        ours()
    named = ("formulas, certified", ours, len(many))
    return contest(what, named, _peers(what, many, solvers), optimal(many))


def _peers(what: str, many: Sequence[Program], solvers: dict[str, Callable[[], Any]]) -> list[Peer]:
    given = [arguments(program) for program in many]

    def theirs(solver: Callable[[], Any]) -> Callable[[], Work]:
        def make() -> Work:
            run = solver()
            return lambda: [run(*terms) for terms in given]

        return make

    return [
        Peer(name, theirs(solver), len(many), TARGETS.get((what, name), ""))
        for name, solver in solvers.items()
    ]
