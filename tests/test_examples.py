"""The examples run as they are and print what they promise."""

import ast
import os
import subprocess
import sys
from pathlib import Path

import pytest

import hitjoints as hj

PEERS = ("numpy", "mujoco")
EXAMPLES = sorted((Path(__file__).parents[1] / "examples").glob("*.py"))


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_an_example_runs(path, tmp_path):
    run = subprocess.run(
        [sys.executable, path],
        capture_output=True,
        text=True,
        cwd=tmp_path,
        timeout=300,
        env={**os.environ, "PYTHONWARNINGS": "error::RuntimeWarning"},
        check=False,
    )
    assert run.returncode == 0, run.stderr
    assert "flux" in run.stdout
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_an_example_uses_public_names_only(path):
    used = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.ImportFrom):
            assert not (node.module or "").startswith("hitjoints"), ast.unparse(node)
        elif isinstance(node, ast.Import):
            assert {alias.name for alias in node.names} <= {*PEERS, "hitjoints", "tempfile"}
        elif isinstance(node, ast.Attribute) and ast.unparse(node.value) == "hj":
            used.add(node.attr)
    assert used
    assert used <= set(hj.__all__)


def test_there_are_examples():
    assert len(EXAMPLES) >= 3
