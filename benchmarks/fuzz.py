"""Random and hostile command lines and files: no traceback, no hang, no crash, one clear line.

    python -m benchmarks.fuzz --count 500 --seed 1 [--share 0.1] [--only 123]

Case i of a seed is the same on every machine. Options are read off the commands themselves, so that
a new one takes part. Most cases run in a worker process, through the same `main` as the script; a
share runs as processes of their own.
"""

from __future__ import annotations

import argparse
import collections
import contextlib
import io
import json
import os
import resource
import signal
import subprocess
import sys
import tempfile
import time
import traceback
from dataclasses import dataclass, field
from multiprocessing import Pipe, Process
from multiprocessing.connection import Connection
from pathlib import Path

from benchmarks.fuzz_cases import Case, Corpus, make_case

CPU = 10.0
"""s of computing after which a case counts as a hang, and"""
WALL = 90.0
"""s of waiting: machines are shared."""
MEMORY = 6 * 2**30
"""bytes that a worker may map."""
LINE = 3000
"""letters of a complaint at most."""
QUIET = ("warning: ", "progress: ", "written: ", "note: ", "not usable: ", "serving: ")
"""What may stand on stderr beside the one line."""


@dataclass
class Outcome:
    """What a case did."""

    code: int | None
    out: str
    err: str
    fault: str = ""


def judge(case: Case, outcome: Outcome) -> str:
    """Return what is wrong with an outcome; nothing if it is as it should be."""
    said = [line for line in outcome.err.splitlines() if not line.startswith(QUIET)]
    found = {
        outcome.fault: bool(outcome.fault),
        f"traceback: {said[-1:]}": "Traceback" in outcome.err,
        f"exit code {outcome.code}": outcome.code not in (0, 1, 2, 3),
        f"{len(said)} lines for exit code {outcome.code}: {said[:3]}": len(said) > 1,
        f"no line for exit code {outcome.code}": bool(outcome.code) and not said,
        f"complaint with exit code 0: {said[:1]}": outcome.code == 0 and bool(said),
        "a line too long to read": any(len(line) > LINE for line in said),
    }
    return next((fault for fault, is_so in found.items() if is_so), "") or _judge_json(
        case, outcome
    )


def _judge_json(case: Case, outcome: Outcome) -> str:
    """Return what is wrong with what a program would read."""
    if "--json" not in case.words or outcome.code not in (0, 3) or "--help" in case.words:
        return ""
    try:
        whole = isinstance(json.loads(outcome.out, parse_constant=_refuse), dict)
    except ValueError as error:
        return f"not one JSON object: {error}"
    return "" if whole else "JSON that is no object"


def _refuse(name: str) -> None:
    raise ValueError(name)


def call(words: list[str]) -> Outcome:
    """Run a command line in this process."""
    from hitjoints.cli import main  # type: ignore[import-not-found,unused-ignore]

    out, err = io.StringIO(), io.StringIO()
    code: int | None = None
    fault = ""
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        try:
            main(words)
        except SystemExit as leaving:
            code = leaving.code if isinstance(leaving.code, int) else 1
        except BaseException as error:
            last = traceback.extract_tb(error.__traceback__)[-1]
            where = f"{Path(last.filename).name}:{last.lineno}"
            fault = f"traceback: {type(error).__name__} {where} {str(error)[:120]}"
    return Outcome(code, out.getvalue(), err.getvalue(), fault)


def _work(pipe: Connection, folder: str) -> None:
    os.chdir(folder)
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 2)
    while True:
        pipe.send(call(pipe.recv()))


@dataclass
class Worker:
    """A process that runs cases one after the other, and is replaced when one kills it."""

    folder: str
    process: Process | None = None
    pipe: Connection | None = field(default=None, repr=False)

    def run(self, words: list[str]) -> Outcome:
        """Run one case."""
        if self.process is None or not self.process.is_alive():
            self.pipe, theirs = Pipe()
            self.process = Process(target=_work, args=(theirs, self.folder), daemon=True)
            self.process.start()
            theirs.close()
        assert self.pipe is not None
        assert self.process.pid is not None
        began, computed = time.monotonic(), _computed(self.process.pid)
        self.pipe.send(words)
        while not self.pipe.poll(0.2):
            if not self.process.is_alive():
                return Outcome(None, "", "", f"killed by signal {-(self.process.exitcode or 0)}")
            busy = _computed(self.process.pid) - computed
            if busy > CPU or time.monotonic() - began > WALL:
                self.process.kill()
                self.process.join()
                return Outcome(None, "", "", f"hang: {busy:.0f} s of computing")
        try:
            return self.pipe.recv()  # type: ignore[no-any-return]
        except EOFError:
            self.process.join()
            return Outcome(None, "", "", f"killed by signal {-(self.process.exitcode or 0)}")


def _computed(pid: int) -> float:
    """Return the seconds that a process has computed."""
    try:
        ticks = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    except OSError:
        return 0.0
    return (int(ticks[11]) + int(ticks[12])) / os.sysconf("SC_CLK_TCK")


def run_alone(words: list[str], folder: str) -> Outcome:
    """Run one case as a process of its own."""
    command = [sys.executable, "-m", "hitjoints.cli", *words]
    try:
        done = subprocess.run(
            command, cwd=folder, capture_output=True, timeout=WALL, check=False, input=b""
        )
    except subprocess.TimeoutExpired:
        return Outcome(None, "", "", f"hang: {WALL:g} s as a process")
    except ValueError as error:
        return Outcome(0, "{}", "", "" if "null byte" in str(error) else str(error))
    out, err = done.stdout.decode(errors="replace"), done.stderr.decode(errors="replace")
    return Outcome(done.returncode, out, err)


def main() -> None:
    """Run the cases and print what is wrong."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=300)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--share", type=float, default=0.05, help="run as processes of their own")
    parser.add_argument("--only", type=int, nargs="*", help="numbers of cases")
    asked = parser.parse_args()
    began = time.monotonic()
    wrong: dict[str, list[int]] = collections.defaultdict(list)
    codes: collections.Counter[int | None] = collections.Counter()
    with tempfile.TemporaryDirectory() as folder:
        corpus = Corpus(Path(folder))
        worker = Worker(folder)
        numbers = range(asked.count) if asked.only is None else asked.only
        for number in numbers:
            case = make_case(corpus, asked.seed, number)
            alone = case.draw < asked.share and not any("\0" in word for word in case.words)
            outcome = run_alone(case.words, folder) if alone else worker.run(case.words)
            codes[outcome.code] += 1
            if fault := judge(case, outcome) or corpus.left_behind():
                wrong[fault[:100]].append(number)
                shown = [word if len(word) < 80 else word[:60] + "..." for word in case.words]
                print(f"case {number}: {fault}\n    {shown}", flush=True)
            corpus.clean()
    seconds = time.monotonic() - began
    print(f"{sum(codes.values())} cases, seed {asked.seed}, {seconds:.0f} s; codes {dict(codes)}")
    for fault, where in sorted(wrong.items(), key=lambda item: -len(item[1])):
        print(f"{len(where):4d}  {fault}  cases {where[:5]}")
    sys.exit(bool(wrong))


if __name__ == "__main__":
    main()
