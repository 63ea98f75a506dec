"""Draw a rollout: inertia and desired inertia, speed and flux, distance from the line, margins."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from hitjoints.show.figures import COLOURS, colour_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from hitjoints.rollouts.record import Rollout


def draw_rollout(result: Rollout) -> Figure:
    """Return the figure of a rollout: graphs along time with the impact marked.

    A rollout with torque limits has two more, of the torques and of the room they need to brake.
    """
    from matplotlib.figure import Figure

    rows, hit, robot = result.rows, result.hit, result.robot
    forced = result.parameters["torque_limits"]
    figure = Figure(figsize=(14 if forced else 10, 6.5), layout="constrained")
    axes = figure.subplots(2, 3 if forced else 2, sharex=True)
    time = result.dt * np.arange(len(rows["q"]))
    joint = robot.contact(hit.chosen_contact).joint
    colour = colour_of(joint)
    (inertia, speed), (line, joints) = axes[:, :2]
    inertia.plot(time, rows["inertia"], color=colour, label=r"$\lambda$")
    inertia.plot(time, rows["desired_inertia"], "k--", lw=1, label=r"desired $\lambda^*$")
    inertia.set_ylabel("inertia (kg)")
    speed.plot(time, rows["speed"], color=colour, label="speed")
    speed.plot(time, rows["flux"], color=colour, alpha=0.5, label=r"flux $\phi$")
    speed.axhline(hit.desired_flux, color="k", ls="--", lw=1, label=r"desired flux $\phi^*$")
    speed.set_ylabel("m/s")
    offset = rows["position"] - hit.position
    ahead = offset @ hit.direction
    line.plot(time, 1e3 * np.linalg.norm(offset - np.outer(ahead, hit.direction), axis=1), "k")
    line.set_ylabel("distance from the line (mm)")
    limit = np.where(rows["qd"] > 0, robot.velocity_upper, -robot.velocity_lower)
    _draw_shares(joints, time, rows["qd"], limit, "joint velocity / limit")
    if forced:
        torque, room = axes[:, 2]
        _draw_shares(torque, time, rows["torque"], robot.effort, "joint torque / limit")
        room.plot(time, rows["position_margin"].min(axis=1), "k")
        room.set_ylabel("nearest position limit (rad)")
        room.set_ylim(bottom=0)
    for axis in axes[1]:
        axis.set_xlabel("time (s)")
    for axis in axes.flat:
        axis.spines[["top", "right"]].set_visible(False)
        if result.impact is not None:
            axis.axvline(result.impact.time, color="grey", lw=1)
    for axis in (inertia, speed, joints):
        axis.legend(frameon=False, fontsize="small")
    verdict = result.reason or "impact marked in grey"
    figure.suptitle(f"{robot.name}, joint {joint}: {hit.words}; {verdict}", fontsize="medium")
    return figure


def _draw_shares(
    axis: Axes, time: np.ndarray, values: np.ndarray, limit: np.ndarray, label: str
) -> None:
    """Draw a curve per joint, in units of its limit."""
    limit = np.broadcast_to(limit, values.shape)
    share = np.divide(values, limit, out=np.zeros_like(values), where=limit > 0)
    for i, curve in enumerate(share.T):
        axis.plot(time, curve, color=COLOURS[i % len(COLOURS)], lw=1, label=f"{i + 1}")
    axis.set_ylabel(label)
    axis.set_ylim(-1.05, 1.05)
