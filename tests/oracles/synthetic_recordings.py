"""Recordings of hits that are known exactly, written in the layout of the public data set.

The arm is Pinocchio's, hit by dense algebra that shares nothing with the library: an impulse acts
on the mass matrix, and the joints and the object take what it gives them. Then come the flaws of
real recordings: the recorder's quantities lag, motion capture is latched and wavers.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin

import hitjoints as hj

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

RATE = 200.0  # Hz
EPOCH = 1715015836.0  # s: the recorder's clock
TOOL = np.array([0.0, 0.0, 0.15])  # m, on the last joint
GRAVITY = 9.81  # m/s^2
STREAM = 1 / 360  # s between two frames of motion capture
NAMES = {"iiwa7": ("IIWA_7", 1.0), "iiwa14": ("IIWA_14", -1.0)}
POSES = {
    "iiwa7": (-0.7, 1.3, 0.8, -1.4, -2.4, -1.2, -0.6),
    "iiwa14": (0.4, 1.0, -0.8, -2.0, -1.6, 0.8, -0.2),
}  # rad, near those of recorded hits
HEADER = (
    "RobotName,RosTime,JointPosition,JointVelocity,JointEffort,TorqueCmd,EEF_Position,"
    "EEF_Orientation,EEF_Velocity,EEF_DesiredVelocity,Inertia,DirGrad,HittingFlux"
)
OBJECT_HEADER = (
    "RosTime,PositionForIiwa7,OrientationForIiwa7,PositionForIiwa14,OrientationForIiwa14"
)


@dataclass(frozen=True)
class Truth:
    """A hit to be recorded: SI units.

    Attributes:
        robot: iiwa7 or iiwa14. speed: of the tool along the direction. mass: of the object.
        restitution, friction. push: s, for which the contact lasts; the impulse acts evenly.
        contact: s from the first row. duration: s, of the recording.
        lag: rows. noise: m, of motion capture. phantom: kg m^2, of the recorder's model.
        seed: of configuration and noise.
    """

    robot: str = "iiwa14"
    speed: float = 0.9
    mass: float = 0.4
    restitution: float = 0.3
    friction: float = 0.15
    push: float = 0.02
    contact: float = 0.6
    duration: float = 1.5
    lag: int = 2
    noise: float = 5e-5
    phantom: float = 0.05
    seed: int = 0


@dataclass(frozen=True)
class Written:
    """What was written, and what is true of it: kg, m/s, m."""

    file: Path
    object_file: Path
    inertia: float
    flux: float
    object_speed: float
    robot_speed_after: float
    travel: float


def write_recording(folder: Path, number: int, truth: Truth) -> Written:
    """Write the robot's and the object's file of one hit."""
    rng = np.random.default_rng(truth.seed)
    name, sign = NAMES[truth.robot]
    arm = hj.load_robot(truth.robot)
    model, h = arm.model, np.array([0.0, sign, 0.0])
    q_hit = POSES[truth.robot] + rng.uniform(-0.1, 0.1, arm.n)
    jac, mass_matrix = _terms(model, q_hit)[1:]
    before = np.linalg.pinv(jac) @ (truth.speed * h)
    # One impulse along h: M (qd+ - qd-) = -J^T h p, and what the tool and the object part with.
    response = np.linalg.inv(mass_matrix) @ jac.T @ h
    mobility = float(h @ jac @ response)
    impulse = (1 + truth.restitution) * truth.speed / (mobility + 1 / truth.mass)
    after = before - response * impulse
    speed = impulse / truth.mass
    time = np.arange(round(truth.duration * RATE)) / RATE
    q, qd = _joints(time, truth, q_hit, before, after)
    file, object_file = folder / f"{name}_hit_{number}.csv", folder / f"object_1_hit_{number}.csv"
    stamps = EPOCH + time
    facts = f"DesiredFlux,0.7,HitTime,{EPOCH + truth.contact + 0.05!r},DesiredPos,0.5 0.3 0.2"
    lines = [facts, HEADER, *_robot_lines(model, name, stamps, q, qd, h, truth)]
    file.write_text("\n".join(lines) + "\n")
    way = _slid(time, truth, speed)
    phase = rng.uniform(0, STREAM)
    latched = _slid(np.floor((time + phase) / STREAM) * STREAM - phase, truth, speed)
    places = np.array([0.5, 0.3, 0.28]) + latched[:, None] * h
    places += rng.normal(0, truth.noise, places.shape)
    rows = [
        f"{t!r},{_field(x)},0 0 0 1,{_field(x)},0 0 0 1"
        for t, x in zip(stamps.tolist(), places, strict=True)
    ]
    object_file.write_text("\n".join([OBJECT_HEADER, *rows]) + "\n")
    flux = truth.speed / (1 + mobility * truth.mass)
    return Written(
        file, object_file, 1 / mobility, flux, speed, float(h @ jac @ after), float(way[-1])
    )


def _terms(model: pin.Model, q: Array) -> tuple[Array, Array, Array]:
    """Return the tool's position, its Jacobian and the mass matrix."""
    data = model.createData()
    pin.computeJointJacobians(model, data, q)
    last = model.njoints - 1
    jac = pin.getFrameJacobian(model, data, last, pin.SE3(np.eye(3), TOOL), pin.LOCAL_WORLD_ALIGNED)
    upper = np.triu(pin.crba(model, data, q))
    return data.oMi[last].act(TOOL), jac[:3], upper + np.triu(upper, 1).T


def _joints(
    time: Array, truth: Truth, q_hit: Array, before: Array, after: Array
) -> tuple[Array, Array]:
    """Return joint positions and velocities: speeding up, hitting, slowing down."""
    fine = np.arange(0, truth.duration + 1e-9, 1e-4)
    rise = np.clip((fine - truth.contact + 0.35) / 0.25, 0, 1)[:, None]
    fall = np.clip((truth.contact + 0.3 - fine) / 0.2, 0, 1)[:, None]
    struck = np.clip((fine - truth.contact) / max(truth.push, 1e-4), 0, 1)[:, None]
    rate = (before + (after - before) * struck) * rise * fall
    path = np.cumsum(rate, axis=0) * 1e-4
    path += q_hit - path[round(truth.contact / 1e-4)]
    at = np.round(time / 1e-4).astype(int)
    return path[at], rate[at]


def _slid(time: Array, truth: Truth, speed: float) -> Array:
    """Return how far the object has slid: pushed evenly, slowed down by friction, then at rest."""
    push, slowing = truth.push, truth.friction * GRAVITY
    since = np.maximum(time - truth.contact, 0.0)
    if slowing:
        since = np.minimum(since, speed / slowing)
    pushed = 0.5 * speed * np.minimum(since, push) ** 2 / push if push else 0.0
    return np.asarray(pushed + speed * np.maximum(since - push, 0.0) - 0.5 * slowing * since**2)


def _robot_lines(
    model: pin.Model, name: str, stamps: Array, q: Array, qd: Array, h: Array, truth: Truth
) -> list[str]:
    theirs = pin.Model(model)
    phantom = pin.Inertia(1e-6, np.zeros(3), truth.phantom * np.eye(3))
    theirs.appendBodyToJoint(theirs.njoints - 1, phantom, pin.SE3.Identity())
    written = []
    for row, rate in zip(q, qd, strict=True):
        place, jac, mass_matrix = _terms(theirs, row)
        velocity = jac @ rate
        mobility = jac @ np.linalg.solve(mass_matrix, jac.T)
        flux = np.linalg.norm(velocity) / (1 + truth.mass * float(h @ mobility @ h))
        zeros = _field(0 * row)
        written.append(
            f"{_field(place)},0 0 0 1,{_field(velocity)},{_field(velocity)},"
            f"{_field(mobility.ravel())},{zeros},{float(flux)!r}"
        )
    lagging = [written[max(0, i - truth.lag)] for i in range(len(written))]
    zeros = _field(np.zeros(q.shape[1]))
    return [
        f"{name},{t!r},{_field(row)},{_field(rate)},{zeros},{zeros},{more}"
        for t, row, rate, more in zip(stamps.tolist(), q, qd, lagging, strict=True)
    ]


def _field(values: Array) -> str:
    return " ".join(map(repr, values.tolist()))
