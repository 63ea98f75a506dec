"""Hits on elastic joints, in closed form and in the engine: `python -m benchmarks.elastic 60`."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

import hitjoints as hj
from benchmarks.harness import Figure, seconds
from hitjoints.evidence.physics.first_touch import ImpactState
from hitjoints.evidence.physics.setting import EngineSetting
from hitjoints.evidence.physics.strike import strike
from tests.oracles.random_rollouts import feasible_hits
from tests.oracles.spring_arms import random_case

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from hitjoints.model.robot import Robot

ARMS: dict[str, float | None] = {"iiwa14": None, "panda": None, "xarm7": 0.5}
"""Each with its rotor inertia, kg m^2, where the robot does not know it: then it is a guess."""
TIMES = (1e-3, 5e-3, 1e-2, 2e-2)
STIFFNESS = 1e4
GAIN = 50.0
"""N m s/rad, of velocity servos at the motors of every other hit."""
SLOWEST = 0.2
"""m/s: an arm next to a singularity whirls, and its contact hardly moves."""
CASES = 1_000
"""Of `python -m benchmarks`."""
LONG = 1.5
"""Contact times after which a contact counts as long: the links swing back and push on."""
GRAZING = 0.05
"""Share of the contact time: a second contact that follows sooner makes the parting doubtful."""


class Compared(NamedTuple):
    """One hit: the object's speed off by a share of it, the robot's by a share of the hit's speed.

    Attributes:
        object_still: the same as object_off, by the closed form of an arm that stands still.
        robot_still: the same as robot_off, by it.
        lasting: the contact's time in units of what was asked for.
        grazing: whether they part at all hangs on the last digits.
    """

    object_off: float
    robot_off: float
    object_still: float
    robot_still: float
    lasting: float
    grazing: bool


def planned(name: str, count: int) -> list[tuple[ImpactState, float]]:
    """Return random planned hits, each with its restitution.

    Joints 5 to 7, all directions, 0.2 m/s or faster, 0.5 to 4 kg, 30 to 80 % of the greatest flux,
    restitution 0.2 to 0.95; the arm moves straight along the direction, no more than it must.
    """
    random = np.random.default_rng(5)
    robot = hj.load_robot(name)
    found: list[tuple[ImpactState, float]] = []
    for hit, prepared in feasible_hits(robot, 2 * count, away=name == "iiwa14"):
        assert hit.contact is not None
        assert hit.flux is not None
        q, contact = prepared.q_hit, robot.contact(hit.contact)
        inertia = hj.directional_inertia(robot, q, contact, hit.direction)
        speed = hj.required_speed(inertia, hit.mass, hit.flux)
        if speed < SLOWEST:
            continue
        qd = np.linalg.pinv(hj.jacobian(robot, q, contact)) @ (speed * hit.direction)
        place = hj.position(robot, q, contact)
        state = ImpactState(contact, hit.direction, hit.mass, q, qd, place)
        found.append((state, float(random.uniform(0.2, 0.95))))
        if len(found) == count:
            break
    return found


def rotors_of(name: str) -> tuple[Robot, NDArray[np.float64]]:
    """Return an arm and its reflected rotor inertias, known or guessed."""
    robot, guess = hj.load_robot(name), ARMS[name]
    if guess is not None:
        return robot, np.full(robot.n, guess)
    assert robot.rotor_inertia is not None
    return robot, robot.rotor_inertia


def compare(
    name: str, hits: list[tuple[ImpactState, float]], contact_time: float
) -> Iterator[Compared]:
    """Yield how far hits in the engine are from the closed form.

    Args:
        name: of the arm.
        hits: as `planned` returns them.
        contact_time: s, of the rigid pair.
    """
    robot, rotors = rotors_of(name)
    for i, (state, eps) in enumerate(hits):
        speed, gain = state.speed(robot), GAIN * (i % 2)
        how = EngineSetting(
            eps,
            contact_time=contact_time,
            servo_gain=gain,
            stiffness=(STIFFNESS,) * robot.n,
            rotors=tuple(rotors.tolist()),
        )
        engine = strike(robot, state, how, lambda _, qd=state.qd: qd)  # type: ignore[misc]
        told, still = (
            hj.elastic_impact(
                robot, state.q, state.contact, state.direction, state.mass, speed, eps,
                contact_time, STIFFNESS, servo=(0.0, gain), qd=motion, rotor_inertia=rotors,
            )
            for motion in (state.qd, None)
        )  # fmt: skip
        again = told.second_contact
        offs = [
            off
            for one in (told, still)
            for off in (
                abs(one.object_speed / engine.object_speed - 1.0),
                abs(one.robot_speed - speed - engine.rebound) / speed,
            )
        ]
        grazing = again is not None and again < GRAZING * contact_time
        a, b, c, d = offs
        yield Compared(a, b, c, d, engine.contact_time / contact_time, grazing)


def energy_grows(count: int, seed: int = 0) -> int:
    """Return in how many of `count` random hits the energy grows, in the contact or after it.

    Links of 1e-3 to 5 kg m^2, joints of 1e2 to 1e7 N m/rad, servos at every other.
    """
    random, grown = np.random.default_rng(seed), 0
    for i in range(count):
        case = random_case(random, stiffest=7, lightest=-3, servo=bool(i % 2))
        parted = case.arm.collide(case.m, case.v, (case.k, case.d), case.time)
        held = parted.swing.energy(0.0)
        after = held + case.k * parted.depth**2 / 2
        later = max(parted.swing.energy(time) for time in (1e-4, 1e-3, 1e-2, 1e-1))
        grown += after > case.energy * (1 + 1e-9) or later > held * (1 + 1e-9)
    return grown


def measure(cases: int = CASES) -> list[Figure]:
    """Return the time of one elastic impact, and how often the energy grows."""
    robot, _ = rotors_of("iiwa14")
    asked = robot, robot.home, 7, (0.0, 1.0, 0.0), 0.4, 1.0, 0.5
    spent = min(seconds(lambda: hj.elastic_impact(*asked, 0.01)) for _ in range(200))
    return [
        Figure("one hit on elastic joints, in closed form", 1e3 * spent, "ms", "<= 0.5"),
        Figure(f"energy grows, of {cases} random hits", float(energy_grows(cases)), "", "<= 0"),
    ]


def main(count: int) -> None:
    """Print the errors of each arm at each contact time, energy that grows, and the time of one."""
    for figure in measure(10 * CASES):
        print(f"{figure.what}: {figure.value:.3g} {figure.unit} {figure.target}")
    print("arm      contact  object speed off, %: median, 95 of 100, most   robot speed, % of v")
    for name in ARMS:
        hits = planned(name, count)
        for time in TIMES:
            found = list(compare(name, hits, time))
            off = 100 * np.array([one[:4] for one in found if not one.grazing])
            cells = ["  ".join(f"{v:6.3f}" for v in np.percentile(x, (50, 95, 100))) for x in off.T]
            left = np.median(off[:, :2], axis=0) / np.median(off[:, 2:], axis=0)
            long = sum(one.lasting > LONG for one in found)
            grazing = sum(one.grazing for one in found)
            print(
                f"{name:8} {1e3 * time:4.0f} ms  {cells[0]}   {cells[1]}  grazing: {grazing}, "
                f"long: {long}; of a still arm's median {left[0]:.2f}, {left[1]:.2f}",
                flush=True,
            )


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 60)
