"""From what a user names, or a text itself, to a tree of links and joints."""

from __future__ import annotations

import os
import re
import stat
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import NamedTuple

from hitjoints.errors import InputError, ModelError, UnknownNameError
from hitjoints.loading.catalogue import ERD, erd_directory, erd_urdfs, robot_file, robot_names
from hitjoints.loading.facts import Facts, read_facts
from hitjoints.loading.mjcf import read_mjcf
from hitjoints.loading.xacro_file import expand_xacro
from hitjoints.model.tree import Tree
from hitjoints.model.urdf import read_urdf

LARGEST = 1 << 26  # bytes of a description
ENDINGS = (".urdf", ".xacro", ".xml")
BLANK = "\ufeff \t\r\n"  # what may come before a description begins


@dataclass(frozen=True)
class Description:
    """A robot's description and what its TOML adds, before an arm is chosen in it."""

    name: str
    source: str
    """What to call it in messages."""
    tree: Tree = field(repr=False)
    """Its links and joints."""
    folder: Path | None
    """Where the file lies; None for a description given as text."""
    kind: str
    """What the source is written in: urdf, xacro or mjcf."""
    facts: Facts = field(default_factory=dict)
    """The TOML's entries; empty without one."""
    package_dirs: tuple[str, ...] = ()
    """Folders that hold packages, for the meshes."""
    home: Path | None = None
    """The folder of the TOML."""


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
    asked = str(source)
    located = _Located(None, "robot", "text") if is_text(asked) else _locate(asked)
    path, name, called, facts = located
    told = facts.get("package_dirs", [])
    home = Path(asked).parent if asked.endswith(".toml") else None
    dirs = (*map(str, package_dirs), *(str(Path(home or "", folder)) for folder in told))
    arguments = {**facts.get("xacro_args", {}), **(xacro_args or {})}
    text, kind = (asked if path is None else read_text(path)), "urdf"
    if path is not None and path.suffix == ".xacro":
        text, kind = expand_xacro(path, dirs, arguments), "xacro"
    elif arguments:
        name_of_one = next(iter(arguments))
        raise InputError("xacro-arg", name_of_one, f"{called} is no xacro file (*.xacro)")
    folder = None if path is None else Path(os.path.abspath(path)).parent
    if (tag := root_tag(text)) == "mujoco":
        tree, kind = read_mjcf(text, path, called), "mjcf"
    elif tag == "sdf":
        reason = "it is an SDF, which hitjoints does not read: convert it to a URDF"
        raise ModelError(called, reason)
    else:
        tree = read_urdf(text, called)
    return Description(name, called, tree, folder, kind, facts, dirs, home)


def root_tag(text: str) -> str:
    """Return the name of a text's first element, "" when it has none."""
    found = re.search(r"<([A-Za-z_][^\s/>]*)", re.sub(r"<!--.*?-->", "", text, flags=re.DOTALL))
    return found[1] if found else ""


def is_text(source: str) -> bool:
    """Tell whether a source is a description itself, not the name of one."""
    return source.lstrip(BLANK).startswith("<")


class _Located(NamedTuple):
    """A description's file (None for a text), its name, what messages call it, and its TOML."""

    path: Path | None
    name: str
    called: str
    facts: Facts = MappingProxyType({})


def _locate(asked: str) -> _Located:
    path = robot_file(asked) if asked in robot_names() else Path(asked)
    if path.suffix == ".toml":
        facts = read_facts(read_text(path), path)
        package, _, inside = facts["urdf"].rpartition(":")
        described = (erd_directory() / inside) if package == ERD else path.parent / facts["urdf"]
        name = facts.get("name", path.stem)
        return _Located(described, name, name, facts)
    if path.suffix not in ENDINGS and "/" not in asked and not os.path.isfile(asked):
        known = erd_urdfs()
        if asked not in known:
            others = ["a URDF path", f"a robot of {ERD}"]
            raise UnknownNameError("robot", asked, [*robot_names(), *others], known)
        path = known[asked]
    return _Located(path, path.stem.removesuffix(".urdf"), asked)


def read_text(path: Path, argument: str = "robot") -> str:
    """Return the text of a file that describes something.

    Args:
        path: the file.
        argument: what to call it in messages.

    Raises:
        InputError: the file cannot be read as text, is no plain file, or is larger than any
            description.
    """
    try:
        # A device or a pipe may never end.
        status = os.stat(path)
        if not (stat.S_ISREG(status.st_mode) or stat.S_ISDIR(status.st_mode)):
            raise InputError(argument, path, "a description is a file, not a device or a pipe")
        if status.st_size > LARGEST:
            raise InputError(argument, path, f"a description has at most {LARGEST >> 20} MB")
        return path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError:
        raise InputError(argument, path, "not a UTF-8 text file") from None
    except OSError as error:
        raise InputError(argument, path, str(error.strerror)) from None
    except InputError:
        raise
    except ValueError:
        raise InputError(argument, path, "a path holds no null character") from None
