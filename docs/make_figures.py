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
FIRST_HIT = Path(__file__).parent / "first_hit.md"
COMMANDS = {
    "fig2": "sweep joint --plot {file}",
    "plan": "plan --plot {file}",
    "hit": "hit {folder}/wish.toml --out {folder}",
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
        (Path(folder) / "wish.toml").write_text(first_hit(), encoding="utf-8")
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


def first_hit() -> str:
    """Return the hit.toml of the page on the first hit."""
    return FIRST_HIT.read_text(encoding="utf-8").split("```toml\n")[1].split("```")[0]


def draw_all(names: Sequence[str]) -> None:
    """Draw some, or all if none is named."""
    for name in names or COMMANDS:
        draw(name)


if __name__ == "__main__":
    draw_all(sys.argv[1:])
