"""Time two things in turn and report their ratio with its spread."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable
from dataclasses import dataclass

Work = Callable[[], object]


@dataclass(frozen=True)
class Row:
    """One comparison.

    Attributes:
        what: what is compared.
        ours: names of the two sides.
        peer: names of the two sides.
        ours_time: median seconds of one unit of work on each side.
        peer_time: median seconds of one unit of work on each side.
        ratio: median of the paired ratios named by `meaning`.
        low: their extremes.
        high: their extremes.
        meaning: "cost" is ours / peer, "gain" is peer / ours.
        target: what the ratio should be, such as "<= 2.5".
        contest: the peer is what a user would otherwise use, and its answers agree with ours.
    """

    what: str
    ours: str
    peer: str
    ours_time: float
    peer_time: float
    ratio: float
    low: float
    high: float
    meaning: str
    target: str = ""
    contest: bool = False

    @property
    def met(self) -> bool:
        """The target is reached (or there is none)."""
        return meets(self.ratio, self.target)

    @property
    def verdict(self) -> str:
        """Whether the target is met, and who is slower."""
        slower = self.ratio > 1 if self.meaning == "cost" else self.ratio < 1
        return ", ".join(filter(None, (told(self), "peer is faster" * slower)))


@dataclass(frozen=True)
class Figure:
    """One number that is not a comparison."""

    what: str
    value: float
    unit: str
    target: str = ""

    @property
    def met(self) -> bool:
        """The target is reached (or there is none)."""
        return meets(self.value, self.target)

    @property
    def verdict(self) -> str:
        """Whether the target is met."""
        return told(self)


@dataclass(frozen=True)
class Remark:
    """A comparison that could not be made: the peer is missing, or is wrong."""

    what: str
    peer: str
    verdict: str
    met: bool = True


def told(result: Row | Figure) -> str:
    """Return "met" or "NOT met", or nothing if there is no target."""
    return "" if not result.target else "met" if result.met else "NOT met"


def meets(value: float, target: str) -> bool:
    """Tell whether a value meets a target such as "<= 2.5"."""
    sign, _, number = target.partition(" ")
    if not number:
        return True
    return value <= float(number) if sign == "<=" else value >= float(number)


def compare(
    what: str,
    ours: tuple[str, Work, int],
    peer: tuple[str, Work, int],
    *,
    meaning: str = "gain",
    target: str = "",
    repeats: int = 7,
) -> Row:
    """Time `ours` and `peer` in turn, each given as (name, work, units of work in one call)."""
    pairs = []
    for work in (ours[1], peer[1]):
        work()
    for _ in range(repeats):
        pairs.append((seconds(ours[1]) / ours[2], seconds(peer[1]) / peer[2]))
    ratios = [a / b if meaning == "cost" else b / a for a, b in pairs]
    return Row(
        what,
        ours[0],
        peer[0],
        statistics.median(a for a, _ in pairs),
        statistics.median(b for _, b in pairs),
        statistics.median(ratios),
        min(ratios),
        max(ratios),
        meaning,
        target,
    )


def seconds(work: Work) -> float:
    """Return the wall time of one call."""
    begin = time.perf_counter()
    work()
    return time.perf_counter() - begin
