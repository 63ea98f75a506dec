"""The door to MuJoCo, an extra: `pip install 'hitjoints[sim]'`."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from hitjoints.errors import MissingExtraError


def engine() -> Any:
    """Return the module `mujoco`.

    Raises:
        MissingExtraError: it is not installed.
    """
    try:
        return import_module("mujoco")
    except ImportError:
        raise MissingExtraError("mujoco", "sim") from None
