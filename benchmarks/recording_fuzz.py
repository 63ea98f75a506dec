"""Recorded hits damaged at random: `python -m benchmarks.recording_fuzz --count 1500 --seed 0`.

Lines are lost, repeated and cut, fields, numbers and bytes replaced, columns scaled. A replay has
to end with a hit or a reason, and its result to be written.
"""

import argparse
import random
import tempfile
import time
import traceback
import warnings
from pathlib import Path

import hitjoints as hj
from hitjoints.datasets.files import write_dataset
from hitjoints.evidence.recordings.dataset import hits_dataset
from hitjoints.evidence.recordings.hit_files import EXAMPLES, find

ODD = (
    *("", " ", "nan", "inf", "-inf", "1e400", "1e308", "-1e12", "0", "1e-320", "abc", "\0", "1_0"),
    *(
        "9" * 400,
        "0x10",
        "1 2",
        ",",
        '"',
        "\n",
        "é",
        "true",
        "None",
        "{}",
        "1e11",
        "5e-324",
        "-0.0",
    ),
)
SLOW = 5.0  # s


def damaged(text: str, chance: random.Random) -> bytes:
    """Return a file's text with random damage."""
    lines = text.splitlines()
    if chance.random() < 0.3:
        lines = lines[: chance.randrange(1, len(lines) + 1)]
    for _ in range(chance.choice([0, 1, 1, 2, 5, 30])):
        line = chance.randrange(len(lines) if chance.random() < 0.7 else min(3, len(lines)))
        fields = lines[line].split(",")
        _damage(fields, chance)
        lines[line] = ",".join(fields) if chance.random() < 0.9 else chance.choice(lines)
    if chance.random() < 0.1:
        _scale(lines, chance)
    data = bytearray("\n".join(lines).encode())
    for _ in range(chance.randrange(1, 20) if chance.random() < 0.1 else 0):
        data[chance.randrange(len(data))] = chance.randrange(256)
    return bytes(data) if chance.random() < 0.97 else b""


def _damage(fields: list[str], chance: random.Random) -> None:
    at = chance.randrange(len(fields))
    words = fields[at].split()
    if words:
        words[chance.randrange(len(words))] = chance.choice(ODD)
    kinds = (chance.choice(ODD), " ".join(words), fields[at] * chance.choice([0, 2, 50]))
    kind = chance.randrange(5)
    if kind < len(kinds):
        fields[at] = kinds[kind]
    elif kind == len(kinds):
        del fields[at]
    else:
        fields.insert(at, chance.choice(ODD))


def _scale(lines: list[str], chance: random.Random) -> None:
    factor, at = chance.choice([1e-9, 1e6, 0.0, -1.0]), chance.randrange(12)
    for i, line in enumerate(lines):
        fields = line.split(",")
        try:
            fields[at] = " ".join(str(float(word) * factor) for word in fields[at].split())
        except (ValueError, IndexError):
            continue
        lines[i] = ",".join(fields)


def main() -> None:
    """Run and print the counts."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=1500)
    parser.add_argument("--seed", type=int, default=0)
    asked = parser.parse_args()
    warnings.simplefilter("ignore")
    chance = random.Random(asked.seed)
    pairs = [(one.file, one.object_file) for one in find([EXAMPLES])]
    usable = failed = slow = 0
    for number in range(asked.count):
        with tempfile.TemporaryDirectory() as scratch:
            folder = Path(scratch)
            for file in chance.choice(pairs):
                assert file is not None
                (folder / file.name).write_bytes(damaged(file.read_text(), chance))
            begun = time.monotonic()
            try:
                result = hj.replay(folder)
                usable += len(result.usable)
                if number % 10 == 0:
                    write_dataset(result.dataset, folder / "o.nc")
                    write_dataset(result.dataset, folder / "o.zarr")
                    write_dataset(hits_dataset(result.hits, along=False), folder / "o.csv")
            except Exception:
                failed += 1
                traceback.print_exc()
            slow += time.monotonic() - begun > SLOW
    print(f"{asked.count} files: {usable} usable, {failed} tracebacks, {slow} over {SLOW:g} s")


if __name__ == "__main__":
    main()
