"""Which Zarr folders hitjoints wrote: no other is ever replaced."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

MARKER = "zarr.json"
CHUNK = re.compile(r"c|[0-9]+")
"""What zarr calls the folders and files of an array's chunks."""


def root_attributes(path: Path) -> dict[str, Any] | None:
    """Return the attributes of a Zarr group that hitjoints wrote; None for anything else."""
    try:
        attributes = json.loads((path / MARKER).read_text(encoding="utf-8"))["attributes"]
        ours = str(attributes["source"]).startswith("hitjoints ")
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        return None
    return attributes if ours else None


def why_not_ours(path: Path) -> str:
    """Return why a folder may not be replaced by another data set; empty if it may be.

    It may be if it is empty, or a data set of hitjoints with nothing else in it. A map of
    `sweep workspace` may not: it can hold the work of days.
    """
    if not any(path.iterdir()):
        return ""
    if root_attributes(path) is None:
        return "it is a folder that hitjoints did not write"
    if (path / "done").exists():
        return "it holds a map of sweep workspace: choose another name, or remove it"
    stranger = next(_strangers(path), None)
    return f"{stranger} in it is not of hitjoints" if stranger else ""


def _strangers(path: Path) -> Iterator[Path]:
    """Yield what lies in a Zarr group and is no part of it: chunks are called c, c/0, c/0/1 ..."""
    for folder, folders, names in os.walk(path):
        inside = Path(folder).relative_to(path)
        depth = len(inside.parts)
        for name in (*folders, *names):
            known = depth <= 1 and name == MARKER
            known |= depth == 0 and name in folders and (path / name / MARKER).is_file()
            known |= depth > 0 and CHUNK.fullmatch(name) is not None
            if not known or Path(folder, name).is_symlink():
                yield inside / name
