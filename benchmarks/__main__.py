"""Run the benchmarks: `python -m benchmarks [--json | --write] [NAME...]`."""

from __future__ import annotations

import json
import sys
from dataclasses import asdict
from importlib import import_module
from pathlib import Path

from rich.console import Console

from benchmarks.plot import draw
from benchmarks.report import Result, circumstances, markdown, table

MODULES = (
    "startup",
    "single_call",
    "microseconds",
    "programs",
    "control",
    "rollouts",
    "planning",
    "kernels",
    "workspace",
    "learning",
    "recordings",
    "simulation",
    "elastic",
)
DOCS = Path(__file__).parents[1] / "docs"


def main(words: list[str]) -> None:
    """Measure, print, and with --write keep table and plot for the documentation."""
    chosen = [word for word in words if not word.startswith("-")] or list(MODULES)
    rows: list[Result] = []
    for name in chosen:
        print(f"measuring {name} ...", file=sys.stderr)
        rows += import_module(f"benchmarks.{name}").measure()
    if "--json" in words:
        print(json.dumps([asdict(row) | {"met": row.met} for row in rows]))
        return
    command = " ".join(("python -m benchmarks", *words))
    print(circumstances(command))
    Console(width=200).print(table(rows))
    if "--write" in words:
        (DOCS / "benchmarks_table.md").write_text(markdown(rows, command))
        draw(rows).savefig(DOCS / "figures" / "benchmarks.png", dpi=110)


if __name__ == "__main__":
    try:
        main(sys.argv[1:])
    except KeyboardInterrupt:
        print("interrupted; nothing was written: name fewer to measure less", file=sys.stderr)
        sys.exit(130)
