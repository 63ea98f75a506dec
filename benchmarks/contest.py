"""Ours against several peers, each of which has to give the right answer before it is timed."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from benchmarks.harness import Remark, Row, Work, compare

Check = Callable[[Any], str]
"""Return what is wrong with an answer, or nothing."""


@dataclass(frozen=True)
class Peer:
    """Another way to do the same.

    Attributes:
        name: of the library, and how it is used.
        make: imports it, makes ready what a user would keep, and returns the work.
        units: of work in one call.
        target: what the ratio should be, such as ">= 6".
        check: of its answer, if not the one of all peers.
    """

    name: str
    make: Callable[[], Work]
    units: int
    target: str = ""
    check: Check | None = None


def contest(
    what: str,
    ours: tuple[str, Work, int],
    peers: Iterable[Peer],
    check: Check,
    *,
    repeats: int = 7,
) -> list[Row | Remark]:
    """Compare `ours`, (name, work, units of work in one call), with each peer in turn.

    A peer that is not installed, fails, or gives an answer that the check refuses gets a remark
    instead of a row.

    Raises:
        AssertionError: our own answer fails the check.
    """
    wrong = check(ours[1]())
    assert not wrong, f"{what}, {ours[0]}: {wrong}"
    return [_meet(what, ours, peer, peer.check or check, repeats) for peer in peers]


def _meet(
    what: str, ours: tuple[str, Work, int], peer: Peer, check: Check, repeats: int
) -> Row | Remark:
    try:
        work = peer.make()
        wrong = check(work())
    except ImportError as error:
        return Remark(what, peer.name, f"skipped: {error.name or error} is not installed")
    except Exception as error:  # other people's code may raise anything
        return Remark(what, peer.name, f"not timed, it failed: {type(error).__name__}: {error}")
    if wrong:
        return Remark(what, peer.name, f"not timed, its answer is wrong: {wrong}")
    sides = (peer.name, work, peer.units)
    return replace(compare(what, ours, sides, target=peer.target, repeats=repeats), contest=True)


def near(expected: Any, tolerance: float) -> Check:
    """Return a check of answers, row by row: within `tolerance`, relative to the largest number.

    An answer may stop short of the last rows, where a slow peer does less work.
    """

    def check(answer: Any) -> str:
        got = np.asarray(answer, dtype=float)
        want = np.asarray(expected, dtype=float)[: len(got)]
        off = float(np.abs(got - want).max() / np.abs(want).max())
        return "" if off <= tolerance else f"off by {off:.1g} where {tolerance:.0e} is allowed"

    return check
