"""Play, pause, scrub, speed: what time it is in a motion."""

from __future__ import annotations

import threading
import time
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

FRAMES = 30.0
"""Pictures per second, at most."""
SPEEDS = (0.05, 0.1, 0.25, 0.5, 1.0, 2.0)
"""Times as fast as it is; a hit takes a tenth of a second."""


class Timeline:
    """The time in a motion, and whether it passes. `tick` is all that makes it pass.

    Args:
        show: called with the new time, s, whenever it changes by playing or scrubbing.
        stopped: called when the end is reached.
    """

    def __init__(self, show: Callable[[float], None], stopped: Callable[[], None]) -> None:
        self._show, self._stopped = show, stopped
        self.time, self.duration, self.speed, self.plays = 0.0, 0.0, 1.0, False
        self._wake, self._over = threading.Event(), threading.Event()
        self._thread = threading.Thread(target=self._run, name="timeline", daemon=True)
        self._thread.start()

    def load(self, duration: float) -> None:
        """Have another motion, of a duration in s, from its start."""
        self.pause()
        self.time, self.duration = 0.0, duration

    def play(self) -> None:
        """Go on, or begin again when the end is reached."""
        if self.time >= self.duration:
            self.time = 0.0
        self.plays = self.duration > 0
        self._wake.set()

    def pause(self) -> None:
        """Stand still."""
        self.plays = False
        self._wake.clear()

    def scrub(self, time: float) -> None:
        """Stand still at a time, s."""
        self.pause()
        self.time = min(max(time, 0.0), self.duration)
        self._show(self.time)

    def tick(self, elapsed: float) -> None:
        """Let so many seconds pass on the clock, if it plays."""
        if not self.plays:
            return
        self.time = min(self.time + self.speed * elapsed, self.duration)
        self._show(self.time)
        if self.plays and self.time >= self.duration:
            self.pause()
            self._stopped()

    def stop(self) -> None:
        """End for good."""
        self.pause()
        self._over.set()
        self._wake.set()

    def _run(self) -> None:
        while True:
            self._wake.wait()
            if self._over.is_set():
                return
            then = time.monotonic()
            self._over.wait(1.0 / FRAMES)
            while self.plays and not self._over.is_set():
                now = time.monotonic()
                elapsed, then = now - then, now
                self.tick(elapsed)
                self._over.wait(max(0.0, 1.0 / FRAMES - (time.monotonic() - now)))
