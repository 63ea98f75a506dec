"""Draw a rollout: inertia and desired inertia, speed and flux, distance from the line, margins."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from hitjoints.show.joint_curves import draw_impact, draw_shares
from hitjoints.show.sheet import Sheet, sheet
from hitjoints.show.style import Look, colour_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from hitjoints.rollouts.record import Rollout

LEAST = 0.02
"""Of a quantity, what an axis spans at least: less would show last digits as if they mattered."""
NEAR = 1.0
"""mm, what the distance from the line is drawn to at least."""


def draw_rollout(result: Rollout, look: Look) -> Sheet:
    """Return the figure of a rollout: graphs along time with the impact marked.

    A rollout with torque limits, or that exceeds one, has two more: of the torques, and of the
    room to the position limits that is left to brake in.
    """
    rows, hit, robot = result.rows, result.hit, result.robot
    forced = bool(result.parameters["torque_limits"]) or result.torque_ratio_max > 1
    figure, axes = sheet(look, 6 if forced else 4, 3 if forced else 2, (4.7, 3.3))
    inertia, speed = axes[:2]
    line, joints = (axes[3], axes[4]) if forced else axes[2:]
    time = np.asarray(result.dt * np.arange(float(len(rows["q"]))))
    joint = robot.contact(hit.chosen_contact).joint
    draw_inertia(inertia, result)
    colour = colour_of(joint)
    speed.plot(time, rows["speed"], color=colour, label="speed")
    speed.plot(time, rows["flux"], color=colour, alpha=0.6, ls="-.", label=r"flux $\phi$")
    speed.axhline(hit.desired_flux, color="k", ls="--", lw=1, label=r"desired flux $\phi^*$")
    speed.set(ylabel="speed and flux (m/s)")
    speed.set_ylim(min(0.0, speed.get_ylim()[0]))
    speed.legend()
    offset = rows["position"] - hit.position
    ahead = offset @ hit.direction
    aside = 1e3 * np.linalg.norm(offset - np.outer(ahead, hit.direction), axis=1)
    line.plot(time, aside, color=colour)
    line.set(ylabel="distance from the line (mm)", ylim=(0, 1.08 * max(NEAR, float(aside.max()))))
    limit = np.where(rows["qd"] > 0, robot.velocity_upper, -robot.velocity_lower)
    draw_shares(joints, time, rows["qd"], limit, "velocity / limit")
    if forced:
        torque, room = axes[2], axes[5]
        draw_shares(torque, time, rows["torque"], robot.effort, "torque / limit")
        room.plot(time, rows["position_margin"].min(axis=1), color="k")
        room.set(ylabel="nearest position limit (rad)")
        room.set_ylim(bottom=0)
    for axis in axes:
        axis.set_xlabel("time (s)")
        draw_impact(axis, None if result.impact is None else result.impact.time)
    figure.key(joints.get_legend_handles_labels()[0])
    verdict = result.reason or "impact marked in grey"
    figure.headline(f"{robot.name}, joint {joint}: {hit.words}; {verdict}")
    return figure


def draw_inertia(axis: Axes, result: Rollout) -> None:
    """Draw the inertia along time, and the one that was aimed for until the impact."""
    rows, until = result.rows, result.rows["approach"] == 1
    time = result.dt * np.arange(len(rows["q"]))
    joint = result.robot.contact(result.hit.chosen_contact).joint
    axis.plot(time, rows["inertia"], color=colour_of(joint), label=r"$\lambda$")
    axis.plot(
        time[until], rows["desired_inertia"][until], "k--", lw=1, label=r"desired $\lambda^*$"
    )
    axis.set(ylabel="inertia (kg)")
    low, high = axis.get_ylim()
    middle, half = (low + high) / 2, max(high - low, LEAST * abs(high)) / 2
    axis.set_ylim(middle - half, middle + half)
    axis.legend()
