"""The reference of the commands, read from the application itself when the pages are built.

```{command} sweep joint
```
stands for the usage, the help and every option of `hitjoints sweep joint`.
"""

from __future__ import annotations

import re
from typing import Any, NamedTuple

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

PROGRAM = "hitjoints"
SAID_IN_WORDS = re.compile(r"default[:s ]|\(default")


class Described(NamedTuple):
    """What there is to say of a command."""

    usage: str
    paragraphs: list[str]
    panels: dict[str, list[tuple[str, str]]]
    """By the heading in the help: options as typed, with their meaning."""


def commands() -> dict[str, Any]:
    """Return every command that does something, by what is typed for it, and the program itself."""
    import typer

    from hitjoints.cli.app import app

    program = typer.main.get_command(app)
    found: dict[str, Any] = {PROGRAM: program}
    waiting: list[tuple[str, Any]] = [("", program)]
    while waiting:
        name, command = waiting.pop(0)
        below = getattr(command, "commands", {})
        waiting += [(f"{name} {word}".strip(), child) for word, child in below.items()]
        if not below:
            found[name] = command
    return found


def described(name: str, command: Any) -> Described:
    """Return what the application says of a command."""
    given = [p.metavar or p.name.upper() for p in command.params if _is_argument(p)]
    panels: dict[str, list[tuple[str, str]]] = {}
    for parameter in command.params:
        if not parameter.hidden:
            option = _typed(parameter), _meaning(parameter)
            panels.setdefault(parameter.rich_help_panel or "Options", []).append(option)
    typed = [PROGRAM] if name == PROGRAM else [PROGRAM, name]
    usage = " ".join([*typed, *given, "[OPTIONS]"])
    return Described(usage, (command.help or "").split("\n\n"), panels)


def _is_argument(parameter: Any) -> bool:
    return parameter.param_type_name == "argument"


def _typed(parameter: Any) -> str:
    if _is_argument(parameter):
        return str(parameter.metavar or parameter.name.upper())
    words = ", ".join(parameter.opts)
    if parameter.secondary_opts:
        words += " | " + ", ".join(parameter.secondary_opts)
    if parameter.is_flag:
        return words
    return f"{words} {parameter.metavar or _kind(parameter)}"


def _kind(parameter: Any) -> str:
    """Return a word for what is typed after an option that names none."""
    kinds = {int: "N", float: "X"}
    annotation = str(parameter.type_descriptor.annotation)
    return next((word for kind, word in kinds.items() if kind.__name__ in annotation), "WORD")


def _meaning(parameter: Any) -> str:
    meaning = parameter.help or ""
    default = parameter.default
    if parameter.secondary_opts:
        default = (parameter.opts if default else parameter.secondary_opts)[0]
    elif getattr(parameter, "is_flag", False) or callable(default) or default in (None, (), []):
        return meaning
    if SAID_IN_WORDS.search(meaning):
        return meaning
    if isinstance(default, (list, tuple)):
        default = " ".join(map(str, default))
    return f"{meaning} (default: {default})"


class Command(SphinxDirective):
    """Put the reference of one command on the page."""

    required_arguments = 1
    final_argument_whitespace = True

    def run(self) -> list[nodes.Node]:
        """Return the usage, the help, and a list of options for each panel."""
        name = self.arguments[0]
        known = commands()
        if name not in known:
            raise self.error(f"no command {name!r}: choose from {', '.join(known)}")
        told = described(name, known[name])
        usage = nodes.literal_block(told.usage, told.usage, language="text")
        made: list[nodes.Node] = [usage]
        made += [nodes.paragraph("", " ".join(text.split())) for text in told.paragraphs]
        for panel, options in told.panels.items():
            made += [nodes.rubric("", panel), _listed(options)]
        return made


def _listed(options: list[tuple[str, str]]) -> nodes.definition_list:
    entries = [
        nodes.definition_list_item(
            "",
            nodes.term("", "", nodes.literal("", typed)),
            nodes.definition("", nodes.paragraph("", meaning)),
        )
        for typed, meaning in options
    ]
    return nodes.definition_list("", *entries, classes=["command-options"])


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the directive."""
    app.add_directive("command", Command)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
