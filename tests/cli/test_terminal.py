"""What is seen in a terminal: 80 columns are enough, nothing is cut, and how much is said."""

import os
import re
import subprocess
import sys
import time
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hitjoints.cli import progress, render
from hitjoints.cli.app import app
from hitjoints.counting import counted, counts_shown_by, tell

LANDINGS = Path(__file__).parent.parent / "data" / "landing" / "object_2.csv"
NUMBER = re.compile(r"(?<![\w.])-?\d+(?:\.\d+)?(?:e-?\d+)?")
TABLES = (
    "inspect --impact all --contact-time 0.01",
    "plan --no-certificate",
    "plan --joint 6 --torque-limits --flux 0.3 --no-certificate",
    "swing",
    "rollout",
    "simulate --realistic --elastic",
    "hit",
    "replay --impact",
    f"calibrate {LANDINGS}",
    "sweep joint --count 5",
    "sweep mass --mass 1:2:2 --joint 7",
    "sweep contact-time --count 3",
    "sweep workspace --x=-0.6:0.6:3 --y=-0.6:0.6:3 --samples 2",
    "sweep motion --x 0.5 --y 0.3 --samples 2 --tries 1 --joint 7",
    "robots list",
    "robots check panda",
    "robots check pr2_left",
)
GROUPS = ("", "robots", "sweep")


def commands():
    """Return every command as it is typed."""
    import typer

    waiting, found = [((), typer.main.get_command(app))], []
    while waiting:
        words, command = waiting.pop()
        below = getattr(command, "commands", {})
        waiting += [((*words, name), child) for name, child in below.items()]
        found.append(words)
    return found


@pytest.mark.parametrize("line", TABLES)
@pytest.mark.filterwarnings("ignore::hitjoints.loading.load.ModelWarning")
def test_nothing_is_cut_and_no_line_is_longer_than_80(line, run, monkeypatch):
    shown = {}
    for width in ("80", "400"):
        monkeypatch.setenv("COLUMNS", width)
        shown[width] = run(*line.split()).out
    long = [row for row in shown["80"].splitlines() if len(row) > 80]
    assert long == []
    numbers = {width: set(NUMBER.findall(out)) for width, out in shown.items()}
    # A time that is measured differs from run to run.
    timed = set(NUMBER.findall("".join(re.findall("control step.*", "".join(shown.values())))))
    assert numbers["80"] ^ numbers["400"] <= timed
    words = {width: set(re.findall(r"[^\W\d_]{3,}", out)) for width, out in shown.items()}
    assert words["80"] == words["400"]


def test_a_pipe_has_80_columns(run, monkeypatch):
    monkeypatch.delenv("COLUMNS", raising=False)
    assert max(map(len, run("plan", "--no-certificate").out.splitlines())) <= 80


WORD = st.text("abcdefgh", min_size=3, max_size=9)
NUMBERS = st.floats(-1e6, 1e6).map(lambda value: f"{value:.4g}")
CELL = st.one_of(NUMBERS, st.lists(WORD, min_size=1, max_size=6).map(" ".join))


@given(
    st.integers(1, 9).flatmap(
        lambda n: st.lists(st.lists(CELL, min_size=n, max_size=n), min_size=1, max_size=4)
    ),
    st.integers(40, 120),
)
def test_any_table_keeps_its_cells_whole(rows, width):
    names = [f"column {i}" for i in range(len(rows[0]))]
    parts = render._parts([names, *rows], width)
    lines = [line for part in parts for line in render._drawn(part, width)]
    assert all(len(line) <= width for line in lines)
    printed = " ".join(lines).split()
    for cell in (cell for row in rows for cell in row):
        assert set(cell.split()) <= set(printed)
    assert sum(len(part[0]) - 1 for part in parts) == max(len(names) - 1, 0)


def test_a_terminal_without_letters_for_lines_gets_dashes():
    done = subprocess.run(
        [sys.executable, "-m", "hitjoints.cli", "inspect"], check=False, capture_output=True,
        text=True, env={**os.environ, "PYTHONIOENCODING": "ascii"},
    )  # fmt: skip
    assert "-----" in done.stdout
    assert "\\u" not in done.stdout
    assert max(map(len, done.stdout.splitlines())) <= 80


def test_a_long_text_continues_indented_and_a_list_to_copy_stays_whole(capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "40")
    render.say("one two three four five six seven eight nine\nq = " + "0.123456," * 8)
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == "one two three four five six seven eight"
    assert lines[1] == "  nine"
    assert any("0.123456," * 8 in line for line in lines)


@pytest.mark.parametrize("words", commands(), ids=" ".join)
def test_every_command_has_help_by_both_names(words, run, monkeypatch):
    monkeypatch.setenv("COLUMNS", "80")
    short, long = run(*words, "-h"), run(*words, "--help")
    assert (short.code, short.out) == (0, long.out)
    assert max(map(len, short.out.splitlines())) <= 80


@pytest.mark.parametrize("words", GROUPS)
def test_a_group_without_a_command_shows_what_it_is_for(words, run):
    bare, asked = run(*words.split()), run(*words.split(), "--help")
    assert (bare.code, bare.out.strip()) == (0, asked.out.strip())
    assert "Commands" in bare.out


def test_quiet_tells_no_note_and_verbose_more(run, tmp_path):
    out = tmp_path / "a.csv"
    usual = run("swing", "--out", out)
    assert "written: " in usual.err
    assert "note: " in usual.err
    for words in (("swing", "-q"), ("-q", "swing"), ("swing", "--quiet")):
        quiet = run(*words, "--out", out)
        assert (quiet.err, quiet.out) == ("", usual.out)
    loud = run("swing", "-v", "--out", out)
    assert "detail: " in loud.err
    assert "written: " in run("swing", "--out", out).err  # the next is as usual


def test_a_warning_and_a_no_are_told_quietly_too(run):
    still = run("inspect", "-q", "--joint", "1", "--direction", "0,0,1", "--q", "0,0,0,0,0,0,0")
    assert (still.code, still.err[:4]) == (3, "no: ")
    assert run("inspect", "-q", "--mass", "-1").err.startswith("error: mass")


def test_the_versions_of_what_numbers_depend_on_are_told(run):
    from importlib.metadata import version

    said = run("--version").out
    assert all(f"{name} {version(name)}" in said for name in ("pin", "proxsuite", "numpy"))


@pytest.mark.parametrize(
    ("typed", "offered"),
    [
        ("hitjoints sw", {"swing", "sweep"}),
        ("hitjoints plan --plot-s", {"--plot-size", "--plot-style"}),
        ("hitjoints plan --robot iiwa", {"iiwa14", "iiwa14_bullet", "iiwa7"}),
    ],
)
def test_a_shell_completes(typed, offered, monkeypatch, run):
    monkeypatch.setenv("_HITJOINTS_COMPLETE", "complete_bash")
    monkeypatch.setenv("COMP_WORDS", typed)
    monkeypatch.setenv("COMP_CWORD", str(len(typed.split()) - 1))
    assert set(run().out.split()) == offered


class Terminal:
    """What a terminal would be told."""

    def __init__(self):
        self.text = ""

    def write(self, text):
        self.text += text

    def flush(self):
        pass

    def isatty(self):
        return True


def test_a_terminal_sees_a_bar_that_vanishes(monkeypatch):
    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    monkeypatch.setattr(progress, "PATIENCE", 0.02)
    with progress.progress():
        for _ in counted(range(2), "masses"):
            for _ in range(100):
                time.sleep(0.02)
                if "masses" in terminal.text:
                    break
    assert "masses" in terminal.text
    assert "0/2" in terminal.text or "1/2" in terminal.text
    assert terminal.text.endswith("\x1b[2K") or "\x1b[?25h" in terminal.text  # erased, cursor back


def test_a_terminal_sees_that_something_is_done_where_nothing_is_counted(monkeypatch):
    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    monkeypatch.setattr(progress, "PATIENCE", 0.02)
    with progress.progress():
        for _ in range(200):
            time.sleep(0.05)
            if "working" in terminal.text:
                break
    assert "working" in terminal.text


def test_a_file_gets_a_line_now_and_then(monkeypatch, capsys):
    monkeypatch.setattr(progress, "SILENCE", 0.0)
    with progress.progress():
        for _ in counted("ab", "masses"):
            time.sleep(0.01)
    assert capsys.readouterr().err == "progress: 0 of 2 masses\nprogress: 1 of 2 masses\n"


def test_work_is_counted_for_whoever_listens():
    told = []
    tell("nobody", 1)
    with counts_shown_by(lambda *told_now: told.append(told_now)):
        assert list(counted("ab", "letters")) == ["a", "b"]
    tell("nobody", 1)
    assert told == [("letters", 0, 2), ("letters", 1, 2), ("letters", 2, 2)]


BROKEN_OFF = """
import os, signal, sys
signal.signal(signal.SIGINT, signal.default_int_handler)  # not ignored, as it may be here
from hitjoints import counting
after = int(sys.argv.pop(1))
def tell(what, done, total=None):
    if done >= after:
        os.kill(os.getpid(), signal.SIGINT)
counting.tell = tell
from hitjoints.cli import main
main()
"""
LONG = {
    "plan --plot plan.png --out plan.json": (0, "nothing was written"),
    "hit --out answer": (0, "nothing was written"),
    "sweep mass --out mass.nc": (0, "nothing was written"),
    "replay --out hits.nc": (1, "nothing was written"),
    "reproduce fig2 --out deep/folder": (1, "nothing was written"),
    "simulate --out hit.nc --animate hit.gif": (2, "written: hit.nc"),
    "sweep workspace --x=-0.6:0.6:5 --y=-0.6:0.6:5 --samples 2 --threads 1 --out map.zarr": (
        1,
        "map.zarr keeps what is done, and the same command goes on from there",
    ),
}


def test_ctrl_c_says_what_is_kept_and_leaves_no_empty_folder(tmp_path):
    running = {}
    for number, (line, (after, _)) in enumerate(LONG.items()):
        folder = tmp_path / str(number)
        folder.mkdir()
        command = [sys.executable, "-c", BROKEN_OFF, str(after), *line.split()]
        running[line] = (
            folder,
            subprocess.Popen(
                command, cwd=folder, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE
            ),
        )
    for line, (folder, process) in running.items():
        out, err = process.communicate(timeout=120)
        assert (process.returncode, out) == (130, ""), f"{line}: {out}{err}"
        said = LONG[line][1]
        assert err == f"error: interrupted; {said}\n", line
        left = sorted(path.name for path in folder.iterdir())
        assert left == ([] if said.startswith("nothing") else [re.findall(r"\w+\.\w+", said)[0]])
