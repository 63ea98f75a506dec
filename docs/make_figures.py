"""Draw the documentation's pictures again: `python docs/make_figures.py [NAME ...]`.

Each is what a command draws, so that it shows what a reader gets.
"""

from __future__ import annotations

import shlex
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from hitjoints.cli import main

PICTURES = Path(__file__).parent / "figures"
LANDINGS = Path(__file__).parent.parent / "tests" / "data" / "landing"
GOAL = """\
schema = 1
[robot]
source = "iiwa14"
[object]
position = [0.5, 0.2, 0.4]
mass = 1.0
size = [0.1, 0.1, 0.1]
restitution = 0.5
friction = 0.3
spread = { mass = 0.05, friction = 0.03 }
[wish]
goal = [0.55, 0.5, 0.4]
"""
COMMANDS = {
    "fig2": "sweep joint --plot {file}",
    "plan": "plan --plot {file}",
    "hit": "hit {folder}/goal.toml --out {folder}",
    "swing": "swing --fastest --robot panda --plot {file}",
    "rollout": "rollout --plot {file}",
    "torques": "rollout --robot panda --flux 0.5 --torque-limits --plot {file}",
    "simulation": "simulate --realistic --plot {file}",
    "replay": "replay --plot {file}",
    "calibration": "calibrate {landings}/object_1.csv --plot {file}",
    "map": "sweep workspace --plot {file}",
    "impact_contact_time": "sweep contact-time --plot {file}",
    "impact_winning_joint": "sweep contact-time --map {file}",
    "paper": "reproduce --out {folder}",
}
"""What is drawn by which command; `hit` and `paper` leave their pictures in the folder."""
LEFT = {
    "hit": ("hit",),
    "paper": ("fig2", "fig4", "fig5", "fig6", "spread"),
}


def draw(name: str) -> None:
    """Draw one of `COMMANDS` into the documentation's folder."""
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "goal.toml").write_text(GOAL, encoding="utf-8")
        file = PICTURES / f"{name}.png"
        words = COMMANDS[name].format(file=file, folder=folder, landings=LANDINGS)
        try:
            main(shlex.split(words))
        except SystemExit as end:
            if end.code not in (0, 3):
                raise
        for one in LEFT.get(name, ()):
            target = one if name == "hit" else f"{name}_{one}"
            (PICTURES / f"{target}.png").write_bytes((Path(folder) / f"{one}.png").read_bytes())


def draw_all(names: Sequence[str]) -> None:
    """Draw some, or all if none is named."""
    for name in names or COMMANDS:
        draw(name)


if __name__ == "__main__":
    draw_all(sys.argv[1:])
