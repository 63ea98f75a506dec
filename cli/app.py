"""The Typer application: every command under its name."""

from __future__ import annotations

from typing import Annotated

import typer

from hitjoints.version import __version__

from . import inspect, plan, replay, reproduce, robots, rollout, simulate, sweep, view

app = typer.Typer(
    help="Hit objects with different joints of a robot arm: inertia, speed and flux.",
    no_args_is_help=False,
    invoke_without_command=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode="rich",
)
app.command("inspect")(inspect.inspect)
app.add_typer(sweep.app, name="sweep")
app.command("plan")(plan.plan)
app.command("rollout")(rollout.rollout)
app.command("simulate")(simulate.simulate)
app.command("replay")(replay.replay)
app.command("reproduce")(reproduce.reproduce)
app.command("view")(view.view)
app.add_typer(robots.app, name="robots")


@app.callback()
def root(
    context: typer.Context,
    version: Annotated[bool, typer.Option("--version", help="Print the version.")] = False,
) -> None:
    """Hit objects with different joints of a robot arm: inertia, speed and flux."""
    if version:
        print(f"hitjoints {__version__}")
    elif context.invoked_subcommand is None:
        print(context.get_help())
