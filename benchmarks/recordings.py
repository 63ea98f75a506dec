"""`replay` of many recordings, the whole command: `python -m benchmarks.recordings 1000`."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

from benchmarks.harness import Figure, seconds
from tests.oracles.synthetic_recordings import NAMES, Truth, write_recording

FILES = 1000
DISTINCT = 20  # hits that differ; the others are copies under their own numbers
TARGET = 60.0  # s for a thousand


def measure(files: int = FILES) -> list[Figure]:
    """Return the time of the command for recordings of 300 rows with all columns, and its rate."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        write_recordings(folder, files)
        size = sum(path.stat().st_size for path in folder.iterdir()) / 1e6
        words = [sys.executable, "-m", "hitjoints.cli", "replay", name, "--json"]
        words += ["--out", str(folder / "hits.zarr")]
        printed: list[str] = []

        def command() -> None:
            done = subprocess.run(words, check=False, capture_output=True, text=True)
            assert done.returncode == 0, done.stderr
            printed.append(done.stdout)

        spent = seconds(command)
        hits = json.loads(printed[0])["hits"]
        assert len(hits) == files
        assert all(hit["ok"] and hit["restitution"] is not None for hit in hits)
    target = f"<= {TARGET * files / FILES:g}" if files >= FILES else ""
    return [
        Figure(f"replay of {files} recordings ({size:.0f} MB), whole command", spent, "s", target),
        Figure("recordings replayed", files / spent, "/s"),
    ]


def write_recordings(folder: Path, files: int) -> None:
    """Write hits of both arms, `DISTINCT` of them different."""
    rng = np.random.default_rng(0)
    names = sorted(NAMES)
    for i in range(min(DISTINCT, files)):
        truth = Truth(
            robot=names[i % 2],
            speed=rng.uniform(0.5, 1.2),
            mass=rng.choice([0.4, 1.915]),
            restitution=rng.uniform(0.1, 0.9),
            lag=1 + i % 3,
            seed=i,
        )
        written = write_recording(folder, i, truth)
        for number in range(i + DISTINCT, files, DISTINCT):
            for path in (written.file, written.object_file):
                shutil.copy(path, folder / path.name.replace(f"_hit_{i}.", f"_hit_{number}."))


if __name__ == "__main__":
    for figure in measure(int(sys.argv[1]) if len(sys.argv) > 1 else FILES):
        print(f"{figure.what}: {figure.value:.3g} {figure.unit}")
