"""The page "your own arm" is true: its files load, its commands answer."""

import re
import shlex
from pathlib import Path

import pytest

PAGE = (Path(__file__).parents[2] / "docs" / "own_arm.md").read_text()
BLOCKS = re.findall(r"^```(\w+)\n(.*?)^```", PAGE, re.MULTILINE | re.DOTALL)


def commands():
    """Return each command of the page with the lines it is said to print."""
    lines = "".join(text for kind, text in BLOCKS if kind == "console").splitlines()
    found = []
    for line in lines:
        if line.startswith("$ hitjoints "):
            found.append((line.removeprefix("$ hitjoints "), []))
        else:
            found[-1][1].append(line)
    return found


@pytest.fixture
def files(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for kind, text in BLOCKS:
        if kind in ("xml", "toml"):
            name = re.match(r"(?:<!--|#) ([\w.]+)", text)[1]
            (tmp_path / name).write_text(text)
    return tmp_path


@pytest.mark.parametrize(("line", "said"), commands())
@pytest.mark.filterwarnings("ignore::hitjoints.loading.load.ModelWarning")
def test_a_command_answers(files, run, line, said):
    answer = run(*shlex.split(line))
    assert answer.code == 0, answer.err
    for words in said:
        assert words in answer.words


def test_the_page_is_read():
    assert len(commands()) >= 6
    assert {kind for kind, _ in BLOCKS} >= {"xml", "toml", "console"}
