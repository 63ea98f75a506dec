"""Draw a rollout: inertia and desired inertia, speed and flux, distance from the line, margins."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from hitjoints.show.figures import COLOURS, colour_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from hitjoints.hitting.record import Rollout


def draw_rollout(result: Rollout) -> Figure:
    """Return the figure of a rollout, four graphs along time with the impact marked."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(10, 6.5), layout="constrained")
    axes = figure.subplots(2, 2, sharex=True)
    rows, hit = result.rows, result.hit
    time = result.dt * np.arange(len(rows["q"]))
    joint = result.robot.contact(hit.contact).joint
    colour = colour_of(joint)
    inertia, speed, line, joints = axes.flat
    inertia.plot(time, rows["inertia"], color=colour, label=r"$\lambda$")
    inertia.plot(time, rows["desired_inertia"], "k--", lw=1, label=r"desired $\lambda^*$")
    inertia.set_ylabel("inertia (kg)")
    speed.plot(time, rows["speed"], color=colour, label="speed")
    speed.plot(time, rows["flux"], color=colour, alpha=0.5, label=r"flux $\phi$")
    speed.axhline(hit.flux, color="k", ls="--", lw=1, label=r"desired flux $\phi^*$")
    speed.set_ylabel("m/s")
    offset = rows["position"] - hit.position
    ahead = offset @ hit.direction
    line.plot(time, 1e3 * np.linalg.norm(offset - np.outer(ahead, hit.direction), axis=1), "k")
    line.set_ylabel("distance from the line (mm)")
    _draw_margins(joints, result, time)
    for axis in (line, joints):
        axis.set_xlabel("time (s)")
    for axis in axes.flat:
        axis.spines[["top", "right"]].set_visible(False)
        if result.impact is not None:
            axis.axvline(result.impact.time, color="grey", lw=1)
    for axis in (inertia, speed, joints):
        axis.legend(frameon=False, fontsize="small")
    at = ", ".join(f"{value:g}" for value in hit.position)
    along = ", ".join(f"{value:.3g}" for value in hit.direction)
    verdict = result.reason or "impact marked in grey"
    figure.suptitle(
        f"{result.robot.name}, joint {joint}: {hit.mass:g} kg at ({at}) m along ({along}); "
        f"{verdict}",
        fontsize="medium",
    )
    return figure


def _draw_margins(axis: Axes, result: Rollout, time: np.ndarray) -> None:
    robot, qd = result.robot, result.rows["qd"]
    limit = np.where(qd > 0, robot.velocity_upper, -robot.velocity_lower)
    share = np.divide(qd, limit, out=np.zeros_like(qd), where=limit > 0)
    for i in range(robot.n):
        axis.plot(time, share[:, i], color=COLOURS[i % len(COLOURS)], lw=1, label=f"{i + 1}")
    axis.set_ylabel("joint velocity / limit")
    axis.set_ylim(-1.05, 1.05)
