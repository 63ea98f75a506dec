"""Draw the pictures of the pages again: `python docs/draw_figures.py [NAME ...]`.

Those of the benchmarks are drawn by `make bench`, that of the browser by its tests.
"""

from __future__ import annotations

import re
import shlex
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

DOCS = Path(__file__).parent
FIGURES = DOCS / "figures"
LANDINGS = DOCS.parent / "tests" / "data" / "landing" / "object_1.csv"
COMMANDS = {
    "fig2": "sweep joint --plot fig2.png",
    "plan": "plan --plot plan.png",
    "hit": "hit hit.toml --out folder",
    "map": "sweep workspace --x=-0.8:0.8:60 --y=-0.8:0.8:60 --samples 200 --plot map.png",
    "swing": "swing --fastest --robot panda --plot swing.png",
    "rollout": "rollout --plot rollout.png",
    "torques": "rollout --robot panda --flux 0.5 --torque-limits --plot torques.png",
    "simulation": "simulate --realistic --plot simulation.png",
    "replay": "replay --plot replay.png",
    "calibration": f"calibrate {LANDINGS} --plot calibration.png",
    "impact_contact_time": "sweep contact-time --plot impact_contact_time.png",
    "impact_winning_joint": "sweep contact-time --joint 6 --joint 7 --map impact_winning_joint.png",
    "paper_": "reproduce --out folder",
}
"""By the beginning of the picture's name, what `hitjoints` is told."""


def main(names: list[str]) -> None:
    """Draw the pictures that are named, or all."""
    first_hit = (DOCS / "first_hit.md").read_text(encoding="utf-8")
    wish = re.search(r"^```toml\n(# hit\.toml.*?)^```", first_hit, re.M | re.S)
    assert wish is not None
    for name in names or COMMANDS:
        with TemporaryDirectory() as folder:
            (Path(folder) / "hit.toml").write_text(wish[1])
            script = Path(sys.executable).with_name("hitjoints")
            subprocess.run([script, *shlex.split(COMMANDS[name])], cwd=folder, check=True)
            for drawn in Path(folder).glob("**/*.png"):
                prefix = name if name.endswith("_") else ""
                drawn.replace(FIGURES / f"{prefix}{drawn.name}")


if __name__ == "__main__":
    main(sys.argv[1:])
