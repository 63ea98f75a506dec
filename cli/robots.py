"""`hitjoints robots`: which arms there are, and whether a description can be trusted."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from .complaints import complain
from .option_groups import grouped, show_help, without
from .options import JsonOption
from .render import print_json, print_table, say
from .robot_options import ROBOT, RobotOptions

if TYPE_CHECKING:
    from hitjoints.loading.check import Issue

app = typer.Typer(help="List the robots, or check one.")


@app.callback(invoke_without_command=True)
def root(context: typer.Context) -> None:
    """List the robots that have names, or check the description of one."""
    show_help(context)


def list_robots(as_json: JsonOption = False) -> None:
    """List the robots that are known by name, with where their arms end and their sources."""
    from hitjoints.loading.catalogue import robot_names
    from hitjoints.loading.load import read_robot

    rows = []
    for name in robot_names():
        _, arm, robot = read_robot(name)
        rows.append(
            {
                "name": name,
                "title": robot.title,
                "joints": robot.n,
                "tip": arm.tip,
                "hitting_joints": robot.hitting_joints,
                "home": robot.home,
                "licence": robot.licence,
                "source": robot.source,
            }
        )
    if as_json:
        print_json({"robots": rows})
        return
    columns = ("name", "title", "joints", "tip", "hitting_joints")
    print_table(
        "Robots that come with hitjoints",
        [column.replace("_", " ") for column in columns],
        [[row[column] for column in columns] for row in rows],
        caption="--robot also takes a URDF or TOML file, or a name from example-robot-data",
    )


def check(
    options: Annotated[RobotOptions, without("robot")],
    robot: Annotated[str, typer.Argument(metavar="NAME|FILE", help="The robot.")] = ROBOT,
    strict: Annotated[
        bool, typer.Option("--strict", help="Leave with exit code 3 when there is an error.")
    ] = False,
    as_json: JsonOption = False,
) -> None:
    """Check the inertias and limits of a robot description, and say what a fault does."""
    from hitjoints.errors import ModelError
    from hitjoints.loading.check import Issue, check_arm, check_shapes
    from hitjoints.loading.load import read_robot

    try:
        description, arm, built = read_robot(robot, **options.chosen)
        issues = check_arm(arm, built) + check_shapes(built)
    except ModelError as error:
        _print_issues(robot, [Issue("error", "", error.reason, "it cannot be loaded")], as_json)
        raise
    _print_issues(description.name, issues, as_json)
    if strict and any(issue.severity == "error" for issue in issues):
        complain("no", f"{description.name} has inertias that cannot be trusted")
        raise typer.Exit(3)


app.command("list")(grouped(list_robots))
app.command("check")(grouped(check))


def _print_issues(name: str, issues: list[Issue], as_json: bool) -> None:
    rows = [issue.as_dict() for issue in issues]
    if as_json:
        print_json({"robot": name, "issues": rows})
    elif rows:
        print_table(name, list(rows[0]), [list(row.values()) for row in rows])
    else:
        say(f"{name}: no issues")
