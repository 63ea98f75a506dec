from __future__ import annotations

import json
import re
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import pytest
from hypothesis import settings

from hitjoints.cli import main
from hitjoints.loading.load import load_robot

LIMIT = '<limit lower="-1" upper="1" velocity="2" effort="3"/>'
# The same examples on every run; no deadline, machines are shared.
settings.register_profile("repeatable", derandomize=True, deadline=None)
settings.load_profile("repeatable")
DATA = Path(__file__).parent / "data"


class Urdf:
    """Writes small URDFs."""

    limit = LIMIT
    base = '<link name="base"/>'

    def __init__(self, folder):
        self.folder = folder

    @staticmethod
    def link(
        name, mass=1.0, com=(0.1, 0, 0), moments=(0.01, 0.01, 0.01), products=(0, 0, 0), rpy=""
    ):
        xx, yy, zz = moments
        xy, xz, yz = products
        return (
            f'<link name="{name}"><inertial><origin xyz="{com[0]} {com[1]} {com[2]}" {rpy}/>'
            f'<mass value="{mass}"/><inertia ixx="{xx}" iyy="{yy}" izz="{zz}" ixy="{xy}" '
            f'ixz="{xz}" iyz="{yz}"/></inertial></link>'
        )

    @staticmethod
    def joint(
        name, parent, child, kind="revolute", *, at="0.3 0 0", rpy="0 0 0", axis="0 0 1", more=LIMIT
    ):
        return (
            f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
            f'<origin xyz="{at}" rpy="{rpy}"/><axis xyz="{axis}"/>{more}</joint>'
        )

    @staticmethod
    def robot(*parts):
        return f'<robot name="small">{"".join(parts)}</robot>'

    def two_links(self, **second):
        """Return an arm whose second joint is as the arguments say."""
        return self.robot(
            self.base,
            self.link("link_1"),
            self.link("link_2"),
            self.joint("joint_1", "base", "link_1"),
            self.joint("joint_2", "link_1", "link_2", **second),
        )

    def write(self, xml, name="small.urdf"):
        path = self.folder / name
        path.write_text(xml, encoding="utf-8")
        return path

    def load(self, *parts, **options):
        """Load what the parts make; a whole URDF text counts as parts too."""
        text = parts[0] if "<robot" in parts[0] else self.robot(*parts)
        return load_robot(self.write(text), **options)


@pytest.fixture
def urdf(tmp_path):
    return Urdf(tmp_path)


@pytest.fixture(scope="session")
def arm():
    """Load a robot by name, once."""
    return lru_cache(maxsize=None)(load_robot)


@pytest.fixture(scope="session")
def hits():
    """Return the recorded hits by name."""
    return {path.stem: json.loads(path.read_text()) for path in sorted(DATA.glob("hits/*.json"))}


@dataclass
class Outcome:
    code: int
    out: str
    err: str

    @property
    def json(self):
        # One object on stdout and nothing else.
        return json.loads(self.out)

    @property
    def words(self):
        """What was printed, on one line and without box drawing."""
        return re.sub(r"\s+", " ", self.out)


@pytest.fixture
def run(capsys, monkeypatch):
    """Run a command line in this process, as the `hitjoints` script does, on a wide terminal."""
    monkeypatch.setenv("COLUMNS", "200")

    def call(*arguments: object) -> Outcome:
        with pytest.raises(SystemExit) as leaving:
            main([str(argument) for argument in arguments])
        printed = capsys.readouterr()
        assert "Traceback" not in printed.err
        code = leaving.value.code
        return Outcome(code if isinstance(code, int) else 1, printed.out, printed.err)

    return call


@pytest.fixture(scope="session")
def reproduction():
    """Return the paper's experiments, run once, with a small study of the spread."""
    from hitjoints.evidence.paper.reproduction import reproduce

    return reproduce(setups=1500)
