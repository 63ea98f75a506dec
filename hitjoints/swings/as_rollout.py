"""A swing in the form of a rollout, for whoever follows one: the physics engine, figures."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from hitjoints.built import kernel_for
from hitjoints.hitting.approach import Impact
from hitjoints.rollouts.record import Rollout

if TYPE_CHECKING:
    from hitjoints.swings.swing_record import Swing


def as_rollout(swing: Swing) -> Rollout:
    """Return a swing's samples and impact as a rollout has them.

    Inertia and flux are those of the links, whatever model of the drives the swing reckons with. A
    row's qd is the velocity at the row; of a rollout it is kept until the next one.
    """
    links = swing.links_inertia
    flux = swing.hit.flux_of(links, swing.speed)
    robot, hit, joints = swing.robot, swing.hit.with_flux(flux), swing.joints
    h, at, count = hit.direction, swing.impact_sample, len(swing.times)
    contact = robot.contact(hit.chosen_contact)
    seen = kernel_for(robot, (contact,), ("inertia", "position", "jacobian"))(joints.q, h)
    inertia, where = np.array(seen["inertia"][0]), np.array(seen["position"][0])
    speed = np.einsum("j,ijk,ik->i", h, seen["jacobian"][0], joints.qd)
    across = float(np.linalg.norm(swing.velocity - swing.speed * h))
    impact = Impact(
        swing.impact_time,
        where[at],
        swing.miss,
        math.degrees(math.atan2(across, swing.speed)),
        links,
        links,
        swing.speed,
        flux,
        swing.q_hit,
        False,
    )
    no = np.zeros(count, dtype=bool)
    rows = {
        "q": joints.q,
        "qd": joints.qd,
        "torque": swing.torque,
        "position": where,
        "inertia": inertia,
        "desired_inertia": inertia,
        "speed": speed,
        "flux": speed / (1.0 + hit.mass / inertia),
        "scaling": np.ones(count),
        "saturated": no,
        "braked": no,
        "emergency": no,
        "approach": np.arange(count) <= at,
        "position_margin": np.minimum(joints.q - robot.lower, robot.upper - joints.q),
        "velocity_margin": np.minimum(
            joints.qd - robot.velocity_lower, robot.velocity_upper - joints.qd
        ),
    }
    kept = {"torque_limits": True, "acceleration_limits": swing.limits.acceleration.tolist()}
    parameters = {"reference": "swing", "dt": swing.dt, **kept, "hit": swing.hit.text}
    return Rollout(
        robot, hit, impact, "", swing.q_hit, swing.dt, at + 1, 0, 0, rows, np.zeros(0), parameters
    )
