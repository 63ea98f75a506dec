"""From what a user gives as a tool to a `Tool`."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from hitjoints.errors import InputError
from hitjoints.loading.source import read_text
from hitjoints.model.tool import Tool

Asked = Tool | str | Path | Mapping[str, Any]


def read_tool(asked: Asked | None, folder: Path | None = None) -> Tool | None:
    """Return a tool.

    Args:
        asked: a Tool, the path of a TOML with its entries, or those entries; None for no tool.
        folder: what a relative path starts from.

    Raises:
        InputError: the file cannot be read, is no TOML, or holds what no tool has.
    """
    if asked is None or isinstance(asked, Tool):
        return asked
    if isinstance(asked, Mapping):
        return Tool.read(asked)
    path = Path(folder or "", asked)
    try:
        return Tool.read(tomllib.loads(read_text(path, "tool")))
    except (tomllib.TOMLDecodeError, RecursionError) as error:
        raise InputError("tool", path, f"not a TOML file ({error})") from None
