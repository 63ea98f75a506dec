"""Draw a swing: joints within their limits, what it takes of the drives, the contact's path."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from hitjoints.dynamics.kinematics import position
from hitjoints.show.figures import COLOURS, colour_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from hitjoints.swings.swing_record import Swing
    from hitjoints.types import Array

LAST = 0.12
"""m before the object that the picture of the approach begins, or with the wind-up."""
STILL = 1e-3
"""rad/s, slower than that the arm is about to wind up."""


def draw_swing(result: Swing) -> Figure:
    """Return the figure of a swing: shares of limits along time, and the approach to the object."""
    from matplotlib.figure import Figure

    robot, joints, limits = result.robot, result.joints, result.limits
    low, high = robot.finite_limits
    figure = Figure(figsize=(14, 7), layout="constrained")
    axes = figure.subplots(2, 3)
    place, speed, path = axes[0]
    force, torque, near = axes[1]
    middle, half = (low + high) / 2, (high - low) / 2
    top = np.where(joints.qd > 0, limits.velocity_upper, -limits.velocity_lower)
    _shares(place, result, (joints.q - middle) / half, "position, -1 and 1 are the limits")
    _shares(speed, result, _ratio(joints.qd, top), "velocity / limit")
    _shares(force, result, _ratio(joints.qdd, limits.acceleration), "acceleration / limit")
    _shares(torque, result, result.torque / limits.effort, "torque / limit")
    contact = robot.contact(result.hit.chosen_contact)
    where = np.array([position(robot, q, contact) for q in joints.q]) - result.hit.position
    _draw_path(path, result, where)
    _draw_approach(near, result, where)
    place.legend(frameon=False, fontsize="small", ncols=2, title="joint")
    for axis in axes.flat:
        axis.spines[["top", "right"]].set_visible(False)
    verdict = "sendable" if result.sendable else f"not sendable: {result.why}"
    figure.suptitle(
        f"{robot.name}, joint {contact.joint}: {result.hit.words}; flux {result.flux:.3g} m/s; "
        f"{verdict}; impact marked in grey",
        fontsize="medium",
    )
    return figure


def _ratio(values: Array, limit: Array) -> Array:
    limit = np.broadcast_to(limit, values.shape)
    return np.divide(values, limit, out=np.zeros_like(values), where=limit > 0)


def _shares(axis: Axes, result: Swing, share: Array, label: str) -> None:
    for i, curve in enumerate(share.T):
        axis.plot(result.times, curve, color=COLOURS[i % len(COLOURS)], lw=1, label=f"{i + 1}")
    axis.axvline(result.impact_time, color="grey", lw=1)
    axis.set(xlabel="time (s)", ylabel=label, ylim=(-1.05, 1.05))


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
    axis.legend(frameon=False, fontsize="small")


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
    other.set_ylabel("distance from the line (mm), dashed")
    other.spines["top"].set_visible(False)
    other.set_ylim(bottom=0)
