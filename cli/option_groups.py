"""Options that belong together: declared once as a class, taken by a command as one argument."""

from __future__ import annotations

import inspect
import time
from collections.abc import Callable, Mapping
from copy import copy
from dataclasses import dataclass, fields
from functools import wraps
from typing import Annotated, Any, ClassVar, NamedTuple, get_args, get_origin, get_type_hints

import typer
from typer.models import OptionInfo

from .complaints import complain, loudness
from .progress import progress

Fill = Callable[[Mapping[str, Any]], Mapping[str, Any]]
CONTEXT = "context"  # the argument by which Typer tells what was typed
KEYWORD = inspect.Parameter.KEYWORD_ONLY


@dataclass(frozen=True)
class OptionGroup:
    """Options that belong together.

    A subclass is a frozen dataclass whose fields are annotated as a command's arguments are; all
    have defaults.
    """

    panel: ClassVar[str] = "Options"
    """The heading over them in a command's help."""


@dataclass(frozen=True)
class TellingOptions(OptionGroup):
    """How much is told on stderr; every command has them."""

    panel: ClassVar[str] = "Telling"

    quiet: Annotated[
        bool, typer.Option("--quiet", "-q", help="No notes and no progress on stderr.")
    ] = False
    verbose: Annotated[
        bool, typer.Option("--verbose", "-v", help="More on stderr, such as libraries' warnings.")
    ] = False

    def heed(self) -> None:
        """Tell so much from now on."""
        if self.quiet or self.verbose:
            loudness.level = -1 if self.quiet else 1


class Without(NamedTuple):
    """Says of a group which of its options a command has no use for."""

    names: frozenset[str]


def without(*names: str) -> Without:
    """Name the options of a group that a command has no use for, beside it in `Annotated`."""
    return Without(frozenset(names))


def grouped(command: Callable[..., Any], fill: Fill | None = None) -> Callable[..., Any]:
    """Return a command that takes the options of its groups one by one, as Typer reads them.

    Args:
        command: a function whose arguments are options, or groups of them.
        fill: returns values for options that were not typed, from those that were, by name.

    Raises:
        TypeError: two options of the command have one name.
    """
    hints = get_type_hints(command, include_extras=True)
    groups: dict[str, tuple[type[OptionGroup], list[str]]] = {}
    flat: list[inspect.Parameter] = []
    for parameter in inspect.signature(command).parameters.values():
        kind, left_out = _group(hints[parameter.name])
        if kind is None:
            flat.append(parameter.replace(kind=KEYWORD, annotation=hints[parameter.name]))
        else:
            parts = [part for part in _parameters(kind) if part.name not in left_out]
            groups[parameter.name] = kind, [part.name for part in parts]
            flat += parts
    flat += _parameters(TellingOptions)
    names = [parameter.name for parameter in flat]
    if len(set(names)) < len(names):
        raise TypeError(f"{command.__name__} has two options of one name: {names}")

    @wraps(command)
    def call(**values: Any) -> Any:
        context = values.pop(CONTEXT)
        TellingOptions(values.pop("quiet"), values.pop("verbose")).heed()
        typed = {name: values[name] for name in values if _is_typed(context, name)}
        told = {} if fill is None else fill(typed)
        values |= {name: told[name] for name in told if name in values and name not in typed}
        for name, (kind, parts) in groups.items():
            values[name] = kind(**{part: values.pop(part) for part in parts})
        begun = time.perf_counter()
        with progress():
            answer = command(**values)
        complain("detail", f"done in {time.perf_counter() - begun:.2f} s")
        return answer

    flat.append(inspect.Parameter(CONTEXT, KEYWORD, annotation=typer.Context))
    del call.__dict__["__wrapped__"]  # Typer would look through to the command
    call.__signature__ = inspect.Signature(flat)  # type: ignore[attr-defined]
    call.__annotations__ = {parameter.name: parameter.annotation for parameter in flat}
    return call


def show_help(context: typer.Context) -> None:
    """Show what commands there are where none is named."""
    if context.invoked_subcommand is None:
        print(context.get_help())


def _is_typed(context: typer.Context, name: str) -> bool:
    """Tell whether an option was given a value on the command line."""
    source = context.get_parameter_source(name)
    return source is not None and source.name == "COMMANDLINE"


def _group(hint: Any) -> tuple[type[OptionGroup] | None, frozenset[str]]:
    """Return the group that an annotation names, if it does, and what is left out of it."""
    left_out: frozenset[str] = frozenset()
    if get_origin(hint) is Annotated:
        hint, *notes = get_args(hint)
        left_out = frozenset().union(*(note.names for note in notes if isinstance(note, Without)))
    is_group = isinstance(hint, type) and issubclass(hint, OptionGroup)
    return (hint if is_group else None), left_out


def _parameters(group: type[OptionGroup]) -> list[inspect.Parameter]:
    """Return the options of a group, under its heading."""
    hints = get_type_hints(group, include_extras=True)
    found = []
    for field in fields(group):
        base, *notes = get_args(hints[field.name])
        shown = [_under(group.panel, note) for note in notes]
        found.append(
            inspect.Parameter(
                field.name,
                KEYWORD,
                default=field.default,
                annotation=Annotated[base, *shown],
            )
        )
    return found


def _under(panel: str, note: Any) -> Any:
    if not isinstance(note, OptionInfo):
        return note
    placed = copy(note)
    placed.rich_help_panel = panel
    return placed
