"""What the fuzz tries: command lines from the commands' own options, and files with mutations."""

from __future__ import annotations

import random
import re
import shutil
from collections.abc import Sequence
from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from typing import Any

import typer.main

HOSTILE_NUMBERS = (
    "nan", "inf", "-inf", "1e308", "-1e308", "1e-308", "5e-324", "1e400", "0", "-0", "-1", "1e-18",
    "1e18", "9007199254740993", str(2**31), str(2**63), str(2**64), "9" * 400, "1_0", " 1", "1 ",
    "\uff11", "0x10", "1e", "--", "", "true", "None", "1,2", "\u0665",
)  # fmt: skip
HOSTILE_TEXTS = (
    "", " ", "\0", "\n", "[/bold]", "[red]x", "../..", "/", "/dev/null", "/dev/zero", "/etc/passwd",
    "~", "x" * 300, "x" * 5000, "\x1b[2J", "\ud800", "\U0001f4a5", "a\u0301", "%s%n", "{}", "$(id)",
    ".", "..", "-", "--", "nul", "iiwa14", "IIWA14", "no.such", "a/b/c.urdf", "\u202eurdf",
)  # fmt: skip
RANGES = (
    "0.5", "0.3:0.6:2", "-0.2:0.2:3", "0.6:0.3:2", "0:1:0", "1:2", "a:b:c", "0:0:2", "::", "0:1:-3",
)  # fmt: skip
SANE: dict[str, tuple[str, ...]] = {
    "robot": ("iiwa14", "iiwa14", "panda", "xarm7", "iiwa7", "ur5"),
    "objective": ("inertia", "flux", "straight-flux", "rebound"),
    "reference": ("constant", "optimised"),
    "law": ("qp", "paper"),
    "weighting": ("identity", "gradient"),
    "speed_profile": ("constant", "paper"),
    "figure": ("fig2",),
    "host": ("127.0.0.1",),
    **dict.fromkeys("xyz", RANGES),
}
"""Values that mean something, by the name of the option."""
NUMBERS = ("0", "1", "2", "5", "6", "7", "8", "0.01", "0.1", "0.5", "1.5")
HOSTILE = 0.4
"""Share of values that mean nothing, or too much."""
OUTPUTS = ("plot", "out", "nc", "csv", "animate", "new")
INPUTS: dict[str, tuple[str, ...]] = {
    "robot": ("urdf", "urdf", "toml"),
    "plan": ("json",),
    "files": ("csv",),
    **dict.fromkeys(("hit", "file", "tool"), ("toml",)),
}
"""The kinds of file that are read, by the name of the option."""
KINDS = ("urdf", "toml", "json", "csv")
VECTORS = {"object", "direction", "offset", "start", "size", "object-size", "goal"}
CHEAP = {
    ("sweep", "workspace"): ["--x", "0.4:0.6:2", "--y", "0.3", "--samples", "4"],
    ("view",): ["--out", "page.html"],
    ("reproduce",): ["nothing"],
}
"""What is always said first, so that a case takes seconds: what comes after may say otherwise."""


@dataclass(frozen=True)
class Case:
    """A command line.

    Attributes:
        words: after `hitjoints`.
        draw: 0 to 1, decides whether it runs as a process of its own.
    """

    words: list[str]
    draw: float


class Corpus:
    """Good files, and where mutated copies of them are written.

    Args:
        folder: the working folder of the cases.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        robots = Path(str(resources.files("hitjoints.robots")))
        recordings = Path(str(resources.files("hitjoints.evidence.recordings"))) / "examples"
        self.good: dict[str, list[Path]] = {
            "urdf": sorted(robots.glob("*.urdf")),
            "toml": sorted(robots.glob("*.toml")),
            "csv": sorted(recordings.glob("*.csv")),
            "json": [],
        }
        self.good["json"] = [self._plan()]
        self._kept = {self.good["json"][0].name}

    def _plan(self) -> Path:
        from benchmarks.fuzz import call

        path = self.folder / "plan.json"
        outcome = call(["plan", "--no-certificate", "--out", str(path)])
        assert outcome.code == 0, outcome.err
        return path

    def spoilt(self, chance: random.Random, kind: str) -> str:
        """Write a file of a kind that is not quite as it should be, and return its name."""
        source = chance.choice(self.good[kind])
        text = source.read_text(encoding="utf-8")
        for _ in range(chance.choice((0, 1, 1, 1, 2, 5))):
            text = mutated(chance, text)
        name = source.name if kind == "csv" else f"mutant.{kind}"
        path = self.folder / name
        if kind == "csv":
            for other in source.parent.glob("*.csv"):
                shutil.copy(other, self.folder / other.name)
        if path not in self.good["json"]:
            path.write_text(text, encoding="utf-8", errors="surrogatepass")
            return name
        other = self.folder / "mutant.json"
        other.write_text(text, encoding="utf-8", errors="surrogatepass")
        return other.name

    def left_behind(self) -> str:
        """Return what should not be there after a command, if anything is."""
        names = [path.name for path in self.folder.iterdir() if path.name.startswith(".")]
        return f"left behind: {names}" if names else ""

    def clean(self) -> None:
        """Remove what a case has written."""
        for path in self.folder.iterdir():
            if path.name not in self._kept:
                if path.is_dir() and not path.is_symlink():
                    shutil.rmtree(path)
                else:
                    path.unlink()


def make_case(corpus: Corpus, seed: int, number: int) -> Case:
    """Return a case; the same for the same seed and number."""
    chance = random.Random(seed * 1_000_003 + number)
    name, command = chance.choice(_commands())
    words = [*name]
    options = [option for option in command.params if option.name not in ("help", "version")]
    said = [word for key, values in CHEAP.items() if key == name for word in values]
    words += said
    for option in chance.sample(options, min(len(options), chance.choice((0, 1, 2, 3, 5)))):
        words += _said(corpus, chance, option)
    if chance.random() < 0.5 and "--json" not in words:
        words.append("--json")
    if chance.random() < 0.03:
        words.insert(chance.randrange(len(words) + 1), chance.choice(HOSTILE_TEXTS))
    if name == ("view",):
        words += CHEAP[name]
    return Case(words, chance.random())


def _commands() -> list[tuple[tuple[str, ...], Any]]:
    from hitjoints.cli.app import app  # type: ignore[import-not-found,unused-ignore]

    found: list[tuple[tuple[str, ...], Any]] = []

    def walk(command: Any, name: tuple[str, ...]) -> None:
        children: dict[str, Any] = getattr(command, "commands", {})
        if not children:
            found.append((name, command))
        for key, child in sorted(children.items()):
            walk(child, (*name, key))

    walk(typer.main.get_command(app), ())
    return found


def _said(corpus: Corpus, chance: random.Random, option: Any) -> list[str]:
    """Return an option with a value, or an argument."""
    flag = option.opts[0]
    if getattr(option, "is_flag", False):
        return [chance.choice([*option.opts, *option.secondary_opts])]
    value = _given(corpus, chance, option, flag.lstrip("-"))
    return [flag, value] if flag.startswith("-") else [value]


def _given(corpus: Corpus, chance: random.Random, option: Any, long: str) -> str:
    hostile = chance.random() < HOSTILE
    if long in OUTPUTS:
        return _output(chance, long, hostile)
    if long in INPUTS:
        return _input(corpus, chance, long, hostile)
    if long in VECTORS:
        return _vector(chance, 3, hostile)
    if long in ("q", "q0"):
        return _vector(chance, 7 if chance.random() < 0.9 else chance.randrange(12), hostile)
    if hostile:
        return chance.choice(HOSTILE_NUMBERS + HOSTILE_TEXTS)
    number = f"{chance.lognormvariate(-1, 2):.4g}"
    return chance.choice(SANE.get(option.name, (*NUMBERS, number)))


def _vector(chance: random.Random, count: int, hostile: bool) -> str:
    entries = [f"{chance.uniform(-0.8, 0.8):.3g}" for _ in range(count)]
    if hostile and entries:
        entries[chance.randrange(count)] = chance.choice(HOSTILE_NUMBERS)
    if hostile and chance.random() < 0.3:
        entries = entries[: chance.randrange(count + 1)] + entries[: chance.randrange(3)]
    return ",".join(entries)


def _output(chance: random.Random, long: str, hostile: bool) -> str:
    if hostile:
        text = chance.choice(HOSTILE_TEXTS)
        # Nothing outside the folder is to be touched, whatever the answer would be.
        return text if not text.startswith(("/", "~", "..")) else "no/x.zarr"
    endings = {"plot": (".png", ".svg"), "nc": (".nc",), "csv": (".csv",), "animate": (".gif",)}
    usual = (".zarr", ".nc", ".csv", ".json", ".html", ".toml", ".txt")
    return f"made{chance.choice(endings.get(long, usual))}"


def _input(corpus: Corpus, chance: random.Random, long: str, hostile: bool) -> str:
    if long == "robot" and chance.random() < 0.4:
        return chance.choice(SANE["robot"])
    if hostile:
        text = chance.choice(HOSTILE_TEXTS)
        # Folders of the machine are searched for recordings as long as there are any.
        return text if text not in ("/dev/zero", "/", "..", "../..") else "/dev/null"
    kinds = INPUTS[long] if chance.random() < 0.9 else KINDS
    return corpus.spoilt(chance, chance.choice(kinds))


def mutated(chance: random.Random, text: str) -> str:
    """Return a text with one thing changed."""
    return chance.choice(MUTATIONS)(chance, text)


def _replaced(chance: random.Random, text: str, pattern: str, by: Sequence[str]) -> str:
    spots = list(re.finditer(pattern, text))
    if not spots:
        return text
    spot = chance.choice(spots)
    return text[: spot.start()] + chance.choice(by) + text[spot.end() :]


def _number(chance: random.Random, text: str) -> str:
    return _replaced(chance, text, r"-?\d+(?:\.\d+)?(?:e-?\d+)?", HOSTILE_NUMBERS)


def _word(chance: random.Random, text: str) -> str:
    return _replaced(chance, text, r"[A-Za-z_]{3,}", HOSTILE_TEXTS)


def _value(chance: random.Random, text: str) -> str:
    kinds = ('"text"', "[]", "{}", "null", "1", "true", '"nan"', "[[1], 2]", '""')
    return _replaced(chance, text, r'"[^"\n]*"|\[[^\]]*\]', kinds)


def _line_less(chance: random.Random, text: str) -> str:
    return _replaced(chance, text, r"[^\n]*\n", [""])


def _line_more(chance: random.Random, text: str) -> str:
    return _replaced(chance, text, r"(?m)^", [line + "\n" for line in text.splitlines()] or [""])


def _cut(chance: random.Random, text: str) -> str:
    return text[: chance.randrange(len(text) + 1)]


def _added(chance: random.Random, text: str) -> str:
    at = chance.randrange(len(text) + 1)
    by = chance.choice(('"', "<", "{", "[" * 3000, "\0", "\ufeff", "]"))
    return text[:at] + by + text[at:]


MUTATIONS = (_number, _number, _number, _word, _value, _line_less, _line_more, _cut, _added)
