"""From what a user names to a URDF text: built-in names, files, or the text itself."""

from __future__ import annotations

import os
import stat
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from hitjoints.errors import InputError, UnknownNameError
from hitjoints.loading.catalogue import ERD, erd_directory, erd_urdfs, robot_file, robot_names
from hitjoints.loading.facts import Facts, read_facts

LARGEST = 1 << 26  # bytes of a description


@dataclass(frozen=True)
class Description:
    """A robot's description and what its TOML adds, read and not yet understood."""

    name: str
    source: str
    """What to call it in messages."""
    text: str = field(repr=False)
    """URDF, whatever the source was written in."""
    folder: Path | None
    """Where the file lies; None for a description given as text."""
    kind: str
    """What the source was: urdf or text."""
    facts: Facts = field(default_factory=dict)
    """The TOML's entries; empty without one."""
    package_dirs: tuple[str, ...] = ()
    """Folders that hold packages, for the meshes."""


def describe(
    source: str | Path,
    package_dirs: Sequence[str | Path] = (),
    xacro_args: Mapping[str, str] | None = None,
) -> Description:
    """Read the files of a robot.

    Args:
        source: as `load_robot`.
        package_dirs: folders that hold packages.
        xacro_args: arguments of a xacro file, by name.

    Raises:
        InputError: there is no such robot or file.
        ModelError: a file cannot be read as what it should be.
    """
    return replace(_found(str(source)), package_dirs=tuple(map(str, package_dirs)))


def _found(text: str) -> Description:
    if text.lstrip("\ufeff \t\r\n").startswith("<"):
        return Description("robot", "text", text, None, "text")
    if text in robot_names():
        return _from_toml(robot_file(text))
    path = Path(text)
    if path.suffix == ".toml":
        return _from_toml(path)
    if path.suffix != ".urdf" and "/" not in text and not os.path.isfile(text):
        known = erd_urdfs()
        if text not in known:
            others = ["a URDF path", f"a robot of {ERD}"]
            raise UnknownNameError("robot", text, [*robot_names(), *others], known)
        path = known[text]
    return _read(path, path.stem, text, {})


def _from_toml(path: Path) -> Description:
    facts = read_facts(read_text(path), path)
    package, _, inside = facts["urdf"].rpartition(":")
    described = (erd_directory() / inside) if package == ERD else path.parent / facts["urdf"]
    name = facts.get("name", path.stem)
    return _read(described, name, name, facts)


def _read(path: Path, name: str, source: str, facts: Facts) -> Description:
    return Description(
        name, source, read_text(path), Path(os.path.abspath(path)).parent, "urdf", facts
    )


def read_text(path: Path) -> str:
    """Return a description file's text.

    Raises:
        InputError: the file cannot be read as text, is no plain file, or is larger than any
            description.
    """
    try:
        # A device or a pipe may never end.
        status = os.stat(path)
        if not (stat.S_ISREG(status.st_mode) or stat.S_ISDIR(status.st_mode)):
            raise InputError("robot", path, "a description is a file, not a device or a pipe")
        if status.st_size > LARGEST:
            raise InputError("robot", path, f"a description has at most {LARGEST >> 20} MB")
        return path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError:
        raise InputError("robot", path, "not a UTF-8 text file") from None
    except OSError as error:
        raise InputError("robot", path, str(error.strerror)) from None
    except InputError:
        raise
    except ValueError:
        raise InputError("robot", path, "a path holds no null character") from None
