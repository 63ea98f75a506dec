"""The names of the robots there are: hitjoints' own, and the URDFs of example-robot-data."""

from __future__ import annotations

from functools import lru_cache
from importlib import metadata, resources
from pathlib import Path

from hitjoints.errors import InputError

ERD = "example-robot-data"


@lru_cache(maxsize=1)
def robot_names() -> tuple[str, ...]:
    """Return the names of the robots that come with hitjoints."""
    files = resources.files("hitjoints.robots").iterdir()
    return tuple(sorted(file.name[:-5] for file in files if file.name.endswith(".toml")))


def robot_file(name: str) -> Path:
    """Return the TOML of one of `robot_names`."""
    return Path(str(resources.files("hitjoints.robots"))) / f"{name}.toml"


@lru_cache(maxsize=1)
def erd_directory() -> Path:
    """Return the folder of robots in the installed example-robot-data.

    Raises:
        InputError: it is not installed.
    """
    share = f"cmeel.prefix/share/{ERD}/robots"
    try:
        return Path(str(metadata.distribution(ERD).locate_file(share)))
    except metadata.PackageNotFoundError:
        install = "it is not installed: pip install example-robot-data"
        raise InputError("robot", ERD, install) from None


@lru_cache(maxsize=1)
def erd_urdfs() -> dict[str, Path]:
    """Return the URDFs of example-robot-data by file name without its ending."""
    return {path.stem: path for path in sorted(erd_directory().rglob("*.urdf"), reverse=True)}
