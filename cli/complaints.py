"""The lines that go to stderr."""

from __future__ import annotations

import sys

from hitjoints.errors import shown

LONGEST = 2000  # letters of a line


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
    line = shown(text, longest=LONGEST)
    return "".join(c if c.isprintable() else ascii(c)[1:-1] for c in line)
