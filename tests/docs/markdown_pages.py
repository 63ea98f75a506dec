"""The blocks of a Markdown page, and what of them a test can run.

A block that cannot run has a line before it that says why: <!-- not run: REASON -->. Other such
lines are <!-- exit code: N --> and <!-- file: NAME -->.
"""

from __future__ import annotations

import re
import shlex
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parents[2]
NOTE = re.compile(r"<!-- (not run|exit code|file): (.+?) -->")
FENCE = re.compile(r"(`{3,})(\S*)(?: .*)?$")
FILE_KINDS = ("toml", "xml")
KINDS = ("console", "python", "text", "bibtex", *FILE_KINDS)


class Block(NamedTuple):
    """A fenced block: its first line's number, its language, its text, and the note before it."""

    line: int
    kind: str
    text: str
    notes: dict[str, str]

    @property
    def file(self) -> str | None:
        """The name of the file that it shows, if it is one."""
        named = self.kind in FILE_KINDS and re.match(r"(?:<!--|#) ([\w.]+\.\w+)", self.text)
        return named[1] if named else self.notes.get("file")

    @property
    def directive(self) -> bool:
        """Whether it is an instruction to Sphinx."""
        return self.kind.startswith("{")


class Line(NamedTuple):
    """A command line, and the words that it is said to print."""

    words: list[str]
    said: list[str]


def pages() -> list[Path]:
    """Return every page that people read."""
    return [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").glob("*.md"))]


def blocks(page: Path) -> list[Block]:
    """Return the fenced blocks of a page, in order."""
    found: list[Block] = []
    lines = page.read_text(encoding="utf-8").splitlines()
    i = 0
    while i < len(lines):
        opening = FENCE.match(lines[i])
        if opening:
            end = next(j for j in range(i + 1, len(lines)) if lines[j].strip() == opening[1])
            notes = dict(NOTE.findall(lines[i - 1])) if i else {}
            found.append(Block(i + 1, opening[2], "\n".join(lines[i + 1 : end]), notes))
            i = end
        i += 1
    return found


def command_lines(text: str) -> list[Line]:
    """Return what a console block types after "$ ", and what it says is printed."""
    found: list[Line] = []
    for line in text.replace("\\\n", " ").splitlines():
        if line.startswith("$ "):
            found.append(Line(shlex.split(line[2:], comments=True), []))
        elif found and line.strip() not in ("", "..."):
            found[-1].said.append(line.removesuffix(" ..."))
    return found


def spans(page: Path) -> list[list[str]]:
    """Return the command lines within the sentences and tables of a page."""
    text = page.read_text(encoding="utf-8")
    prose = re.sub(r"^(`{3,}).*?^\1$", "", text, flags=re.M | re.S)
    found = re.findall(r"`(hitjoints [^`]+)`", prose)
    return [shlex.split(span.replace("\\|", "|")) for span in found]


def tokens(text: str) -> list[str | float]:
    """Return the words and numbers of a printed text, without punctuation and tables' lines."""
    parts = re.findall(r"-?\d+\.?\d*(?:e-?\d+)?|[^\W\d]+|%", text)
    return [float(part) if part.strip("-")[0].isdigit() else part for part in parts]


def says(printed: str, line: str, tolerance: float = 0.02) -> bool:
    """Tell whether a line was printed: the same words, numbers to the tolerance."""
    have, wanted = tokens(printed), tokens(line)

    def same(a: str | float, b: str | float) -> bool:
        if isinstance(a, float) and isinstance(b, float):
            return abs(a - b) <= tolerance * max(abs(a), abs(b))
        return a == b

    return any(
        all(map(same, have[i : i + len(wanted)], wanted))
        for i in range(len(have) - len(wanted) + 1)
    )
