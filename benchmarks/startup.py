"""The command line's start-up against importing Pinocchio alone."""

from __future__ import annotations

import subprocess
import sys

from benchmarks.harness import Row, compare

PINOCCHIO = ("python -c 'import pinocchio'", [sys.executable, "-c", "import pinocchio"])
COMMANDS = {"hitjoints --help": ["--help"], "hitjoints inspect": ["inspect", "--json"]}


def measure() -> list[Row]:
    """Return the cost of each command as a multiple of Pinocchio's import."""

    def run(words: list[str]) -> None:
        subprocess.run(words, check=True, capture_output=True)

    rows = []
    for name, arguments in COMMANDS.items():
        words = [sys.executable, "-m", "hitjoints.cli", *arguments]
        rows.append(
            compare(
                "start-up",
                (name, lambda words=words: run(words), 1),  # type: ignore[misc]
                (PINOCCHIO[0], lambda: run(PINOCCHIO[1]), 1),
                meaning="cost",
                target="<= 1.25" if name.endswith("--help") else "",
            )
        )
    return rows
