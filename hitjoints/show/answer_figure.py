"""Draw the story of a hit: the arm before, at and after it, the object's way, limits used."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from hitjoints.dynamics.kinematics import position
from hitjoints.show.drawn_arm import BoxAt, add_ground, arm_picture, chain
from hitjoints.show.plan_figure import OBJECT, draw_plan
from hitjoints.show.sheet import Sheet, below, sheet
from hitjoints.show.style import Look, colour_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from hitjoints.answers.answer_record import Answer
    from hitjoints.goals.landing import Landing
    from hitjoints.swings.swing_record import Swing

SIGMAS = 2.0
"""The ellipse of the landing is drawn at so many standard deviations."""
GHOST = "#6B7280"


def draw_answer(answer: Answer, look: Look) -> Sheet:
    """Return the figure of an answer: of its swing, or of its plan if there is none."""
    swing = answer.swing
    if swing is None:
        return draw_plan(answer.plan, answer.robot, look)
    figure, (arm, way, limits) = sheet(look, 3, 3, (4.6, 4.4))
    _draw_arms(arm, swing)
    draw_way(way, swing, answer.landing)
    _draw_limits(limits, swing)
    figure.headline(f"{answer.robot.name}: {swing.hit.words}\n{answer.words}")
    return figure


def _draw_arms(axis: Axes, swing: Swing) -> None:
    """The arm at the impact, with thin lines where it starts and where it stops."""
    robot, hit, q = swing.robot, swing.hit, swing.q_hit
    contact = robot.contact(hit.chosen_contact)
    size = OBJECT if hit.size is None else hit.size
    box = BoxAt.touched(robot, q, contact, hit.direction, size, hit.yaw)
    picture, handles = arm_picture(robot, q, contact, hit.direction, box=box, ellipsoid=False)
    for ends, style, name in ((swing.q0, "--", "start"), (swing.joints.q[-1], ":", "end")):
        picture.line(chain(robot, ends), ls=style, color=GHOST, lw=1.5, label=name)
    grid = add_ground(picture, np.vstack([chain(robot, q), chain(robot, swing.q0), box.corners]))
    picture.draw(axis)
    axis.set_title(f"at the hit; {grid}")
    handles += axis.get_legend_handles_labels()[0]
    below(axis, 0.5, 2, handles=handles)


def draw_way(axis: Axes, swing: Swing, landing: Landing | None) -> None:
    """Draw the table from above: the contact's way to the object, and the object's to its rest."""
    hit, robot = swing.hit, swing.robot
    contact = hit.chosen_contact
    every = max(1, len(swing.joints.q) // 200)
    way = np.array([position(robot, q, contact) for q in swing.joints.q[::every]])
    colour = colour_of(contact.joint)
    axis.plot(way[:, 0], way[:, 1], color=colour, label=f"joint {contact.joint}")
    axis.plot(*hit.position[:2], "s", color="#E69F00", ms=9, label="object")
    if landing is not None:
        end, begin = (tuple(place[:2].tolist()) for place in (landing.nominal, hit.position))
        arrow = {"arrowstyle": "->", "color": "#E69F00"}
        axis.annotate("", end, begin, arrowprops=arrow)
        axis.plot(*landing.samples.T, ".", color="#0072B2", ms=2, alpha=0.3, zorder=1)
        ellipse = _ellipse(landing.mean[:2], landing.covariance)
        axis.plot(*ellipse, color="#0072B2", label=f"landing, {SIGMAS:g} standard deviations")
        circle = landing.goal[:2, None] + landing.tolerance * _around()
        axis.plot(*circle, color="black", ls="--", lw=1, label=f"within {landing.tolerance:g} m")
        axis.plot(*landing.goal[:2], "x", color="black", label="goal")
    axis.set(xlabel="x (m)", ylabel="y (m)", aspect="equal")
    axis.set_aspect("equal", adjustable="datalim")
    axis.set_title("from above")
    below(axis, 3, 2)


def _around() -> np.ndarray:
    turn = np.linspace(0, 2 * np.pi, 100)
    return np.stack([np.cos(turn), np.sin(turn)])


def _ellipse(middle: np.ndarray, covariance: np.ndarray) -> np.ndarray:
    values, axes = np.linalg.eigh(covariance)
    spread = axes * np.sqrt(np.maximum(values, 0.0))
    return np.asarray(middle[:, None] + SIGMAS * spread @ _around())


def _draw_limits(axis: Axes, swing: Swing) -> None:
    """What the motion takes of each limit at most."""
    fast, hard, jerky = swing.ratios
    shares = {
        "velocity": fast,
        "acceleration": hard,
        "jerk": jerky if swing.limits.jerk_known else np.nan,
        "torque": swing.torque_ratio_max,
    }
    for place, share in enumerate(shares.values()):
        if np.isfinite(share):
            axis.barh(place, share, color="#56B4E9" if share <= 1 else "#D55E00", height=0.6)
            axis.text(min(share, 1.0) / 2, place, f"{share:.2f}", va="center", ha="center")
        else:
            axis.text(0.03, place, "not known", va="center", color="dimgrey")
    axis.axvline(1.0, color="black", lw=1)
    axis.set_yticks(range(len(shares)), list(shares))
    axis.set(xlim=(0, 1.15), xlabel="share of the limit", title="most that is used")
    axis.invert_yaxis()
