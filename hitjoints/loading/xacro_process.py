"""The process that `expand_xacro` starts: JSON in, JSON out, nothing else on either stream."""

from __future__ import annotations

import json
import os
import sys
from types import ModuleType
from typing import Any

from hitjoints.model.packages import packages


class Arguments(dict[str, str]):
    """Values of a file's arguments; it remembers which ones the file knows."""

    def __init__(self, given: dict[str, str]) -> None:
        super().__init__(given)
        self.known: set[str] = set()

    def __contains__(self, name: object) -> bool:
        self.known.add(str(name))
        return super().__contains__(name)

    def __getitem__(self, name: str) -> str:
        self.known.add(name)
        return super().__getitem__(name)


def expand(path: str, package_dirs: list[str], arguments: dict[str, str]) -> dict[str, Any]:
    """Return the expanded text and the names of the arguments, or the reason why not."""
    import xacro

    folder = os.path.dirname(os.path.abspath(path))

    def share_directory(package: str) -> str:
        for candidate in packages(package, folder, package_dirs):
            if candidate.is_dir():
                return str(candidate.absolute())
        raise LookupError(f"package {package} not found: name its folder with --package-dir")

    _serve_ament(share_directory)
    values = Arguments(arguments)
    try:
        document = xacro.process_file(path, mappings=values, verbosity=0)
    except Exception as error:  # whatever a program in a file may raise
        return {"reason": _reason(error)}
    return {"text": document.toxml(), "known": sorted(values.known)}


def _serve_ament(share_directory: Any) -> None:
    """Let `$(find NAME)` ask us: it imports this module of ROS 2, which need not be there."""
    ament, inside = ModuleType("ament_index_python"), ModuleType("ament_index_python.packages")
    inside.__dict__["get_package_share_directory"] = share_directory
    sys.modules |= {"ament_index_python": ament, "ament_index_python.packages": inside}


def _reason(error: BaseException) -> str:
    """Return what went wrong; xacro wraps the error that names it."""
    inner = getattr(error, "exc", None)
    if isinstance(inner, LookupError) and str(inner).startswith("'package "):
        return str(inner.args[0])
    return str(error) or type(error).__name__


if __name__ == "__main__":
    # What the file prints must not mix with the answer.
    answer, sys.stdout = sys.stdout, sys.stderr
    result = expand(**json.loads(sys.stdin.read()))
    answer.write(json.dumps(result))
