"""The Typer application: every command under its name."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, Any

import typer

from hitjoints.version import __version__

from . import (
    calibrate,
    export,
    hit_command,
    inspect,
    plan,
    replay,
    reproduce,
    robots,
    rollout,
    simulate,
    sweep,
    swing,
    view,
)
from .hit_sources import told
from .option_groups import TellingOptions, grouped, show_help

COMMANDS: dict[str, Callable[..., Any]] = {
    "hit": hit_command.hit,
    "plan": plan.plan,
    "rollout": rollout.rollout,
    "swing": swing.swing,
    "simulate": simulate.simulate,
    "replay": replay.replay,
    "calibrate": calibrate.calibrate,
    "reproduce": reproduce.reproduce,
    "view": view.view,
}
app = typer.Typer(
    help="Hit objects with different joints of a robot arm: inertia, speed and flux.",
    no_args_is_help=False,
    invoke_without_command=True,
    pretty_exceptions_enable=False,
    rich_markup_mode="rich",
    context_settings={"help_option_names": ["-h", "--help"]},
)
app.command("inspect")(grouped(inspect.inspect, told))
app.add_typer(sweep.app, name="sweep")
for name, command in COMMANDS.items():
    app.command(name)(grouped(command, told))
app.add_typer(export.app, name="export")
app.add_typer(robots.app, name="robots")


@app.callback()
def root(
    context: typer.Context,
    version: Annotated[bool, typer.Option("--version", help="Print the versions.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="No notes and no progress.")] = False,
    verbose: Annotated[bool, typer.Option("--verbose", "-v", help="Tell more on stderr.")] = False,
) -> None:
    """Hit objects with different joints of a robot arm: inertia, speed and flux."""
    TellingOptions(quiet, verbose).heed()
    if version:
        print(f"hitjoints {__version__} ({', '.join(_libraries())})")
    else:
        show_help(context)


def _libraries() -> list[str]:
    """Return the versions of what the numbers depend on."""
    from importlib.metadata import version

    return [f"{name} {version(name)}" for name in ("pin", "proxsuite", "numpy")]
