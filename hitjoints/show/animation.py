"""The hit as a moving picture: the arm's run-up, the impact, and the box until it rests."""

from __future__ import annotations

from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np

from hitjoints.datasets.files import check_writable, write_whole
from hitjoints.dynamics.kinematics import position
from hitjoints.show.drawn_arm import add_solid, draw_arm, set_view

if TYPE_CHECKING:
    from pathlib import Path

    from hitjoints.evidence.physics.simulated_hit import Simulation
    from hitjoints.types import Array

ANIMATION_ENDINGS = (".gif",)
RATE, SLOWER = 20, 8
"""Pictures per second, and how much slower than the hit they pass."""
PICTURES = 120
"""At most; more would take minutes to draw, so a long slide passes faster."""
PAUSE = 1.0
"""s, for which the last picture stays."""


def save_animation(result: Simulation, path: Path) -> None:
    """Save a simulated hit as a GIF, drawn by matplotlib, which needs no screen.

    The arm stays where the engine has left it: at the parting when it is free, and at rest when
    its servos follow the rollout.

    Raises:
        InputError: another ending, or a path that cannot be written.
    """
    from matplotlib.animation import PillowWriter
    from matplotlib.figure import Figure

    check_writable(path, "animate", ANIMATION_ENDINGS)
    film = _Film(result)
    figure = Figure(figsize=(6.4, 5.6), layout="constrained")
    axis = figure.add_subplot(projection="3d")
    writer = PillowWriter(fps=RATE)

    def write(made: Path) -> None:
        with writer.saving(figure, str(made), dpi=80):
            for time in film.times:
                axis.clear()
                film.draw(axis, time)
                writer.grab_frame()
            for _ in range(round(PAUSE * RATE)):
                writer.grab_frame()

    write_whole(path, "animate", write)


class _Film:
    """Where everything is at a time (s) since the impact."""

    def __init__(self, result: Simulation) -> None:
        self.result = result
        rows, motion = result.strike.rows, result.motion
        assert motion.impact is not None
        approach = motion.dt * np.arange(motion.steps) - motion.impact.time
        self.arm_times = np.concatenate((approach, rows["time"]))
        self.q = np.concatenate((motion.rows["q"][: motion.steps], rows["q"]))
        self.box_times, self.centres, self.turns = (
            rows[name] for name in ("time", "box_position", "box_quaternion")
        )
        if result.slide is not None:
            slid = result.slide.rows
            self.box_times = np.concatenate((rows["time"], rows["time"][-1] + slid["slide_time"]))
            self.centres = np.concatenate((self.centres, slid["slide_position"]))
            self.turns = np.concatenate((self.turns, slid["slide_quaternion"]))
        length = self.box_times[-1] - self.arm_times[0]
        count = min(PICTURES, int(length * RATE * SLOWER) + 2)
        self.times = np.linspace(self.arm_times[0], self.box_times[-1], count)
        self.slower = count / RATE / length
        robot, ends = motion.robot, self.q[[0, len(approach), -1]]
        seen = [position(robot, q, k) for q in ends for k in range(1, robot.n + 1)]
        seen += [position(robot, q, robot.flange) for q in ends]
        boxes = [self.corners(time) for time in (self.times[0], self.times[-1])]
        self.seen = np.vstack((np.zeros(3), seen, *boxes))

    def draw(self, axis: Any, time: float) -> None:
        """Draw the moment on a cleared 3-D axis."""
        impact, robot = self.result.impact, self.result.motion.robot
        q = np.array([np.interp(time, self.arm_times, column) for column in self.q.T])
        add_solid(axis, self.corners(time))
        draw_arm(axis, robot, q, impact.contact, ellipsoid=False, view=False)
        set_view(axis, self.seen)
        # From the side, a little from behind, so that the motion crosses the picture.
        heading = np.degrees(np.arctan2(impact.direction[1], impact.direction[0]))
        axis.view_init(elev=18, azim=heading - 115)
        slow = f"{self.slower:.2g} x slower"
        title = f"{robot.name}, {self.result.mode} hit: {1e3 * time:+.0f} ms, {slow}"
        axis.set_title(title, fontsize="medium")

    def corners(self, time: float) -> Array:
        """Return the corners (8, 3) of the box."""
        row = max(0, int(np.searchsorted(self.box_times, time, side="right")) - 1)
        half = np.array(self.result.setting.size) / 2 * np.array(list(product((-1, 1), repeat=3)))
        return np.asarray(self.centres[row] + half @ _rotation(self.turns[row]).T)


def _rotation(quaternion: Array) -> Array:
    import pinocchio as pin

    return np.asarray(pin.Quaternion(*quaternion).toRotationMatrix())
