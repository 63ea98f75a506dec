"""Where a command begins and ends: exit codes, one line for what went wrong, signals.

0 done; 1 the input or the run failed; 2 wrong usage; 3 the question was understood and the
answer is no; 128 + n ended by signal n, as shells count. What is imported at the top is light:
signals are in hand before the heavy imports begin.
"""

from __future__ import annotations

import logging
import os
import sys
import warnings
from collections.abc import Sequence
from typing import Any

from hitjoints.errors import HitjointsError, InfeasibleError, shown

from .complaints import complain, loudness
from .kept import begin, kept
from .signals import Signals

DONE, FAILED, USAGE, NO = 0, 1, 2, 3


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command line and leave with its exit code.

    Args:
        arguments: the words after `hitjoints`; by default this process's, which is the
            command alone then: its signals are taken, and libraries are kept off stderr.
    """
    signals = Signals()
    if arguments is None:
        signals.take()
        _keep_stderr()
        logging.getLogger().addHandler(logging.NullHandler())
    warnings.showwarning = _warn
    words = list(sys.argv[1:] if arguments is None else arguments)
    begin()
    loudness.level = 0
    code = DONE
    try:
        code = _run(words)
    except BaseException as error:
        # An error that a signal brought about, as in a half-made import, is not what went wrong.
        if signals.taken is None:
            code = _explain(error, words)
    signals.close()
    if signals.taken is not None:
        complain("error", f"{signals.words}; {kept()}")
        # Threads that compute are not waited for: what they would write is not wanted any more.
        os._exit(128 + signals.taken)
    sys.exit(code)


def _run(words: list[str]) -> int:
    from .app import app

    _reconfigure_stdout()
    code = app(args=words, prog_name="hitjoints", standalone_mode=False)
    if sys.stdout is not None:
        sys.stdout.flush()
    return code or DONE


def _explain(error: BaseException, words: list[str]) -> int:
    """Say in one line what went wrong, and return the exit code; raise it again if it is a bug."""
    import typer

    usage_error: Any = typer.BadParameter.__base__
    match error:
        case InfeasibleError():
            if "--json" in words:
                from .render import print_json

                print_json({"feasible": False, "reason": error.reason, **error.data})
            complain("no", str(error))
            return NO
        case HitjointsError():
            complain("error", str(error))
        case usage_error():
            complain("usage", error.format_message())
            return USAGE
        case typer.Abort():
            complain("error", f"interrupted; {kept()}")
        case SystemExit() | BrokenPipeError():
            # The reader of a pipe has seen enough; Typer leaves then.
            _abandon_stdout()
            return DONE
        case OSError():
            _abandon_stdout()
            where = "the output" if error.filename is None else shown(error.filename)
            complain("error", f"{where}: {error.strerror or error}")
        case MemoryError():
            complain("error", "there is not enough memory for this")
        case _:
            raise error
    return FAILED


def _warn(message: Warning | str, category: type[Warning], *_: Any, **__: Any) -> None:
    """Print the package's own warnings; those of libraries only where details are wanted."""
    if category.__module__.startswith("hitjoints"):
        complain("warning", str(message))
    elif loudness.tells("detail"):
        complain("detail", f"{category.__name__}: {message}")


def _keep_stderr() -> None:
    """Let stderr be ours alone: urdfdom, assimp and others write to it past Python."""
    try:
        mine = os.dup(2)
    except OSError:
        return  # it is closed
    sys.stderr = open(mine, "w", buffering=1, encoding="utf-8", errors="backslashreplace")  # noqa: SIM115
    with open(os.devnull, "w") as nowhere:
        os.dup2(nowhere.fileno(), 2)


def _reconfigure_stdout() -> None:
    """Print what the terminal has no letter for as an escape."""
    if hasattr(sys.stdout, "reconfigure"):
        sys.stdout.reconfigure(errors="backslashreplace")


def _abandon_stdout() -> None:
    """Send what is still to be written nowhere: it could only fail again."""
    try:
        stdout = sys.stdout.fileno()
    except (AttributeError, OSError, ValueError):
        return
    with open(os.devnull, "w") as nowhere:
        os.dup2(nowhere.fileno(), stdout)
