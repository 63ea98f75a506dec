"""Functions whose first argument says what they do: a robot, a hit, or a plan."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from functools import singledispatch, wraps
from typing import TYPE_CHECKING, Any, TypeVar, cast

if TYPE_CHECKING:
    from functools import _SingleDispatchCallable

T = TypeVar("T")


def by_first_argument(function: Callable[..., T]) -> _SingleDispatchCallable[T]:
    """Return a function that is chosen by the type of its first argument, positional or named.

    Like `functools.singledispatch`, `register` adds another.
    """
    chosen = singledispatch(function)
    first = [_first(function)]

    @wraps(function)
    def call(*values: Any, **named: Any) -> T:
        if not values:
            name = next((name for name in first if name in named), None)
            if name is not None:
                values = (named.pop(name),)
        return chosen(*values, **named)

    def register(kind: type) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
        def add(other: Callable[..., Any]) -> Callable[..., Any]:
            first.insert(0, _first(other))
            return chosen.register(kind)(other)

        return add

    call.register = register  # type: ignore[attr-defined]
    return cast("_SingleDispatchCallable[T]", call)


def _first(function: Callable[..., Any]) -> str:
    return next(iter(inspect.signature(function).parameters))
