"""What can go wrong, each with the data a caller needs to react."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from difflib import get_close_matches
from typing import Any

SHOWN = 200  # characters of a value in a message
MOST_CHOICES = 60


def shown(value: object, text_of: Callable[[object], str] = str, longest: int = SHOWN) -> str:
    """Return a value's text as a message can hold it: one line, cut in the middle when long."""
    try:
        text = " ".join(text_of(value).split())
    except Exception:  # whatever cannot be written must still be refused in a line
        text = f"a {type(value).__name__}"
    if len(text) <= longest:
        return text
    return f"{text[: longest // 2]} ... {text[-longest // 4 :]} ({len(text)} characters)"


class HitjointsError(Exception):
    """Root of every error the package raises on purpose; its text is one line."""

    def __reduce__(self) -> tuple[Callable[..., Any], tuple[Any, ...]]:
        """Pickle the text and the data, not the constructor's arguments: workers hand it back."""
        return _restored, (type(self), self.args, self.__dict__)


def _restored(
    kind: type[HitjointsError], texts: tuple[Any, ...], data: dict[str, Any]
) -> HitjointsError:
    error = kind.__new__(kind, *texts)
    error.__dict__.update(data)
    return error


class InputError(HitjointsError, ValueError):
    """An argument cannot be used.

    Args:
        argument: name of the argument, as the caller wrote it.
        value: what was given.
        expected: what would be right.
    """

    def __init__(self, argument: str, value: object, expected: str) -> None:
        self.argument, self.value, self.expected = argument, value, expected
        super().__init__(f"{argument} = {shown(value)}: {expected}")


class UnknownNameError(InputError):
    """A name is not among the known ones; the message lists those, and what is meant perhaps.

    Args:
        argument: name of the argument, as the caller wrote it.
        value: what was given.
        choices: the known names.
        more: further names, which are told only when they are near.
    """

    def __init__(
        self, argument: str, value: object, choices: Iterable[str], more: Iterable[str] = ()
    ) -> None:
        self.choices = sorted(choices)
        near = _near(str(value), [*self.choices, *more])
        meant = f"did you mean {' or '.join(near)}? Else " if near else ""
        listed = self.choices[:MOST_CHOICES]
        if len(listed) < len(self.choices):
            listed.append(f"{len(self.choices) - len(listed)} more")
        super().__init__(argument, repr(value), f"{meant}choose one of {', '.join(listed)}")


def _near(name: str, known: list[str]) -> list[str]:
    """Return up to three names that a person may have meant."""
    word = name.lower()
    if len(word) < 2:
        return []
    within = [other for other in known if word in other.lower()]
    return list(dict.fromkeys([*within, *get_close_matches(name, known, cutoff=0.75)]))[:3]


class ModelError(HitjointsError):
    """A robot description cannot be used: not readable, or not a fixed-base serial arm."""

    def __init__(self, source: str, reason: str) -> None:
        self.source, self.reason = source, reason
        super().__init__(f"robot {shown(source)}: {reason}")


class InfeasibleError(HitjointsError):
    """The question was understood and the answer is no.

    Args:
        reason: what is in the way, in one sentence.
        data: numbers that show it (an infeasibility certificate, the nearest feasible value).
    """

    def __init__(self, reason: str, data: Mapping[str, object] | None = None) -> None:
        self.reason, self.data = reason, dict(data or {})
        super().__init__(reason)


class SolverError(HitjointsError):
    """A solver's answer failed our own residual check, and the problem is not shown infeasible."""


class KernelMismatchError(HitjointsError):
    """A generated kernel disagrees with Pinocchio and refuses to serve."""


class MissingExtraError(HitjointsError, ImportError):
    """An optional part is not installed; the message holds the install line."""

    def __init__(self, package: str, extra: str) -> None:
        self.package, self.extra = package, extra
        super().__init__(f"{package} is not installed: pip install 'hitjoints[{extra}]'")
