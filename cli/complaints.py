"""The lines that go to stderr."""

from __future__ import annotations

import shutil
import sys
import textwrap
from dataclasses import dataclass
from typing import Protocol

from hitjoints.errors import shown

LONGEST = 2000  # letters of a line
NARROWEST = 40  # columns, of a terminal that words are broken for
QUIETER = ("note", "progress", "written")
"""What `--quiet` leaves out."""


@dataclass
class Loudness:
    """How much is told: -1 without notes and progress, 1 with details."""

    level: int = 0

    def tells(self, kind: str) -> bool:
        """Tell whether lines of a kind are printed."""
        if kind == "detail":
            return self.level > 0
        return self.level >= 0 or kind not in QUIETER


loudness = Loudness()
"""Of the command that runs."""


class OnScreen(Protocol):
    """What stands on the terminal and moves, such as a bar."""

    def pause(self) -> None:
        """Let it vanish, until there is news of it."""


on_screen: list[OnScreen] = []


def pause() -> None:
    """Let what moves on the terminal vanish: something else is about to be printed."""
    for one in on_screen:
        one.pause()


def complain(kind: str, message: str) -> None:
    """Print one line on stderr; if that cannot be done, nobody can be told.

    On a terminal it is broken at words; a file or a pipe gets one line, to be searched.
    """
    if sys.stderr is None or not loudness.tells(kind):
        return
    pause()
    line = f"{kind}: {printable(message)}"
    try:
        if sys.stderr.isatty():
            line = textwrap.fill(
                line, columns(), subsequent_indent="  ", break_long_words=False,
                break_on_hyphens=False,
            )  # fmt: skip
        print(line, file=sys.stderr)
    except OSError:
        sys.stderr = None


def columns() -> int:
    """Return the terminal's width; COLUMNS goes before it, and a file or a pipe has 80."""
    return max(NARROWEST, shutil.get_terminal_size((80, 24)).columns)


def printable(text: str) -> str:
    """Return a text on one line, without what would move a terminal's cursor."""
    line = shown(text, longest=LONGEST)
    return "".join(c if c.isprintable() else ascii(c)[1:-1] for c in line)
