"""Races and kills of maps, counted: `python -m benchmarks.stores --races 24 --kills 50 --seed 0`.

A race is two processes with one output; one must win, and the store be that of a run alone. A kill
is SIGKILL at a random moment; the next run goes on, and the finished store is the same to the byte.
"""

import argparse
import hashlib
import random
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

GRID = "--x=-0.8:0.8:{n} --y=-0.8:0.8:{n} --z=0.3:0.7:3 --samples 20 --joint 6 --threads 1 --json"


def start(folder: Path, n: int) -> subprocess.Popen[str]:
    """Start a map in a folder; the program of this environment."""
    words = ["sweep", "workspace", *GRID.format(n=n).split(), "--out", "map.zarr"]
    program = [sys.executable, "-m", "hitjoints.cli", *words]
    return subprocess.Popen(
        program, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True
    )


def fingerprint(folder: Path) -> str:
    """Return a digest of every file below a folder."""
    digest = hashlib.sha256()
    for path in sorted(folder.rglob("*")):
        if path.is_file():
            digest.update(str(path.relative_to(folder)).encode() + path.read_bytes())
    return digest.hexdigest()


def alone(folder: Path, n: int) -> tuple[str, float]:
    """Return the digest of an undisturbed run, and the seconds it takes."""
    folder.mkdir()
    begun = time.monotonic()
    process = start(folder, n)
    process.communicate()
    assert process.returncode == 0
    return fingerprint(folder), time.monotonic() - begun


def race(folder: Path, expected: str) -> tuple[int, int]:
    """Let two runs race; return how many ended with an error, and 1 if the store is ruined."""
    folder.mkdir()
    runs = [start(folder, 20), start(folder, 20)]
    said = [run.communicate()[1] for run in runs]
    codes = [run.returncode for run in runs]
    fair = 0 in codes and all(
        code == 0 or ("another run is writing it" in text and code == 1)
        for code, text in zip(codes, said, strict=True)
    )
    return sum(map(bool, codes)), int(not fair or fingerprint(folder) != expected)


def kills(folder: Path, expected: str, seconds: float, count: int, chance: random.Random) -> str:
    """Kill runs until so many were hit; return what became of the maps."""
    killed = maps = wrong = left = 0
    while killed < count:
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir()
        while True:
            process = start(folder, 60)
            try:
                process.communicate(
                    timeout=chance.uniform(0.2, seconds) if killed < count else None
                )
                break
            except subprocess.TimeoutExpired:
                process.kill()
                process.communicate()
                killed += 1
        maps += 1
        left += len(list(folder.glob(".hitjoints.*")))
        for stray in folder.glob(".hitjoints.*"):
            shutil.rmtree(stray)
        wrong += process.returncode != 0 or fingerprint(folder) != expected
    return f"{killed} kills of {maps} maps: {wrong} differ, {left} scratch folders left"


def main() -> None:
    """Run and print the counts."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--races", type=int, default=24)
    parser.add_argument("--kills", type=int, default=50)
    parser.add_argument("--seed", type=int, default=0)
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        expected, _ = alone(Path(scratch) / "small", 20)
        results = [race(Path(scratch) / f"race{i}", expected) for i in range(asked.races)]
        refused, ruined = (sum(column) for column in zip(*results, strict=True))
        print(f"{asked.races} races: {refused} runs refused, {ruined} stores ruined")
        expected, seconds = alone(Path(scratch) / "large", 60)
        chance = random.Random(asked.seed)
        print(kills(Path(scratch) / "killed", expected, seconds, asked.kills, chance))


if __name__ == "__main__":
    main()
