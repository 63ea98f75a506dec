"""The hit that a result keeps, whatever file the result is in."""

from __future__ import annotations

import html
import json
import re
import zipfile
import zlib
from pathlib import Path
from typing import Any

from hitjoints.errors import InputError

BEGINS = '{"schema": 1, '
LARGEST = 2**28  # bytes
DAMAGED = (
    *(OSError, ValueError, LookupError, EOFError, RuntimeError, TypeError),
    *(zipfile.BadZipFile, zlib.error),
)
"""What readers raise where a file is not what its name says."""
ENDINGS = (".json", ".csv", ".npz", ".yaml", ".nc", ".zarr", ".png", ".pdf", ".svg")
"""Of plans, answers, trajectories, data sets and figures."""


def tables_in(path: Path) -> Any:
    """Return the tables of the hit that a result was made for.

    Args:
        path: of a plan, an answer, a trajectory, a data set or a figure.

    Raises:
        InputError: the file cannot be read, or keeps no hit.
    """
    try:
        whole = path / "zarr.json" if path.is_dir() else path
        if not whole.is_file() or whole.stat().st_size > LARGEST:
            raise InputError("hit", path, "a file that hitjoints wrote is needed")
        found = _READERS.get(path.suffix, _in_text)(whole)
    except DAMAGED as error:
        if isinstance(error, InputError):
            raise
        raise InputError("hit", path, f"it cannot be read ({error})") from None
    if found is None:
        raise InputError("hit", path, "this file keeps no hit")
    return found


def _in_text(path: Path, text: str | None = None) -> Any:
    """Return the hit in a text, or None."""
    text = path.read_bytes().decode("latin-1") if text is None else text
    at = text.find(BEGINS)
    return None if at < 0 else json.JSONDecoder().raw_decode(text, at)[0]


def _in_json(path: Path) -> Any:
    return _in_value(json.loads(path.read_text(encoding="utf-8")))


def _in_value(value: Any) -> Any:
    """Return the first hit in a JSON value: tables, or the text of them."""
    if isinstance(value, str):
        return json.loads(value) if value.startswith(BEGINS) else None
    if isinstance(value, dict) and {"schema", "object", "wish"} <= value.keys():
        return value
    parts = value.values() if isinstance(value, dict) else value if isinstance(value, list) else ()
    return next((hit for part in parts if (hit := _in_value(part)) is not None), None)


def _in_npz(path: Path) -> Any:
    import numpy as np

    with np.load(path, allow_pickle=False) as arrays:
        return _in_value(json.loads(str(arrays["notes"])))


def _in_netcdf(path: Path) -> Any:
    import h5netcdf

    with h5netcdf.File(path, "r") as file:
        return _in_value(str(file.attrs["hit"])) if "hit" in file.attrs else None


def _in_pdf(path: Path) -> Any:
    """PDF marks parentheses and backslashes in a text."""
    return _in_text(path, re.sub(r"\\(.)", r"\1", path.read_bytes().decode("latin-1")))


def _in_svg(path: Path) -> Any:
    return _in_text(path, html.unescape(path.read_text(encoding="utf-8")))


_READERS: dict[str, Any] = {
    ".json": _in_json,
    ".zarr": _in_json,
    ".npz": _in_npz,
    ".nc": _in_netcdf,
    ".pdf": _in_pdf,
    ".svg": _in_svg,
}
