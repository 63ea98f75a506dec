"""Run the benchmarks: `python -m benchmarks [--json] [NAME...]`."""

from __future__ import annotations

import json
import platform
import sys
from dataclasses import asdict
from importlib import import_module, metadata

from rich.console import Console
from rich.table import Table

from benchmarks.harness import Row

MODULES = ("startup", "single_call", "kernels", "workspace")
PACKAGES = ("pin", "proxsuite", "numpy", "llvmlite", "xarray", "zarr")


def main(words: list[str]) -> None:
    """Measure and print."""
    chosen = [word for word in words if not word.startswith("-")] or list(MODULES)
    rows: list[Row] = []
    for name in chosen:
        print(f"measuring {name} ...", file=sys.stderr)
        rows += import_module(f"benchmarks.{name}").measure()
    if "--json" in words:
        print(json.dumps([asdict(row) | {"met": row.met} for row in rows]))
        return
    versions = ", ".join(f"{name} {metadata.version(name)}" for name in PACKAGES)
    print(f"{platform.machine()}, Python {platform.python_version()}; {versions}")
    table = Table(box=None, header_style="bold")
    for column in ("what", "ours", "peer", "ours", "peer", "ratio", "min .. max", "target", ""):
        table.add_column(column)
    for row in rows:
        table.add_row(
            row.what,
            row.ours,
            row.peer,
            _time(row.ours_time),
            _time(row.peer_time),
            f"{row.ratio:.3g}x {'the cost' if row.meaning == 'cost' else 'faster'}",
            f"{row.low:.3g} .. {row.high:.3g}",
            row.target,
            "" if not row.target else "met" if row.met else "NOT met",
        )
    Console(width=200).print(table)


def _time(value: float) -> str:
    for unit, scale in (("s", 1.0), ("ms", 1e-3), ("us", 1e-6)):
        if value >= scale:
            return f"{value / scale:.3g} {unit}"
    return f"{value / 1e-9:.3g} ns"


if __name__ == "__main__":
    main(sys.argv[1:])
