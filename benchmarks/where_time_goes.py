"""Where the time of public calls goes: `python -m benchmarks.where_time_goes [--write]`.

Each call is timed whole, and so are the parts it is made of; what is left is named, too. Times are
the least of many repeats, in processor time, so that a busy machine hardly shows.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

import hitjoints as hj
from benchmarks.peers.pinocchio import PinocchioArm
from benchmarks.report import circumstances
from hitjoints.evaluator import WORTH_COMPILING
from hitjoints.hitting.controller import Controller
from hitjoints.kernels import build_kernel
from hitjoints.kernels.tape.scalar import ScalarProgram
from hitjoints.kernels.tape.trace import Tracer
from hitjoints.rollouts.prepare import prepare
from hitjoints.vectors import all_finite

JOINT, MASS, FLUX = 6, 2.0, 0.3
H, AT = np.array([0.0, 1.0, 0.0]), np.array([0.5, 0.3, 0.5])
ROWS = 1_000_000
TABLE = Path(__file__).parents[1] / "docs" / "microseconds_table.md"


class Part(NamedTuple):
    """A piece of a call, in seconds."""

    name: str
    seconds: float


class Call(NamedTuple):
    """A public call: its whole time in seconds, the unit it is told in, and what it is made of."""

    name: str
    whole: float
    unit: str
    parts: list[Part]
    rest: str


def calls() -> Iterator[Call]:
    """Yield the calls, each measured now."""
    robot = hj.load_robot("iiwa14")
    q = robot.home.copy()
    yield from one_configuration(robot, q)
    yield many_rows(robot)
    yield one_target(robot)
    yield from steps(robot)
    yield planned(robot)
    yield from whole_hits(robot)


def one_configuration(robot: hj.Robot, q: Any) -> Iterator[Call]:
    """Yield the evaluator, and an ordinary function before and after it is compiled."""
    arm = PinocchioArm(robot, JOINT)
    by_hand = least(lambda: arm.inertia(q, H))
    first = Call(
        "`hj.directional_inertia`, the first calls",
        least(lambda: hj.directional_inertia(robot, [*q], JOINT, H)),  # a list is never compiled
        "us",
        [Part("Pinocchio: mass matrix, Jacobian, Cholesky factor", by_hand)],
        "checks of q, joint and direction; is the matrix definite, can the joint move",
    )
    evaluate = hj.Evaluator(robot, JOINT, ("inertia", "gradient"))
    own: Any = evaluate._own
    nothing = least(_empty().run)
    run = least(own.run)

    def copy() -> None:
        own.q[:], own.h[:] = q, H

    def answer() -> Any:
        return evaluate._make([part() for part in own.parts])

    parts = [
        Part("the formulas: mass matrix, inertia, gradient", run - nothing),
        Part("calling compiled code", nothing),
        Part("q and direction copied in", least(copy)),
        Part("a float and an array made of the answer", least(answer)),
    ]
    whole = least(lambda: evaluate(q, H))
    yield first
    yield Call("`hj.Evaluator`, inertia and gradient", whole, "us", parts, "looking at the input")
    for _ in range(WORTH_COMPILING + 1):
        hj.directional_inertia(robot, q, JOINT, H)
    single = hj.Evaluator(robot, JOINT, ("inertia",))
    yield Call(
        "`hj.directional_inertia`, asked often",
        least(lambda: hj.directional_inertia(robot, q, JOINT, H)),
        "us",
        [Part("an `Evaluator` for the inertia", least(lambda: single(q, H)))],
        "finding it",
    )


def many_rows(robot: hj.Robot) -> Call:
    """Return a batch, per row."""
    rows = np.random.default_rng(0).uniform(robot.lower, robot.upper, (ROWS, robot.n))
    kernel = build_kernel(robot.model, ((JOINT, (0.0, 0.0, 0.0)),))
    some, count = rows[:16384], ROWS
    return Call(
        f"`hj.directional_inertia`, {ROWS:,} rows, a row",
        least(lambda: hj.directional_inertia(robot, rows, JOINT, H), 5, 1) / count,
        "ns",
        [
            Part("the kernel", least(lambda: kernel(rows, H, threads=1), 5, 1) / count),
            Part("is every number finite", least(lambda: all_finite(some), 20, 20) / len(some)),
        ],
        "memory looked at twice, results handed out",
    )


def one_target(robot: hj.Robot) -> Call:
    """Return inverse kinematics of one target."""
    from hitjoints.kernels import ik
    from hitjoints.kernels.ik_single import SingleSearch

    seen: list[float] = []
    search = SingleSearch.__call__
    spot = ik._spot_check

    def timed(work: Callable[..., Any]) -> Callable[..., Any]:
        def call(*given: Any) -> Any:
            begin = time.perf_counter()
            answer = work(*given)
            seen.append(time.perf_counter() - begin)
            return answer

        return call

    whole = least(lambda: hj.place_joint(robot, JOINT, AT))
    parts = []
    for name, holder, attribute, work in (
        ("iterations and restarts", SingleSearch, "__call__", search),
        ("the answer compared with Pinocchio", ik, "_spot_check", spot),
    ):
        setattr(holder, attribute, timed(work))
        seen.clear()
        for _ in range(200):
            hj.place_joint(robot, JOINT, AT)
        setattr(holder, attribute, work)
        parts.append(Part(name, min(seen)))
    return Call("`hj.place_joint`, one target", whole, "us", parts, "checks, arrays, turns of 2 pi")


def steps(robot: hj.Robot) -> Iterator[Call]:
    """Yield a control step, compiled and with torque limits."""
    hit = hj.Hit(JOINT, AT, H, MASS, FLUX)
    found = prepare(robot, hit)
    control = Controller(robot, hit, found.q_hit)
    control.step(found.q0)
    compiled: Any = control._compiled
    nothing = least(_empty().run)
    yield Call(
        "`Controller.step`, compiled",
        least(lambda: control.step(found.q0)),
        "us",
        [
            Part(
                "the formulas: two configurations, field, Eq. 12-13, law",
                least(compiled._run) - nothing,
            ),
            Part("calling compiled code", nothing),
        ],
        "q copied in, the proof read, a `Step` made",
    )
    yield from steps_with_torques(robot, hit)


def steps_with_torques(robot: hj.Robot, hit: hj.Hit) -> Iterator[Call]:
    """Yield a step on the way, compiled, and the first, for which the motors have too little."""
    found = prepare(robot, hit, torque_limits=True)
    limited = Controller(robot, hit, found.q_hit, torque_limits=True)
    torques: Any = limited.torques
    q, qd = found.q0, np.zeros(robot.n)
    first = least(lambda: limited.step(q, qd), 20, 20)
    observed = least(lambda: limited.point.observe(q, H))
    for _ in range(20):
        qd = limited.step(q, qd)
        q = limited.follow(q, qd)
    impulses = torques.impulses(q, qd)
    parts = [
        Part("what the motors can change", least(lambda: torques.impulses(q, qd))),
        Part(
            "velocities from which joints can stop in time",
            least(lambda: torques.bounds(q, qd, impulses, *limited.bounds(q))),
        ),
        Part("is there a way to rest", least(lambda: torques.can_stop(q, qd))),
    ]
    whole, name = least(lambda: limited.step(q, qd), 20, 20), "`Controller.step`, torque limits"
    yield Call(f"{name}, on the way", whole, "us", parts, "the compiled step, checks")
    looked = Part("inertia, gradient, Jacobian by Pinocchio", observed)
    rest = "Eq. 12 and the law with torque rows, by an active set or ProxQP"
    yield Call(f"{name}, from rest", first, "us", [*parts, looked], rest)


def planned(robot: hj.Robot) -> Call:
    """Return a plan of one joint with its proof."""

    def plan(*, certificate: bool) -> float:
        return least(
            lambda: hj.plan(
                robot, AT, H, MASS, joints=[JOINT], objective="inertia", certificate=certificate
            ),
            5,
            1,
        )

    parts = [Part("the global search", plan(certificate=False))]
    return Call(
        "`hj.plan`, joint 6, inertia", plan(certificate=True), "ms", parts, "the certificate"
    )


def whole_hits(robot: hj.Robot) -> Iterator[Call]:
    """Yield a rollout alone, and one of many."""
    hit = hj.Hit(JOINT, AT, H, MASS, FLUX)
    found = prepare(robot, hit)
    given: Any = {"q0": found.q0, "q_hit": found.q_hit}
    one = hj.rollout(robot, hit, **given)
    stepping = float(np.median(one.step_times)) * one.steps
    yield Call(
        "`hj.rollout` from a given start",
        least(lambda: hj.rollout(robot, hit, **given), 5, 1),
        "ms",
        [
            Part(f"{one.steps} control steps, not compiled", stepping),
            Part("is the start behind the object", least(partial(prepare, robot, hit, **given))),
        ],
        "the impact, slowing down, torques of every row",
    )
    many = 2000
    q0 = np.tile(found.q0, (many, 1))
    yield Call(
        f"`hj.rollouts`, one of {many}",
        least(lambda: hj.rollouts(robot, hit, q0, q_hit=found.q_hit, threads=1), 3, 1) / many,
        "us",
        [
            Part(
                f"{one.steps} compiled steps in lanes",
                _lane_steps(robot, hit, found.q0) * one.steps,
            )
        ],
        "torques and ratios of every row, slowing down, the impact, reasons",
    )


def _lane_steps(robot: hj.Robot, hit: hj.Hit, q: Any) -> float:
    """Return how long a step of one of many takes."""
    from hitjoints.hitting.step_layout import flat, unbounded
    from hitjoints.hitting.step_rows import step_rows_for
    from hitjoints.hitting.step_tape import Setting

    step, many = step_rows_for(robot, robot.contact(JOINT)), 2000
    inputs = np.zeros((step.run.program.inputs, many))
    inputs[step.at.q], inputs[step.at.guesses] = q[:, None], step.first[:, None]
    inputs[step.at.setting] = flat(
        Setting(
            tuple(hit.position), tuple(hit.direction), MASS, FLUX, 0.002, 1.0, 0.0, 0.5, 0.5,
            0.0, 0.0, tuple(q),
        )
    )[:, None]  # fmt: skip
    unbounded(inputs, step.at)
    return least(lambda: step(inputs), 10, 5) / many


def _empty() -> Any:
    """Return a compiled program that does next to nothing, ready to run."""
    tracer = Tracer(1)
    return ScalarProgram(tracer.program([tracer.inputs[0]])).bind()


def least(work: Callable[[], object], repeats: int = 15, times: int = 200) -> float:
    """Return the least processor time of a call, in seconds."""
    work()
    found = []
    for _ in range(repeats):
        begin = time.process_time()
        for _ in range(times):
            work()
        found.append((time.process_time() - begin) / times)
    return min(found)


def table() -> str:
    """Return the breakdown as Markdown."""
    scale = {"ns": 1e9, "us": 1e6, "ms": 1e3}
    lines = ["| call, and what it is made of | time | share |", "| --- | --- | --- |"]
    for call in calls():
        factor = scale[call.unit]
        lines.append(f"| **{call.name}** | **{factor * call.whole:.3g} {call.unit}** | |")
        left = max(call.whole - sum(part.seconds for part in call.parts), 0.0)
        for part in (*call.parts, Part(call.rest, left)):
            time_ = f"{factor * part.seconds:.2g} {call.unit}"
            lines.append(f"| {part.name} | {time_} | {part.seconds / call.whole:.0%} |")
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    COMMAND = " ".join(("python -m benchmarks.where_time_goes", *sys.argv[1:]))
    TEXT = f"{circumstances(COMMAND)}\n\n{table()}"
    print(TEXT)
    if "--write" in sys.argv:
        TABLE.write_text(TEXT)
