"""Ctrl-C and a request to end, from the first import to the last line."""

from __future__ import annotations

import _thread
import os
import signal
import sys
import threading
from typing import Any

WORDS = {signal.SIGINT: "interrupted", signal.SIGTERM: "terminated"}
AGAIN = 0.05  # s


class Signals:
    """Remembers the signal that asks the process to end, and breaks off what it does.

    Attributes:
        taken: the signal, None as long as there was none.
    """

    def __init__(self) -> None:
        self.taken: signal.Signals | None = None
        self._over = False

    def take(self) -> None:
        """Take the signals of this process from now on; what it ignores, it goes on to ignore."""
        for one in WORDS:
            if signal.getsignal(one) is not signal.SIG_IGN:
                signal.signal(one, self._end)
        sys.unraisablehook = self._again

    @property
    def words(self) -> str:
        """What happened."""
        assert self.taken is not None
        return WORDS[self.taken]

    def close(self) -> None:
        """Break nothing off any more: whoever insists ends the process at once."""
        self._over = True

    def _end(self, number: int, _: Any) -> None:
        if self._over:
            os._exit(128 + number)
        self.taken = signal.Signals(number)
        raise KeyboardInterrupt

    def _again(self, lost: sys.UnraisableHookArgs) -> None:
        """Break off once more: the exception came up where Python can only ignore it."""
        if self.taken is None:
            sys.__unraisablehook__(lost)
        else:
            again = threading.Timer(AGAIN, self._interrupt)
            again.daemon = True
            again.start()

    def _interrupt(self) -> None:
        if not self._over:
            _thread.interrupt_main()
