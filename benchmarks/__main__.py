"""Run the benchmarks: `python -m benchmarks [--json | --write] [NAME...]`."""

from __future__ import annotations

import json
import os
import platform
import sys
from dataclasses import asdict
from datetime import date
from importlib import import_module, metadata
from pathlib import Path

from rich.console import Console
from rich.table import Table

from benchmarks.harness import Figure, Remark, Row

MODULES = (
    "startup",
    "single_call",
    "programs",
    "kernels",
    "workspace",
    "planning",
    "control",
    "learning",
    "recordings",
    "simulation",
)
PACKAGES = ("pin", "proxsuite", "numpy", "scipy", "llvmlite", "xarray", "zarr")
PEERS = (
    "pybullet",
    "qpsolvers",
    "osqp",
    "mujoco",
    "drake",
    "roboticstoolbox-python",
    "pin-pink",
    "daqp",
    "quadprog",
    "clarabel",
)

TABLE = Path(__file__).parents[1] / "docs" / "benchmarks_table.md"
COLUMNS = ("what", "ours", "peer", "ours", "peer", "ratio", "min .. max", "target", "")


def main(words: list[str]) -> None:
    """Measure, print, and with --write keep the table for the documentation."""
    chosen = [word for word in words if not word.startswith("-")] or list(MODULES)
    rows: list[Row | Figure | Remark] = []
    for name in chosen:
        print(f"measuring {name} ...", file=sys.stderr)
        rows += import_module(f"benchmarks.{name}").measure()
    if "--json" in words:
        print(json.dumps([asdict(row) | {"met": row.met} for row in rows]))
        return
    print(_circumstances())
    table = Table(*COLUMNS, box=None, header_style="bold")
    for row in rows:
        table.add_row(*_cells(row))
    Console(width=200).print(table)
    if "--write" in words:
        lines = [" | ".join(("", *cells, "")).strip() for cells in (COLUMNS, *map(_cells, rows))]
        lines.insert(1, "|" + " --- |" * len(COLUMNS))
        TABLE.write_text(f"{_circumstances()}\n\n" + "\n".join(lines) + "\n")


def _circumstances() -> str:
    versions = ", ".join(map(_version, PACKAGES + PEERS))
    return (
        f"{date.today()}, `python -m benchmarks`, {platform.machine()} with {os.cpu_count()} "
        f"processors, Python {platform.python_version()}; {versions}"
    )


def _version(package: str) -> str:
    try:
        return f"{package} {metadata.version(package)}"
    except metadata.PackageNotFoundError:
        return f"no {package}"


def _cells(row: Row | Figure | Remark) -> tuple[str, ...]:
    if isinstance(row, Remark):
        return row.what, "", row.peer, "", "", "", "", "", row.verdict
    if isinstance(row, Figure):
        value = f"{row.value:.3g} {row.unit}"
        return row.what, value, "", "", "", "", "", row.target, row.verdict
    return (
        row.what,
        row.ours,
        row.peer,
        _time(row.ours_time),
        _time(row.peer_time),
        f"{row.ratio:.3g}x {_meaning(row)}".strip(),
        f"{row.low:.3g} .. {row.high:.3g}",
        row.target,
        row.verdict,
    )


def _meaning(row: Row) -> str:
    if row.meaning == "cost":
        return "the cost"
    return "faster" if row.ratio >= 1 else ""


def _time(value: float) -> str:
    for unit, scale in (("s", 1.0), ("ms", 1e-3), ("us", 1e-6)):
        if value >= scale:
            return f"{value / scale:.3g} {unit}"
    return f"{value / 1e-9:.3g} ns"


if __name__ == "__main__":
    main(sys.argv[1:])
