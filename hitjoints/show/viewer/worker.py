"""Long work beside what is shown: only the latest of what was asked for is done."""

from __future__ import annotations

import sys
import threading
import time
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

PAUSE = 0.15
"""s after the last time something is asked for, so that what is dragged comes to rest."""


class Worker:
    """Does one thing at a time; what is asked for meanwhile waits, and only the last of it."""

    def __init__(self) -> None:
        self._asked: tuple[float, Callable[[], None]] | None = None
        self._changed = threading.Condition()
        self._busy = self._over = False
        threading.Thread(target=self._run, name="worker", daemon=True).start()

    def ask(self, job: Callable[[], None], pause: float = PAUSE) -> None:
        """Do a job after a pause (s), unless another is asked for until then."""
        with self._changed:
            self._asked = time.monotonic() + pause, job
            self._changed.notify_all()

    def wait(self, timeout: float) -> bool:
        """Wait until nothing is left to do, for so many seconds at most; tell whether it is so."""
        with self._changed:
            return self._changed.wait_for(lambda: self._asked is None and not self._busy, timeout)

    def stop(self) -> None:
        """Do nothing more; what is being done ends by itself."""
        with self._changed:
            self._over, self._asked = True, None
            self._changed.notify_all()

    def _run(self) -> None:
        while (job := self._next()) is not None:
            try:
                job()
            except Exception as error:  # a fault of ours: told as any other, and the next goes on
                sys.excepthook(type(error), error, error.__traceback__)
            finally:
                with self._changed:
                    self._busy = False
                    self._changed.notify_all()

    def _next(self) -> Callable[[], None] | None:
        """Wait for a job whose pause is over; None at the end."""
        with self._changed:
            while not self._over:
                left = None if self._asked is None else self._asked[0] - time.monotonic()
                if self._asked is not None and left is not None and left <= 0:
                    job, self._asked, self._busy = self._asked[1], None, True
                    return job
                self._changed.wait(left)
            return None
