"""The door to MuJoCo, an extra: `pip install 'hitjoints[sim]'`."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from hitjoints.errors import MissingExtraError, ModelError


def engine() -> Any:
    """Return the module `mujoco`, which keeps its warnings out of files of its own.

    Raises:
        MissingExtraError: it is not installed.
    """
    try:
        mujoco = import_module("mujoco")
    except ImportError:
        raise MissingExtraError("mujoco", "sim") from None
    mujoco.set_mju_user_warning(_ignore)
    return mujoco


def compiled(spec: Any, source: str) -> Any:
    """Return the model of a scene; `source` is what to call it in messages.

    Raises:
        ModelError: the engine refuses it, such as a body with moments of inertia that no body has.
    """
    try:
        return spec.compile()
    except ValueError as error:
        reason = " ".join(str(error).removeprefix("Error: ").split())
        raise ModelError(source, f"the physics engine refuses it ({reason})") from None


def _ignore(_: str) -> None:
    """Without this MuJoCo writes MUJOCO_LOG.TXT to the working folder, without end if need be."""
