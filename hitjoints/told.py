"""Results that say themselves: in a line, and in a notebook in a small table."""

from __future__ import annotations

import html
from collections.abc import Mapping
from dataclasses import fields
from typing import Any

import numpy as np

from hitjoints.errors import shown

LONGEST = 160
"""Characters of a line."""
FEW = 8
"""Numbers that are told one by one."""


class Told:
    """A dataclass that says itself by its `words`, or else by its fields."""

    def lines(self) -> list[tuple[str, object]]:
        """Return what a table tells, name by name."""
        names = [f.name for f in fields(self) if f.repr]  # type: ignore[arg-type]
        return [(name, getattr(self, name)) for name in names if not name.startswith("_")]

    def __repr__(self) -> str:
        """Say in a line what it is."""
        words = getattr(self, "words", None)
        if words is None:
            words = ", ".join(f"{name} {brief(value)}" for name, value in self.lines())
        return f"{type(self).__name__}({shown(words, longest=LONGEST)})"

    def _repr_html_(self) -> str:
        """Return a small table, for notebooks."""
        title = html.escape(repr(self))
        rows = "".join(
            f'<tr><th style="text-align: left">{html.escape(name.replace("_", " "))}</th>'
            f'<td style="text-align: left">{html.escape(brief(value))}</td></tr>'
            for name, value in self.lines()
        )
        return f"<table><caption>{title}</caption><tbody>{rows}</tbody></table>"


def brief(value: object) -> str:
    """Return a value as a person reads it: few digits, few entries."""
    if isinstance(value, (bool, np.bool_)):
        return "yes" if value else "no"
    if isinstance(value, (float, np.floating)):
        return f"{value:.4g}"
    if isinstance(value, (np.ndarray, Mapping, list, tuple)):
        return _listed(value)
    name = getattr(value, "name", None)
    return "-" if value is None else name or shown(value, longest=LONGEST)


def _listed(values: Any) -> str:
    if isinstance(values, Mapping):
        return ", ".join(f"{name} {brief(item)}" for name, item in values.items()) or "-"
    if isinstance(values, np.ndarray):
        many = values.size > FEW
        return f"array of {' x '.join(map(str, values.shape))}" if many else brief(values.tolist())
    return f"{len(values)} of them" if len(values) > FEW else f"({', '.join(map(brief, values))})"
