"""Install the peers: `python -m benchmarks.peers.install`.

All at once, or else one by one: what has no wheel for this machine is said and skipped. Nothing
that is installed already changes, so that a peer does not bring an older Pinocchio or NumPy along.
"""

from __future__ import annotations

import re
import subprocess
import sys
import tempfile
import tomllib
from collections.abc import Sequence
from importlib import metadata
from pathlib import Path

PYPROJECT = Path(__file__).parents[2] / "pyproject.toml"


def requirements() -> tuple[str, ...]:
    """Return what the extra `bench` asks for."""
    project = tomllib.loads(PYPROJECT.read_text())["project"]
    return tuple(project["optional-dependencies"]["bench"])


def names() -> tuple[str, ...]:
    """Return the peers' package names."""
    return tuple(re.split(r"[<>=!~;\[ ]", requirement)[0] for requirement in requirements())


def install(wanted: Sequence[str]) -> str:
    """Install packages from wheels, all or none; return what went wrong, or nothing."""
    kept = {each.name: each.version for each in metadata.distributions()}
    with tempfile.TemporaryDirectory() as folder:
        constraints = Path(folder) / "constraints.txt"
        constraints.write_text("".join(f"{name}=={kept[name]}\n" for name in sorted(kept)))
        words = ["install", "--quiet", "--disable-pip-version-check", "--only-binary", ":all:"]
        done = subprocess.run(
            [sys.executable, "-m", "pip", *words, "--constraint", str(constraints), *wanted],
            check=False,
            capture_output=True,
            text=True,
        )
    return "" if done.returncode == 0 else (done.stderr.strip().splitlines() or ["pip failed"])[-1]


def main() -> None:
    """Install all that can be installed, and say what cannot."""
    if not install(requirements()):
        return
    for requirement in requirements():
        failure = install([requirement])
        if failure:
            print(f"{requirement} is skipped: {failure}", file=sys.stderr)


if __name__ == "__main__":
    main()
