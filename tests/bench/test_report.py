import sys
import tomllib
from pathlib import Path

import pytest

from benchmarks import __main__ as command
from benchmarks.harness import Figure, Remark, Row
from benchmarks.peers import install
from benchmarks.plot import FASTER, SLOWER, draw
from benchmarks.report import cells, duration, markdown, version

QUICK = Row("a task", "ours", "quick", 2e-3, 5e-4, 0.25, 0.2, 0.5, "gain", contest=True)
SLOW = Row("a task", "ours", "slow", 2e-3, 1.0, 500.0, 400.0, 600.0, "gain", ">= 6", contest=True)
OTHER = Row(
    "a second task", "llvm, one thread", "loop", 1e-8, 1e-7, 10, 9, 11, "gain", contest=True
)
COST = Row("start-up", "a", "b", 2.0, 1.0, 2.0, 1.5, 2.5, "cost")
MISSING = Remark("a task", "absent", "skipped: absent is not installed")
ROWS = [QUICK, SLOW, OTHER, COST, MISSING, Figure("memory", 3.0, "MB")]


def test_who_is_faster_is_said():
    quick = ("a task", "ours", "quick", "2 ms", "500 us", "0.25x", "0.2 .. 0.5", "")
    assert cells(QUICK) == (*quick, "peer is faster")
    assert cells(SLOW)[5:] == ("500x faster", "400 .. 600", ">= 6", "met")
    assert cells(COST)[5:] == ("2x the cost", "1.5 .. 2.5", "", "peer is faster")
    assert cells(MISSING)[-1] == "skipped: absent is not installed"


def test_the_table_has_a_line_for_each_row_and_all_versions():
    text = markdown(ROWS, "python -m benchmarks --write")
    head, _, *lines = text.splitlines()
    assert "`python -m benchmarks --write`" in head
    assert "processors" in head
    for name in install.names():
        assert name in head
    assert len(lines) == 2 + len(ROWS)
    assert {line.count("|") for line in lines} == {10}


def test_times_have_units():
    assert [duration(t) for t in (2.0, 3.1e-3, 4e-6, 5e-9)] == ["2 s", "3.1 ms", "4 us", "5 ns"]


def test_a_package_that_is_not_there_is_said():
    assert version("no-such-package") == "no no-such-package"


def test_the_plot_shows_the_contests():
    figure = draw(ROWS)
    bars = [patch for axis in figure.axes for patch in axis.patches]
    ends = sorted((bar.get_x() + bar.get_width(), bar.get_facecolor()) for bar in bars)
    assert [end for end, _ in ends] == [0.25, 10, 500]
    from matplotlib.colors import to_rgba

    assert [colour for _, colour in ends] == [to_rgba(SLOWER), to_rgba(FASTER), to_rgba(FASTER)]
    labels = [label.get_text() for axis in figure.axes for label in axis.get_yticklabels()]
    assert labels == ["a task", "quick", "slow", "a second task", "loop (llvm)"]


def test_nothing_to_plot_is_no_error():
    assert len(draw([COST]).axes) == 2


def test_the_command_writes_table_and_plot(monkeypatch, tmp_path):
    (tmp_path / "figures").mkdir()
    monkeypatch.setattr(command, "DOCS", tmp_path)
    module = type(sys)("benchmarks.made_up")
    module.measure = lambda: ROWS
    monkeypatch.setitem(sys.modules, "benchmarks.made_up", module)
    command.main(["--write", "made_up"])
    assert (
        "0.25x | 0.2 .. 0.5 |  | peer is faster |" in (tmp_path / "benchmarks_table.md").read_text()
    )
    assert (tmp_path / "figures" / "benchmarks.png").stat().st_size > 1000


def test_the_peers_are_those_of_the_extra():
    assert {"pybullet", "drake", "mujoco", "osqp", "clarabel"} <= set(install.names())
    make = (Path(install.PYPROJECT).parent / "Makefile").read_text()
    extras = make.split("EXTRAS := ")[1].split("\n")[0].split(",")
    assert "bench" not in extras  # the tests do without the peers


def test_the_tests_bring_what_they_need():
    project = tomllib.loads(install.PYPROJECT.read_text())["project"]
    test = " ".join(project["optional-dependencies"]["test"])
    assert "scipy" in test
    assert "mujoco" in test


@pytest.mark.parametrize("broken", ["drake>=1", ""])
def test_a_peer_that_does_not_install_is_said_and_the_others_are_installed(
    monkeypatch, capsys, broken
):
    calls = []

    def pretend(wanted):
        calls.append(list(wanted))
        return "no wheel" if broken in wanted else ""

    monkeypatch.setattr(install, "install", pretend)
    monkeypatch.setattr(install, "requirements", lambda: ("osqp", "drake>=1", "daqp"))
    install.main()
    if broken:
        assert calls[1:] == [["osqp"], ["drake>=1"], ["daqp"]]
        assert capsys.readouterr().err == "drake>=1 is skipped: no wheel\n"
    else:
        assert len(calls) == 1
