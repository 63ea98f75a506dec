"""Rows as a table: for people, and for the documentation."""

from __future__ import annotations

import os
import platform
from collections.abc import Sequence
from datetime import date
from importlib import metadata

from rich.table import Table

from benchmarks.harness import Figure, Remark, Row
from benchmarks.peers.install import names

COLUMNS = ("what", "ours", "peer", "ours", "peer", "ratio", "min .. max", "target", "")
PACKAGES = ("pin", "proxsuite", "numpy", "llvmlite", "xarray", "zarr")

Result = Row | Figure | Remark


def table(rows: Sequence[Result]) -> Table:
    """Return the table to print."""
    printed = Table(*COLUMNS, box=None, header_style="bold")
    for row in rows:
        printed.add_row(*cells(row))
    return printed


def markdown(rows: Sequence[Result], command: str) -> str:
    """Return the table for the documentation."""
    lines = [" | ".join(("", *row, "")).strip() for row in (COLUMNS, *map(cells, rows))]
    lines.insert(1, "|" + " --- |" * len(COLUMNS))
    return f"{circumstances(command)}\n\n" + "\n".join(lines) + "\n"


def circumstances(command: str) -> str:
    """Return when, how, on what machine and with which versions the rows were measured."""
    versions = ", ".join(map(version, dict.fromkeys(PACKAGES + names())))
    return (
        f"{date.today()}, `{command}`, {platform.machine()} with {os.cpu_count()} "
        f"processors, Python {platform.python_version()}; {versions}"
    )


def version(package: str) -> str:
    """Return a package's name and version, or that it is not there."""
    try:
        return f"{package} {metadata.version(package)}"
    except metadata.PackageNotFoundError:
        return f"no {package}"


def cells(row: Result) -> tuple[str, ...]:
    """Return the text of a row, one for each of `COLUMNS`."""
    if isinstance(row, Remark):
        return row.what, "", row.peer, "", "", "", "", "", row.verdict
    if isinstance(row, Figure):
        value = f"{row.value:.3g} {row.unit}".strip()
        return row.what, value, "", "", "", "", "", row.target, row.verdict
    return (
        row.what,
        row.ours,
        row.peer,
        duration(row.ours_time),
        duration(row.peer_time),
        f"{row.ratio:.3g}x {_meaning(row)}".strip(),
        f"{row.low:.3g} .. {row.high:.3g}",
        row.target,
        row.verdict,
    )


def duration(seconds: float) -> str:
    """Return a time in a unit that suits it."""
    for unit, scale in (("s", 1.0), ("ms", 1e-3), ("us", 1e-6)):
        if seconds >= scale:
            return f"{seconds / scale:.3g} {unit}"
    return f"{seconds / 1e-9:.3g} ns"


def _meaning(row: Row) -> str:
    if row.meaning == "cost":
        return "the cost"
    return "faster" if row.ratio >= 1 else ""
