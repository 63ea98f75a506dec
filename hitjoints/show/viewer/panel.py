"""The panel beside the scene: timeline, candidates, and tabs of the hit, joints and numbers."""

from __future__ import annotations

import threading
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from hitjoints.show.viewer import readout
from hitjoints.show.viewer.hit_controls import HitControls
from hitjoints.show.viewer.making import MOTIONS
from hitjoints.show.viewer.timeline import SPEEDS

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from numpy.typing import ArrayLike

    from hitjoints.model.robot import Robot
    from hitjoints.show.viewer.stage import Stage
    from hitjoints.types import Array

STEP = 0.001  # rad, of the sliders, and s of the time
BUSY = '<p style="margin:0.3em 0.75em;font-size:0.85em">{} ...</p>'
NO = '<p style="margin:0.3em 0.75em;font-size:0.85em;color:{}"><b>No:</b> {}</p>'


SHEET = """<style>
@media (max-width: 36em) { .mantine-Paper-root[style*="bottom: 0"][style*="20em"] {
  width: 100% !important; max-height: 50% !important; }
  .mantine-Paper-root[style*="bottom: 0"][style*="20em"] [style*="width: 20em"] {
  width: 100% !important; } }
</style>"""
"""On a phone viser's sheet of controls leaves the left edge free and covers most of the rest."""


class Pressed(Protocol):
    """What the panel's controls do; the viewer does it."""

    def change(self, work: Callable[[], None], *, plans: bool = True) -> None:
        """Change what is wanted, and plan for it."""

    def glance(self, work: Callable[[], None]) -> None:
        """Change what is shown alone."""

    def ask_plan(self) -> None:
        """Plan for what is wanted."""

    def play_or_pause(self) -> None:
        """Play the motion, made first where there is none, or pause."""

    def scrub(self, time: float) -> None:
        """Show a moment of the motion, s."""

    def set_speed(self, speed: float) -> None:
        """Play so many times as fast as it is."""

    def dress(self) -> None:
        """Show the scene as the panel's View tab says."""


class Panel:
    """Builds the controls and keeps them as the stage is.

    Args:
        gui: viser's.
        stage: that is shown.
        do: what the controls do.
    """

    def __init__(self, gui: Any, stage: Stage, do: Pressed) -> None:
        self._stage, self._turned = stage, False
        self._setting = threading.local()
        gui.set_panel_label(f"hitjoints: {stage.robot.name}")
        self._build_timeline(gui, do)
        gui.add_html(SHEET)
        self._answer = gui.add_html("", visible=False)
        self._candidates = gui.add_html("")
        tabs = gui.add_tab_group()
        with tabs.add_tab("Hit"):
            self.hit = HitControls(gui, stage, do, self._heard)
        with tabs.add_tab("Joints"):
            self._joints = gui.add_html("")
            low, high = stage.robot.finite_limits
            self.sliders: list[Any] = [
                # A locked joint's slider has an end that it never goes to.
                gui.add_slider(f"q{i + 1}", low[i], max(high[i], low[i] + STEP), STEP, value)
                for i, value in enumerate(on_sliders(stage.robot, stage.q))
            ]
            for slider in self.sliders:
                slider.on_update(self._heard(lambda: do.glance(self._turn)))
        with tabs.add_tab("Numbers"):
            self._here = gui.add_html("")
        with tabs.add_tab("View"):
            self.dark = gui.add_checkbox("dark", False)
            self.arrows = gui.add_checkbox("arrows to drag", True)
            for box in (self.dark, self.arrows):
                box.on_update(lambda _: do.dress())
        self.scale = ""

    def _build_timeline(self, gui: Any, do: Pressed) -> None:
        self.play = gui.add_button("play")
        self.play.on_click(lambda _: do.play_or_pause())
        self.time = gui.add_slider("time (s)", 0.0, STEP, STEP, 0.0, visible=False)
        self.time.on_update(self._heard(lambda: do.scrub(self.time.value)))
        self._speeds = {f"{speed:g} ×": speed for speed in SPEEDS}
        self.speed = gui.add_dropdown("speed", tuple(self._speeds), initial_value="1 ×")
        self.speed.on_update(self._heard(lambda: do.set_speed(self._speeds[self.speed.value])))
        self.motion = gui.add_dropdown("motion", MOTIONS)
        self.motion.on_update(self._heard(lambda: do.change(self._stage.change)))
        self._motion = gui.add_html("", visible=False)

    def _heard(self, act: Callable[[], None]) -> Callable[[object], None]:
        """Return a callback that is deaf to what the panel itself sets, in the thread that does."""

        def callback(_: object) -> None:
            if not getattr(self._setting, "here", False):
                act()

        return callback

    @contextmanager
    def _deaf(self) -> Iterator[None]:
        self._setting.here = True
        try:
            yield
        finally:
            self._setting.here = False

    def _turn(self) -> None:
        robot, self._turned = self._stage.robot, True
        wanted = np.array([slider.value for slider in self.sliders])
        self._stage.turn(np.clip(wanted, robot.lower, robot.upper))

    def say(self, text: str, *, no: bool = False, busy: bool = False) -> None:
        """Say that it is busy, or why not; an empty text takes that back."""
        self._answer.content = (
            NO.format(readout.RED, text) if no else BUSY.format(text) if busy else ""
        )
        self._answer.visible = bool(text)

    def refresh(self) -> None:
        """Show what the stage says."""
        with self._deaf():
            self.hit.refresh()
            self._candidates.content = readout.candidates(self._stage)
            clip = self._stage.clip
            self.time.max = max(STEP, 0.0 if clip is None else round(clip.duration, 3))
            self.time.visible = clip is not None
            self._motion.content = words = readout.motion(self._stage)
            self._motion.visible = bool(words)
        self.moment()

    def moment(self) -> None:
        """Show what changes with the configuration and the time."""
        stage = self._stage
        with self._deaf():
            if not self._turned:  # else the browser may be ahead, and would be pulled back
                for slider, q in zip(self.sliders, on_sliders(stage.robot, stage.q), strict=True):
                    slider.value = q
            self._turned = False
            self.time.value = min(round(stage.time, 3), self.time.max)
            self._joints.content = readout.joints(stage)
            self._here.content = readout.here(stage) + readout.note(self.scale)

    def playing(self, plays: bool) -> None:
        """Show whether it plays."""
        self.play.label = "pause" if plays else "play"

    def set_speed(self, speed: float) -> None:
        """Show a speed of playing."""
        with self._deaf():
            self.speed.value = f"{speed:g} ×"


def on_sliders(robot: Robot, q: ArrayLike) -> list[float]:
    """Return a configuration (n,) rad as sliders show it: continuous joints within one turn."""
    q = np.asarray(q)
    turned: Array = np.remainder(q + np.pi, 2 * np.pi) - np.pi
    shown = np.where(np.isfinite(robot.lower) & np.isfinite(robot.upper), q, turned)
    return [float(value) for value in np.clip(shown, *robot.finite_limits)]
