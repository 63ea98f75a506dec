"""The lines that go to stderr."""

from __future__ import annotations

import sys

from hitjoints.errors import LONGEST_TEXT, shortened

LONGEST = 2 * LONGEST_TEXT  # letters of a line


def complain(kind: str, message: str) -> None:
    """Print one line on stderr; if that cannot be done, nobody can be told."""
    if sys.stderr is None:
        return
    try:
        print(f"{kind}: {printable(message)}", file=sys.stderr)
    except OSError:
        sys.stderr = None


def printable(text: str) -> str:
    """Return a text on one line, without what would move a terminal's cursor."""
    line = shortened(" ".join(text.split()), LONGEST)
    return "".join(c if c.isprintable() else ascii(c)[1:-1] for c in line)
