"""Find the files of recorded hits, and which object's file belongs to which robot's."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterable, Iterator
from functools import cache
from pathlib import Path
from typing import NamedTuple

ROBOT_FILE = re.compile(r"(?!object_)(?P<robot>.+)_hit_(?P<number>\w+)\.csv", re.IGNORECASE)
OBJECT_FILE = re.compile(r"object_.+_hit_(?P<number>\w+)\.csv", re.IGNORECASE)
EXAMPLES = Path(__file__).parent / "examples"
"""Four hits of the public data set: the rows around the impact."""


class FoundFiles(NamedTuple):
    """A robot's file, and the object's file beside it.

    Attributes:
        file: the robot's, or what was asked for if it is none.
        object_file: None if there is none, or more than one.
        problem: why there is nothing to read; empty if there is.
        no_object: why there is no object's file; empty if there is one.
    """

    file: Path
    object_file: Path | None = None
    problem: str = ""
    no_object: str = ""


def find(paths: Iterable[Path]) -> list[FoundFiles]:
    """Find the robots' files among files and folders, each once.

    A folder is searched with the folders in it. What is not there, or holds no recording, is
    returned with its problem. Objects' files are not reported when their robot's is among the rest:
    a pattern such as *.csv names both.
    """
    found: dict[Path, FoundFiles] = {}
    objects: list[Path] = []
    beside = cache(_objects_in)
    for path in paths:
        for file in _robot_files(path) if path.is_dir() else [path]:
            if OBJECT_FILE.fullmatch(file.name):
                objects.append(file)
            else:
                found.setdefault(file.absolute(), _pair(file, beside))
    used = {one.object_file.absolute() for one in found.values() if one.object_file}
    problem = "it is an object's file: name the robot's beside it, or the folder"
    lonely = {file.absolute(): FoundFiles(file, problem=problem) for file in objects}
    return [*found.values(), *(one for path, one in lonely.items() if path not in used)]


def read_by(paths: Iterable[Path]) -> Iterator[Path]:
    """Yield every file that is read when some files and folders are replayed."""
    for one in find(paths):
        yield from (path for path in (one.file, one.object_file) if path is not None)


def _robot_files(folder: Path) -> list[Path]:
    """Return the robots' files below a folder, hit 2 before hit 10; the folder if there is none."""
    inside = (Path(where, name) for where, _, names in os.walk(folder) for name in names)
    files = [(ROBOT_FILE.fullmatch(path.name), path) for path in inside]
    named = [(str(p.parent), m["robot"], *_order(m["number"]), p) for m, p in files if m]
    return [path for *_, path in sorted(named)] or [folder]


def _order(number: str) -> tuple[int, str]:
    """Return what orders hits, and is the same for the robot's and the object's file of one."""
    return (int(number), "") if number.isdecimal() else (0, number.lower())


def _pair(file: Path, beside: Callable[[Path], dict[tuple[int, str], list[str]]]) -> FoundFiles:
    if file.is_dir():
        return FoundFiles(file, problem="no robot's file (..._hit_N.csv) is in this folder")
    if not file.is_file():
        return FoundFiles(file, problem="there is no such file")
    match = ROBOT_FILE.fullmatch(file.name)
    if match is None:
        return FoundFiles(file, no_object="no object's file: the name does not end in _hit_N.csv")
    names = beside(file.parent).get(_order(match["number"]), [])
    if len(names) == 1:
        return FoundFiles(file, file.parent / names[0])
    wanted = f"object_*_hit_{match['number']}.csv"
    why = f"several files {wanted}: {', '.join(names)}" if names else f"no file {wanted} beside it"
    return FoundFiles(file, no_object=why)


def _objects_in(folder: Path) -> dict[tuple[int, str], list[str]]:
    """Return the names of the objects' files in a folder, by number of the hit."""
    names: dict[tuple[int, str], list[str]] = {}
    for name in sorted(os.listdir(folder)):
        match = OBJECT_FILE.fullmatch(name)
        if match:
            names.setdefault(_order(match["number"]), []).append(name)
    return names
