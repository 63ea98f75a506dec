"""The README's example runs, and its tables tell the truth."""

import re
from pathlib import Path

import numpy as np

import hitjoints as hj

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text()


def test_the_example_runs(capsys):
    (example,) = re.findall(r"```python\n(.*?)```", README, re.S)
    exec(compile(example, "README.md", "exec"), {})
    lines = capsys.readouterr().out.splitlines()
    numbers = np.array([line.split() for line in lines], float)
    assert numbers[:, 0].tolist() == [5, 6, 7]
    assert (np.diff(numbers[:, 1]) < 0).all()  # the inertia falls towards the hand


def test_the_robots_table_names_every_robot():
    section = README.split("## Robots")[1].split("##")[0]
    assert re.findall(r"^\| `(\w+)`", section, re.M) == sorted(hj.robot_names())


def test_the_two_commands_come_first():
    first = README.split("```")[1]
    assert [line.split("#")[0].strip() for line in first.strip().splitlines()] == [
        "make demo",
        "make test",
    ]


def test_every_public_name_exists():
    assert sorted(hj.__all__) == hj.__all__ or set(hj.__all__) == set(dir(hj))
    for name in hj.__all__:
        assert getattr(hj, name) is not None
