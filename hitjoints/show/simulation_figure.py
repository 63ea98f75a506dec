"""Draw a simulated hit: speeds through the contact, how far off, and the way of the box."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from hitjoints.constants import GRAVITY
from hitjoints.show.sheet import NARROWEST, Sheet, below, sheet
from hitjoints.show.style import COLOURS, HATCHES, Look, colour_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from hitjoints.evidence.physics.simulated_hit import Simulation

BOX, TOLD = "#000000", COLOURS[0]
AROUND = 0.6
"""Of the contact's time, drawn before it and after it."""
SMALL = 1.0
"""%, that bars of a hit as predicted are drawn to."""
NAMES = {"object_speed": "object speed", "rebound": "rebound", "inertia": "inertia"}


def draw_simulation(result: Simulation, look: Look) -> Sheet:
    """Return the figure of a simulated hit; predictions are dashed."""
    slides = result.slide is not None
    figure, axes = sheet(look, 4 if slides else 2, 2, (5.5, 3.9), NARROWEST)
    draw_contact(axes[0], result)
    _draw_errors(axes[1], result)
    if slides:
        _draw_way(axes[2], axes[3], result)
    hit, robot = result.motion.hit, result.motion.robot
    figure.headline(
        f"{robot.name}, joint {result.impact.contact.joint}, {result.mode}: {hit.words}, "
        f"restitution {result.setting.restitution:g}"
    )
    return figure


def draw_contact(axis: Axes, result: Simulation) -> None:
    """Draw the speeds of arm and box through the contact."""
    rows, told = result.strike.rows, result.predicted
    around = AROUND * result.strike.contact_time
    end = result.strike.contact_time + around
    shown = rows["time"] <= end
    time = 1e3 * np.concatenate(([-around], rows["time"][shown], [end]))
    colour = colour_of(result.impact.contact.joint)
    lines = (
        ("robot_speed", "arm, contact point", colour, told.speed + told.rebound),
        ("object_speed", "box", BOX, told.object_speed),
    )
    for name, label, shade, level in lines:
        speed = rows[name][shown]
        axis.plot(time, np.concatenate((speed[:1], speed, speed[-1:])), color=shade, label=label)
        axis.axhline(level, color=shade, ls="--", lw=1)
    axis.plot([], [], "--", color="grey", lw=1, label="predicted after the impact")
    axis.set(xlabel="time (ms)", ylabel="speed along the direction (m/s)")
    axis.set_title("through the contact")
    axis.legend()


def _draw_errors(axis: Axes, result: Simulation) -> None:
    """Draw simulated against predicted in per cent: by each cause alone, and all together."""
    groups = [(cause.name, result.errors_of(cause.alone)) for cause in result.causes]
    groups.append(("all together" if groups else result.mode, result.errors_of(result.strike)))
    height = 0.8 / len(NAMES)
    for i, (name, label) in enumerate(NAMES.items()):
        off = np.array([100 * errors[name] for _, errors in groups])
        where = np.arange(len(groups)) + (i - 1) * height
        bars = axis.barh(where, off, 0.9 * height, color=COLOURS[i], label=label, hatch=HATCHES[i],
                         edgecolor="white")  # fmt: skip
        axis.bar_label(bars, [f"{value:+.2g} %" for value in off], padding=3, fontsize="x-small")
    axis.axvline(0, color="black", lw=0.8)
    axis.set_yticks(range(len(groups)), [name for name, _ in groups])
    axis.invert_yaxis()
    axis.margins(x=0.2)
    if max(abs(end) for end in axis.get_xlim()) < SMALL:
        axis.set_xlim(-SMALL, SMALL)
    axis.set_xlabel("error (%)")
    alone = ": each cause alone" if result.causes else ""
    axis.set_title(f"simulated less predicted{alone}")
    # Below the axis: among the bars it would cover some, whichever way they point.
    below(axis, 3, len(NAMES))


def _draw_way(speeds: Axes, ways: Axes, result: Simulation) -> None:
    """Draw the box's speed and way from the impact until it rests."""
    assert result.slide is not None
    rows, slid = result.strike.rows, result.slide.rows
    h, start = result.impact.direction, result.impact.box_centre(result.setting)
    parted = rows["time"][-1]
    time = np.concatenate((rows["time"], parted + slid["slide_time"]))
    speed = np.concatenate((rows["object_speed"], slid["slide_speed"]))
    way = (np.concatenate((rows["box_position"], slid["slide_position"])) - start) @ h
    told, slowing = result.predicted, result.setting.friction * GRAVITY
    assert told.travel is not None
    until = np.linspace(0, told.object_speed / slowing)
    if result.strike.contacts > 1:
        colour = colour_of(result.impact.contact.joint)
        label = f"arm, which touches the box {result.strike.contacts} times"
        speeds.plot(rows["time"], rows["robot_speed"], color=colour, label=label)
    speeds.plot(time, speed, color=BOX, label="box")
    speeds.plot(
        until, told.object_speed - slowing * until, "--", color=TOLD, lw=1.2, label="predicted"
    )
    speeds.set_ylabel("speed along the direction (m/s)")
    ways.plot(time, 1e3 * way, color=BOX, label="box, simulated")
    ways.plot(
        until, 1e3 * (told.object_speed - slowing * until / 2) * until, "--", color=TOLD,
        lw=1.2, label="predicted",
    )  # fmt: skip
    ways.set_ylabel("way of the box (mm)")
    for axis, title in ((speeds, "until the box rests"), (ways, "travel")):
        axis.set_xlabel("time since the impact (s)")
        axis.set_title(title)
        axis.legend()
