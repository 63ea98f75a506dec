"""The Typer application, and the exit codes.

0 done; 1 the input or the run failed; 2 wrong usage; 3 the question was understood and the
answer is no.
"""

from __future__ import annotations

import sys
import warnings
from collections.abc import Sequence
from typing import Annotated, Any

import typer

from hitjoints.errors import HitjointsError, InfeasibleError
from hitjoints.version import __version__

from . import inspect, plan, replay, reproduce, robots, rollout, simulate, sweep, view
from .render import complain, print_json

DONE, FAILED, USAGE, NO = 0, 1, 2, 3
UsageError: Any = typer.BadParameter.__base__

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


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command line and leave with its exit code."""
    words = list(sys.argv[1:] if arguments is None else arguments)
    warnings.showwarning = lambda message, *_, **__: complain("warning", str(message))
    sys.exit(_run(words))


def _run(words: list[str]) -> int:
    try:
        return app(args=words, prog_name="hitjoints", standalone_mode=False) or DONE
    except InfeasibleError as error:
        if "--json" in words:
            print_json({"feasible": False, "reason": error.reason, **error.data})
        complain("no", str(error))
        return NO
    except HitjointsError as error:
        complain("error", str(error))
        return FAILED
    except UsageError as error:
        complain("usage", error.format_message())
        return USAGE
    except (KeyboardInterrupt, typer.Abort):
        complain("error", "interrupted")
        return FAILED
    except BrokenPipeError:
        # The reader of a pipe has seen enough; nothing is left to be said to it.
        sys.stdout = None
        return DONE
