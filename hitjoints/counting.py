"""Work that is counted, for whoever wants to show how far it is."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import TypeVar

Shown = Callable[[str, int, int | None], None]
"""Told what is counted, how many are done, and of how many, if that is known."""
T = TypeVar("T")

_shown: ContextVar[Shown | None] = ContextVar("shown", default=None)


def counted(items: Collection[T], what: str) -> Iterator[T]:
    """Yield items, and tell before each and after the last how many are done.

    Args:
        items: the work.
        what: the items are, in the plural.
    """
    for done, item in enumerate(items):
        tell(what, done, len(items))
        yield item
    tell(what, len(items), len(items))


def tell(what: str, done: int, total: int | None = None) -> None:
    """Tell how many are done; nobody listens unless `counts_shown_by` says so."""
    shown = _shown.get()
    if shown is not None:
        shown(what, done, total)


@contextmanager
def counts_shown_by(shown: Shown) -> Iterator[None]:
    """Let counts of what runs inside, in this thread, be shown by a function."""
    before = _shown.set(shown)
    try:
        yield
    finally:
        _shown.reset(before)
