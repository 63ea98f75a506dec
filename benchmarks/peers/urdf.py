"""The files that the peers read."""

from __future__ import annotations

from importlib import resources


def urdf_path(name: str) -> str:
    """Return the path of one of our own URDFs, such as that of the iiwa14."""
    return str(resources.files("hitjoints.robots") / f"{name}.urdf")
