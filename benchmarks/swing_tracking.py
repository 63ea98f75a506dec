"""Swings followed by position servos in MuJoCo: what tracking costs at the impact.

`python -m benchmarks.swing_tracking 12` follows 12 swings of each of five arms, every other one as
hard as can be, with servos of three stiffnesses that know more or less of the motion, and prints
the table of docs/swing.md.

A servo's torque is K (q* - q) + D (qd* - qd) + tau*, no more than the joint's effort limit, with
critical damping of the joint's own inertia. The references are interpolated between the samples, as
drives do. Gravity is compensated; rotor inertias that are known are in the arm.
"""

from __future__ import annotations

import sys
import warnings
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
import pinocchio as pin

import hitjoints as hj
from benchmarks.swings import MARGIN, STATED, arms, random_hits
from hitjoints.evidence.physics.engine_arm import arm_spec
from hitjoints.impact.rotor import with_rotors
from hitjoints.model.engine import engine
from hitjoints.model.robot import Robot
from hitjoints.swings.swing_record import Swing

STIFFNESSES = (500.0, 2000.0, 10_000.0)
"""N m/rad, of every joint: a soft impedance controller, the stiffest of these, a position drive."""
KNOWN = ("positions", "and velocities", "and torques")
"""What of a motion the servos are told."""
STEP = 1e-4
"""s, of the engine."""
LATE = 0.05
"""s after the planned impact until which the contact has to arrive."""
EARLY = 0.02
"""s before the stroke from where on it is followed: until then the arm is at rest or nearly."""


class Tracked(NamedTuple):
    """How a followed swing crosses the plane through the object.

    Attributes:
        joint: mrad, the greatest error of a joint.
        late: ms after the planned time.
        miss: mm from the object.
        angle: deg off the direction.
        flux: share of the planned one.
    """

    joint: float
    late: float
    miss: float
    angle: float
    flux: float


def swings(count: int, seed: int = 1) -> Iterator[Swing]:
    """Yield swings of five arms, every other one as fast as can be, the others at 60 % of that."""
    for name, robot in arms().items():
        acceleration = None if robot.acceleration is not None else STATED[name]
        made = 0
        for hit in random_hits(robot, 20 * count, seed):
            if made == count:
                break
            options: dict[str, Any] = {"acceleration": acceleration, "margin": MARGIN}
            try:
                swing = hj.swing(robot, hit, **options)
                if made % 2:
                    swing = hj.swing(robot, hit.with_flux(0.6 * swing.flux), **options)
            except hj.InfeasibleError:
                continue
            made += 1
            yield swing


def followed(swing: Swing, stiffness: float, known: int) -> Tracked | None:
    """Return how servos strike that follow a swing's stroke; None if they never get there."""
    mujoco = engine()
    robot = swing.robot if swing.robot.rotor_inertia is None else with_rotors(swing.robot)
    spec = arm_spec(robot)
    spec.option.timestep, spec.option.integrator = STEP, mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    model = spec.compile()
    data = mujoco.MjData(model)
    begin = swing.impact_time - swing.motion.pieces[-2].impact  # type: ignore[attr-defined]
    times = np.arange(max(begin - EARLY, 0.0), swing.impact_time + LATE, STEP)
    reference = swing.motion.at(np.minimum(times, swing.motion.duration))
    forward = _torques(robot, reference)
    data.qpos[:], data.qvel[:] = reference.q[0], reference.qd[0]
    inertia = np.diag(pin.crba(robot.model, robot.data, swing.q_hit))
    damping = 2.0 * np.sqrt(stiffness * inertia)
    limit = np.where(robot.effort > 0, robot.effort, np.inf)
    contact, h = robot.contact(swing.hit.chosen_contact), swing.hit.direction
    for k, time in enumerate(times):
        if time > swing.impact_time - LATE:
            place = hj.position(robot, data.qpos, contact)
            if float(h @ (swing.hit.position - place)) <= 0:
                return _struck(swing, reference.q[k], data.qpos, data.qvel, time)
        velocity = reference.qd[k] if known else 0.0
        torque = stiffness * (reference.q[k] - data.qpos) + damping * (velocity - data.qvel)
        torque += forward[k] if known == 2 else 0.0
        data.qfrc_applied[:] = np.clip(torque, -limit, limit)
        mujoco.mj_step(model, data)
    return None


def _torques(robot: Robot, joints: Any) -> Any:
    """Return what moves the arm, (N, n) N m, without what holds it against gravity."""
    rows = zip(joints.q, joints.qd, joints.qdd, strict=True)
    model, data = robot.model, robot.data
    held = np.array([pin.computeGeneralizedGravity(model, data, q) for q in joints.q])
    return np.array([pin.rnea(model, data, *row) for row in rows]) - held


def _struck(swing: Swing, wanted: Any, q: Any, qd: Any, time: float) -> Tracked:
    robot, hit = swing.robot, swing.hit
    contact, h = robot.contact(hit.chosen_contact), hit.direction
    velocity = hj.jacobian(robot, q, contact) @ qd
    along = float(h @ velocity)
    inertia = hj.directional_inertia(robot, q, contact, h)
    return Tracked(
        1e3 * float(np.abs(wanted - q).max()),
        1e3 * (time - swing.impact_time),
        1e3 * float(np.linalg.norm(hj.position(robot, q, contact) - hit.position)),
        float(np.degrees(np.arctan2(np.linalg.norm(velocity - along * h), along))),
        hit.flux_of(inertia, along) / swing.flux,
    )


def main(count: int) -> None:
    """Print a table: a row for each stiffness and each kind of servo."""
    made = list(swings(count))
    print(f"{len(made)} swings; median, 95 %")
    for stiffness in STIFFNESSES:
        for known, words in enumerate(KNOWN):
            seen = [followed(swing, stiffness, known) for swing in made]
            rows = [one for one in seen if one is not None]
            columns = [np.abs(column) for column in np.array(rows).T]
            columns[-1] = 100.0 * np.abs(np.array(rows)[:, -1] - 1.0)
            values = [f"{np.median(c):.3g}, {np.percentile(c, 95):.3g}" for c in columns]
            bias = 100.0 * float(np.median([one.flux for one in rows]) - 1.0)
            cells = [f"{stiffness:g}", words, *values, f"{bias:+.2g}", f"{len(seen) - len(rows)}"]
            print("| " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    main(int([*sys.argv[1:], "12"][0]))
