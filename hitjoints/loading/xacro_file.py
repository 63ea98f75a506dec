"""Expand a xacro file to the URDF it stands for, with the extra `xacro`.

A xacro file is a program: its expressions are run. That happens in a process of its own, because
the package `xacro` keeps its state in globals and prints as it goes.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Mapping, Sequence
from importlib.util import find_spec
from pathlib import Path

from hitjoints.errors import InputError, MissingExtraError, ModelError, shown

LONGEST = 60.0  # s, after which a file is taken to loop


def expand_xacro(
    path: Path, package_dirs: Sequence[str] = (), arguments: Mapping[str, str] | None = None
) -> str:
    """Return the URDF that a xacro file expands to.

    Args:
        path: the file. `$(find NAME)` is looked up as `package://NAME` is.
        package_dirs: folders that hold packages.
        arguments: values of its `<xacro:arg>`, by name.

    Raises:
        MissingExtraError: the package xacro is not installed.
        InputError: it has no argument of a name that was given.
        ModelError: it cannot be expanded; the message holds xacro's reason.
    """
    if find_spec("xacro") is None:
        raise MissingExtraError("xacro", "xacro")
    given = {name: str(value) for name, value in (arguments or {}).items()}
    asked = {"path": str(path), "package_dirs": [*package_dirs], "arguments": given}
    # It imports what this process does, and nothing from the working folder (-P).
    command = [sys.executable, "-P", "-m", "hitjoints.loading.xacro_process"]
    paths = {"PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    try:
        done = subprocess.run(
            command, input=json.dumps(asked), capture_output=True, timeout=LONGEST, text=True,
            encoding="utf-8", check=False, env=os.environ | paths,
        )  # fmt: skip
        answer = json.loads(done.stdout)
    except subprocess.TimeoutExpired:
        reason = f"xacro has not expanded it within {LONGEST:g} s"
        raise ModelError(str(path), reason) from None
    except ValueError:
        reason = f"xacro ends without an answer ({shown(done.stderr[-200:])})"
        raise ModelError(str(path), reason) from None
    if "reason" in answer:
        raise ModelError(str(path), f"xacro cannot expand it ({shown(answer['reason'])})")
    known = answer["known"]
    for name in given.keys() - set(known):
        wanted = f"its arguments are {', '.join(known)}" if known else "it has no arguments"
        raise InputError("xacro-arg", f"{name}:={given[name]}", wanted)
    return str(answer["text"])
