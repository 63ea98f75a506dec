"""Draw a swing: joints within their limits, what it takes of the drives, the contact's path."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from hitjoints.dynamics.kinematics import position
from hitjoints.show.joint_curves import draw_impact, draw_shares
from hitjoints.show.sheet import Sheet, sheet
from hitjoints.show.style import Look, colour_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from hitjoints.swings.swing_record import Swing
    from hitjoints.types import Array

LAST = 0.12
"""m before the object that the picture of the approach begins, or with the wind-up."""
STILL = 1e-3
"""rad/s, slower than that the arm is about to wind up."""


def draw_swing(result: Swing, look: Look) -> Sheet:
    """Return the figure of a swing: shares of limits along time, and the approach to the object."""
    robot, joints, limits = result.robot, result.joints, result.limits
    low, high = robot.finite_limits
    figure, axes = sheet(look, 6, 3, (4.4, 3.3))
    place, speed, path, force, torque, near = axes
    middle, half = (low + high) / 2, (high - low) / 2
    draw_shares(place, result.times, joints.q - middle, half, "position, limits at -1 and 1")
    draw_velocity(speed, result)
    draw_shares(force, result.times, joints.qdd, limits.acceleration, "acceleration / limit")
    draw_shares(torque, result.times, result.torque, limits.effort, "torque / limit")
    contact = robot.contact(result.hit.chosen_contact)
    where = np.array([position(robot, q, contact) for q in joints.q]) - result.hit.position
    _draw_path(path, result, where)
    _draw_approach(near, result, where)
    for axis in (place, speed, force, torque):
        draw_impact(axis, result.impact_time)
    figure.key(place.get_legend_handles_labels()[0])
    verdict = "sendable" if result.sendable else f"not sendable: {result.why}"
    figure.headline(
        f"{robot.name}, joint {contact.joint}: {result.hit.words}; flux {result.flux:.3g} m/s; "
        f"{verdict}; impact marked in grey"
    )
    return figure


def draw_velocity(axis: Axes, result: Swing) -> None:
    """Draw the joints' velocities in units of their limits."""
    qd, limits = result.joints.qd, result.limits
    top = np.where(qd > 0, limits.velocity_upper, -limits.velocity_lower)
    draw_shares(axis, result.times, qd, top, "velocity / limit")


def _draw_path(axis: Axes, result: Swing, where: Array) -> None:
    """Draw the contact's way from above and beside: along the direction, and off its line."""
    h = result.hit.direction
    along = where @ h
    aside = np.linalg.norm(where - np.outer(along, h), axis=1)
    hit = result.impact_sample
    colour = colour_of(result.hit.chosen_contact.joint)
    axis.plot(along[: hit + 1], aside[: hit + 1], color=colour, label="until the impact")
    axis.plot(along[hit:], aside[hit:], color=colour, ls=":", label="afterwards")
    axis.plot(along[0], aside[0], "o", color=colour, ms=4)
    axis.axvline(0, color="grey", lw=1)
    axis.set(xlabel="along the direction, object at 0 (m)", ylabel="distance from the line (m)")
    axis.legend()


def _draw_approach(axis: Axes, result: Swing, where: Array) -> None:
    """Draw speed and distance from the line over the last of the way."""
    h, hit = result.hit.direction, result.impact_sample
    along = where[: hit + 1] @ h
    still = np.flatnonzero(np.abs(result.joints.qd[:hit]).max(axis=1) < STILL)
    behind = np.flatnonzero(along < -LAST)
    rows = slice(int(max(*still[-1:], *behind[-1:], 0, 0)), hit + 1)
    aside = np.linalg.norm(where[rows] - np.outer(along[rows], h), axis=1)
    speed = np.gradient(where[: hit + 2] @ h, result.dt)[rows]
    axis.plot(1e3 * along[rows], speed, color=colour_of(result.hit.chosen_contact.joint))
    axis.set(xlabel="along the direction, object at 0 (mm)", ylabel="speed along it (m/s)")
    other = axis.twinx()
    other.plot(1e3 * along[rows], 1e3 * aside, "k--", lw=1)
    other.set_ylabel("from the line (mm), dashed")
    other.spines["right"].set_visible(True)
    other.set_ylim(bottom=0)
