"""The hit as a moving picture: the arm's run-up, the impact, and the box until it rests."""

from __future__ import annotations

from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np

from hitjoints.counting import counted
from hitjoints.datasets.files import check_writable, write_whole
from hitjoints.show.arm_faces import box_centre
from hitjoints.show.drawn_arm import BoxAt, add_ground, arm_picture, chain
from hitjoints.show.sheet import Sheet
from hitjoints.show.style import Look

if TYPE_CHECKING:
    from pathlib import Path

    from hitjoints.evidence.physics.simulated_hit import Simulation
    from hitjoints.show.picture import Picture
    from hitjoints.types import Array

ANIMATION_ENDINGS = (".gif",)
RATE, SLOWER = 20, 8
"""Pictures per second, and how much slower than the hit they pass."""
PICTURES = 120
"""At most; more would take minutes to draw, so a long slide passes faster."""
PAUSE = 1.0
"""s, for which the last picture stays."""
WIDTH, DOTS = 6.4, 90
"""in, and dots per inch."""
TABLE, TABLE_EDGE = "#CBB8A0", 0.12
"""Colour, and how far it reaches beyond the box's way, m."""


def save_animation(result: Simulation, path: Path) -> None:
    """Save a simulated hit as a GIF, drawn by matplotlib, which needs no screen.

    The arm stays where the engine has left it: at the parting when it is free, and at rest when
    its servos follow the rollout.

    Raises:
        InputError: another ending, or a path that cannot be written.
    """
    from matplotlib.animation import PillowWriter

    check_writable(path, "animate", ANIMATION_ENDINGS)
    film = _Film(result)
    look = Look()
    writer = PillowWriter(fps=RATE)

    def write(made: Path) -> None:
        across, up = np.ptp(film.bounds, axis=1)
        with look.applied():
            figure = Sheet(look, figsize=(WIDTH, WIDTH * up / across + 0.4))
            axis = figure.add_subplot()
            with writer.saving(figure, str(made), dpi=DOTS):
                for time in counted(film.times, "pictures"):
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
        self.centres = self.centres + self._to_the_surface(self.q[len(approach)])
        length = self.box_times[-1] - self.arm_times[0]
        count = min(PICTURES, int(length * RATE * SLOWER) + 2)
        self.times = np.linspace(self.arm_times[0], self.box_times[-1], count)
        self.slower = count / RATE / length
        robot, ends = motion.robot, self.q[[0, len(approach), -1]]
        boxes = np.vstack([self.corners(time) for time in (self.times[0], self.times[-1])])
        self.table = None if result.slide is None else _table_under(boxes)
        self.seen = np.vstack((*(chain(robot, q) for q in ends), boxes))
        shown = [self.picture(time).bounds() for time in (*self.times[[0, -1]], 0.0)]
        self.bounds = np.stack([np.min(shown, axis=0)[:, 0], np.max(shown, axis=0)[:, 1]], axis=1)

    def _to_the_surface(self, q: Array) -> Array:
        """Return how far the box is drawn ahead (3,) m: the engine knows a point that hits it.

        Args:
            q: (n,) rad, at the first touch.
        """
        impact, robot = self.result.impact, self.result.motion.robot
        h, size = impact.direction, np.array(self.result.setting.size)
        touched = box_centre(robot, q, impact.contact, h, size, _rotation(self.turns[0]))
        return np.asarray(max(0.0, float(h @ (touched - self.centres[0]))) * h)

    def picture(self, time: float) -> Picture:
        """Return what there is to see at a time (s)."""
        impact, robot = self.result.impact, self.result.motion.robot
        q = np.array([np.interp(time, self.arm_times, column) for column in self.q.T])
        # From the side, a little from behind, so that the motion crosses the picture.
        heading = float(np.degrees(np.arctan2(impact.direction[1], impact.direction[0])))
        picture, _ = arm_picture(
            robot, q, impact.contact, box=BoxAt(self.corners(time)), ellipsoid=False,
            azimuth=heading - 115,
        )  # fmt: skip
        if self.table is not None:
            picture.ground(self.table, TABLE)
        add_ground(picture, self.seen)
        return picture

    def draw(self, axis: Any, time: float) -> None:
        """Draw the moment on a cleared axis."""
        self.picture(time).draw(axis, self.bounds)
        slow = f"{self.slower:.2g} x slower"
        name = self.result.motion.robot.name
        axis.set_title(f"{name}, {self.result.mode} hit: {1e3 * time:+.0f} ms, {slow}")

    def corners(self, time: float) -> Array:
        """Return the corners (8, 3) of the box."""
        row = max(0, int(np.searchsorted(self.box_times, time, side="right")) - 1)
        half = np.array(self.result.setting.size) / 2 * np.array(list(product((-1, 1), repeat=3)))
        return np.asarray(self.centres[row] + half @ _rotation(self.turns[row]).T)


def _rotation(quaternion: Array) -> Array:
    import pinocchio as pin

    return np.asarray(pin.Quaternion(*quaternion).toRotationMatrix())


def _table_under(boxes: Array) -> Array:
    """Return the corners (4, 3) m of a table's top under boxes, corners (N, 3) m."""
    (left, near, low), (right, far, _) = boxes.min(axis=0), boxes.max(axis=0)
    left, near, right, far = (
        left - TABLE_EDGE,
        near - TABLE_EDGE,
        right + TABLE_EDGE,
        far + TABLE_EDGE,
    )
    return np.array([[left, near, low], [right, near, low], [right, far, low], [left, far, low]])
