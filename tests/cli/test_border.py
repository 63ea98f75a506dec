"""Where a command begins and ends: signals, outputs that refuse, one line."""

import os
import signal
import subprocess
import sys
import warnings

import pytest

from hitjoints.cli import main
from hitjoints.errors import InputError

COMMAND = [sys.executable, "-m", "hitjoints.cli"]
LIMIT = 60  # s, for any process here


def started(*words, **options):
    return subprocess.Popen(
        [*COMMAND, *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **options
    )


SIGNALLED = """
import os, signal, sys, threading
signal.signal(signal.SIGINT, signal.default_int_handler)  # not ignored, as it may be here
from hitjoints.cli import main
after, number = float(sys.argv.pop(1)), int(sys.argv.pop(1))
threading.Timer(after, os.kill, (os.getpid(), number)).start()
main()
"""


@pytest.mark.parametrize("after", [0.03, 0.15, 0.5, 1.5])
@pytest.mark.parametrize(
    ("number", "words"), [(signal.SIGINT, "interrupted"), (signal.SIGTERM, "terminated")]
)
def test_a_signal_ends_with_one_line(after, number, words):
    """During the imports, between them and in the middle of the work."""
    command = [sys.executable, "-c", SIGNALLED, str(after), str(int(number))]
    done = subprocess.run(
        [*command, "sweep", "workspace", "--samples", "100000"],
        check=False,
        capture_output=True,
        text=True,
        timeout=LIMIT,
    )
    assert (done.returncode, done.stdout) == (128 + number, "")
    assert done.stderr == f"error: {words}; nothing was written\n"


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="needs /dev/full")
@pytest.mark.parametrize("words", [["inspect", "--json"], ["robots"], ["--help"]])
def test_output_that_cannot_be_written(words):
    with open("/dev/full", "w") as full:
        done = subprocess.run(
            [*COMMAND, *words],
            check=False,
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
            timeout=LIMIT,
        )
    assert done.returncode == 1
    assert done.stderr == "error: the output: No space left on device\n"


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="needs /dev/full")
def test_complaints_that_cannot_be_written():
    with open("/dev/full", "w") as full:
        command = [*COMMAND, "inspect", "--q", "1"]
        done = subprocess.run(command, check=False, stderr=full, timeout=LIMIT)
    assert done.returncode == 1


def test_a_reader_that_has_seen_enough():
    with started("robots", "list") as it:
        it.stdout.close()
        assert it.wait(timeout=LIMIT) == 0
        assert it.stderr.read() == ""


def test_libraries_below_python_are_not_heard(tmp_path):
    # urdfdom says its own about a colour that it cannot read.
    link = '<link name="a"><visual><geometry><box size="1 1 1"/></geometry>'
    link += '<material name=""><color rgba="x"/></material></visual></link>'
    path = tmp_path / "arm.urdf"
    path.write_text(f'<robot name="r">{link}</robot>')
    with started("inspect", "--robot", str(path)) as it:
        _, err = it.communicate(timeout=LIMIT)
    assert it.returncode == 1
    assert err.count("\n") == 1
    assert err.startswith("error: robot ")


def test_warnings_of_libraries_are_not_the_users(run, monkeypatch):
    from hitjoints.evidence.recordings import replayer as replay

    def warn(*_, **__):
        warnings.warn("overflow encountered", RuntimeWarning, stacklevel=1)
        raise InputError("files", "x", "none is there")

    monkeypatch.setattr(replay, "replay", warn)
    outcome = run("replay")
    assert outcome.err == "error: files = x: none is there\n"


def test_markup_and_escapes_in_names_are_text(run, urdf):
    inertial = (
        '<inertial><mass value="1e-6"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>'
        "</inertial>"
    )
    name = "[/bold] [red]"
    parts = [
        urdf.base,
        urdf.link("link_1"),
        f'<link name="{name}">{inertial}</link>',
        urdf.joint("joint_1", "base", "link_1"),
        urdf.joint("joint_2", "link_1", name),
    ]
    outcome = run("robots", "check", urdf.write(urdf.robot(*parts)))
    assert outcome.code == 0
    assert name in outcome.words


def test_a_line_stays_one_line_of_a_length_to_read(run):
    outcome = run("inspect", "--robot", "x\x1b[2J\n" + 4_000_000 * "y")
    assert outcome.code == 1
    assert outcome.err.count("\n") == 1
    assert "\x1b" not in outcome.err
    assert len(outcome.err) < 1000


def test_values_in_errors_are_shortened():
    error = InputError("hits", 1_000_000 * "9", "a number")
    assert len(str(error)) < 300
    assert error.value == 1_000_000 * "9"


def test_memory_that_is_not_there(run, monkeypatch):
    import hitjoints as hj

    def refuse(*_, **__):
        raise MemoryError

    monkeypatch.setattr(hj, "sweep_joint", refuse)
    assert run("sweep", "joint").err == "error: there is not enough memory for this\n"


def test_a_bug_is_not_hidden(monkeypatch):
    import hitjoints as hj

    monkeypatch.setattr(hj, "sweep_joint", lambda *_, **__: 1 / 0)
    with pytest.raises(ZeroDivisionError):
        main(["sweep", "joint"])
