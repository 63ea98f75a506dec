"""Mutated hit files: read and found equal after writing, or refused in one line.

python -m benchmarks.hit_files [--count 2000] [--seed 0]
"""

from __future__ import annotations

import argparse
import random
import sys
import tempfile
from dataclasses import replace
from pathlib import Path

import hitjoints as hj
from benchmarks.fuzz_cases import mutated
from hitjoints.errors import HitjointsError
from hitjoints.hit_setting import RobotChoice

LONGEST = 2000  # letters of a line
SAID = """
schema = 1
[robot]
source = "iiwa14"
tip = "flange"
lock = { finger = 0.1 }
tool = "tool.toml"
package_dirs = ["."]
xacro_args = { name = "value" }
[contact]
joints = [6, 7]
offset = [[0.0, 0.0, 0.03], [0.0, 0.01, 0.05]]
[object]
position = [0.5, 0.3, 0.5]
mass = 2.0
size = [0.1, 0.12, 0.1]
yaw = 0.1
restitution = 0.5
friction = 0.3
spread = { mass = 0.05, friction = 0.03, speed = 0.01 }
[wish]
goal = [0.5, 0.8, 0.5]
[surroundings]
object_size = [0.1, 0.1, 0.1]
table_height = 0.4
margin = 0.02
[how]
objective = "landing"
deliverable = true
away = false
torque_limits = true
seed = 3
dt = 0.002
q0 = [0.0, 0.1, 0.2, -0.3, 0.0, 0.0, 0.0]
q_hit = [0.0, 0.1, 0.2, -0.3, 0.0, 0.0, 0.0]
hits = 3
tolerance = 0.04
[limits]
acceleration = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]
jerk = 100.0
[impact]
model = "elastic"
contact_time = 0.01
stiffness = 10000.0
rotor_inertia = [0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5]
"""
"""A file that says all there is to say."""


def judge(path: Path) -> tuple[bool, str]:
    """Read a file; return whether it could be read, and what is wrong with that or the refusal."""
    try:
        hit = hj.load_hit(path)
    except HitjointsError as error:
        text = str(error)
        return False, "" if "\n" not in text and len(text) < LONGEST else f"not one line: {text}"
    except Exception as error:
        return False, f"{type(error).__name__}: {str(error)[:200]}"
    # Where the arm is found is another question.
    hit = hit.changed(setting=replace(hit.setting, robot=RobotChoice()))
    hit.save(path)
    return True, "" if hj.load_hit(path) == hit else "not equal after a round trip"


def run(text: str, folder: Path, count: int, seed: int) -> tuple[int, list[str]]:
    """Mutate a file again and again.

    Args:
        text: of a good file.
        folder: to write in.
        count: of the mutated files.
        seed: of the mutations.

    Returns:
        How many could still be read, and what was wrong.
    """
    path, read, wrong = folder / "mutant.toml", 0, []
    for number in range(count):
        chance = random.Random(seed * 1_000_003 + number)
        changed = text
        for _ in range(chance.choice((1, 1, 2, 4))):
            changed = mutated(chance, changed)
        path.write_text(changed, encoding="utf-8", errors="surrogatepass")
        could, fault = judge(path)
        read += could
        if fault:
            wrong.append(f"{number}: {fault}")
    return read, wrong


def main() -> None:
    """Print the counts and what is wrong."""
    from hitjoints.cli.hit_command import NEW  # type: ignore[import-not-found,unused-ignore]

    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=2000)
    parser.add_argument("--seed", type=int, default=0)
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        found = [run(text, Path(folder), asked.count // 2, asked.seed) for text in (NEW, SAID)]
    read, wrong = sum(one for one, _ in found), [line for _, lines in found for line in lines]
    print(f"{asked.count} files, seed {asked.seed}: {read} could be read; {len(wrong)} wrong")
    print("\n".join(wrong[:20]))
    sys.exit(bool(wrong))


if __name__ == "__main__":
    main()
