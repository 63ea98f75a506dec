"""What is seen of work that takes long: a bar on a terminal, else a line now and then."""

from __future__ import annotations

import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from .complaints import complain, loudness, on_screen

if TYPE_CHECKING:
    from rich.progress import Progress, TaskID

PATIENCE = 0.8
"""s, until something is shown."""
SILENCE = 10.0
"""s, between two lines that go to a file."""


class Display:
    """The bars of a command, by what is counted; all vanish when something is printed."""

    def __init__(self) -> None:
        self._terminal = sys.stderr is not None and sys.stderr.isatty()
        self._begun = self._said = time.monotonic()
        self._lock = threading.RLock()
        self._counts: dict[str, tuple[int, int | None]] = {}
        self._bars: Progress | None = None
        self._tasks: dict[str, TaskID] = {}
        self._first = threading.Timer(PATIENCE, self._draw)
        self._first.daemon = True
        if self._terminal:
            self._first.start()

    def __call__(self, what: str, done: int, total: int | None) -> None:
        """Show that so many are done of what is counted; None where nobody knows of how many."""
        with self._lock:
            if total is not None and done >= total:
                self._counts.pop(what, None)
            else:
                self._counts[what] = done, total
        now = time.monotonic()
        if self._terminal and now - self._begun > PATIENCE:
            self._draw()
        elif not self._terminal and now - self._said > SILENCE and done != total:
            self._said = now
            complain("progress", f"{done} of {total} {what}" if total else what)

    def pause(self) -> None:
        """Let the bars vanish, until there is news of them."""
        self._first.cancel()
        with self._lock:
            if self._bars is not None:
                self._bars.stop()
                self._bars, self._tasks = None, {}

    def _draw(self) -> None:
        """Show every count, or that something is done where nothing is counted."""
        with self._lock:
            if self not in on_screen:
                return  # it is over
            if self._bars is None:
                self._bars = _bars()
                self._bars.start()
            counts = self._counts or {"working": (0, None)}
            for what in [name for name in self._tasks if name not in counts]:
                self._bars.remove_task(self._tasks.pop(what))
            for what, (done, total) in counts.items():
                if what not in self._tasks:
                    self._tasks[what] = self._bars.add_task(what, total=total)
                self._bars.update(self._tasks[what], completed=done, total=total)


@contextmanager
def progress() -> Iterator[Display | None]:
    """Show the progress of what runs inside, as the library counts it."""
    from hitjoints.counting import counts_shown_by

    if not loudness.tells("progress"):
        yield None
        return
    display = Display()
    on_screen.append(display)
    try:
        with counts_shown_by(display):
            yield display
    finally:
        on_screen.remove(display)
        display.pause()


def _bars() -> Progress:
    from rich.console import Console
    from rich.progress import (
        BarColumn,
        MofNCompleteColumn,
        Progress,
        SpinnerColumn,
        TextColumn,
        TimeElapsedColumn,
        TimeRemainingColumn,
    )

    columns: list[Any] = [
        SpinnerColumn(), TextColumn("{task.description}"), BarColumn(bar_width=24),
        MofNCompleteColumn(), TimeElapsedColumn(), TextColumn("left"), TimeRemainingColumn(),
    ]  # fmt: skip
    return Progress(
        *columns, console=Console(stderr=True), transient=True, redirect_stdout=False,
        redirect_stderr=False,
    )  # fmt: skip
