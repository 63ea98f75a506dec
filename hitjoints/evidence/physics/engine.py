"""The door to MuJoCo, an extra: `pip install 'hitjoints[sim]'`."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from hitjoints.errors import MissingExtraError, SolverError


def engine() -> Any:
    """Return the module `mujoco`.

    Raises:
        MissingExtraError: it is not installed.
    """
    try:
        mujoco = import_module("mujoco")
    except ImportError:
        raise MissingExtraError("mujoco", "sim") from None
    # Its warnings would go to MUJOCO_LOG.TXT in the working folder; what they warn of is checked.
    mujoco.set_mju_user_warning(_ignore)
    return mujoco


def compiled(spec: Any) -> Any:
    """Return the engine's model of a scene.

    Args:
        spec: the scene, `mujoco.MjSpec`.

    Raises:
        SolverError: the engine refuses it.
    """
    try:
        return spec.compile()
    except ValueError as error:
        reason = str(error).strip().partition("\n")[0]
        raise SolverError(f"the engine refuses this scene: {reason}") from None


def _ignore(_: str) -> None:
    """Take a warning of the engine's."""
