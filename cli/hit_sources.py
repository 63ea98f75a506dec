"""What a file says for options that were not typed: `--hit hit.toml`, or the hit of a `--plan`."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from hitjoints.hit import Hit

WAYS = ("goal", "flux", "object_speed")
"""Options that say how hard; one that is typed goes before whichever the file says."""


def told(typed: Mapping[str, Any]) -> dict[str, Any]:
    """Return values of options, as they would be typed, from the file that was named.

    Args:
        typed: the options that were typed, by name.

    Raises:
        InputError: the file cannot be used.
        InfeasibleError: the plan says that no joint can do it.
    """
    from hitjoints.errors import InputError

    file, plan, shown = typed.get("file"), typed.get("plan"), typed.get("shown")
    if file is not None and plan is not None:
        raise InputError("hit", file, f"the plan {plan} says which hit already")
    if file is not None:
        from hitjoints.hit_loading import load_hit

        values = options_of(load_hit(file))
    elif plan is not None:
        from hitjoints.planning.plan_file import load_plan

        return options_of(load_plan(plan).chosen_hit)  # what is typed must agree with it
    elif shown is not None:
        return _shown(shown)
    else:
        return {}
    if any(way in typed for way in WAYS):
        values = {name: value for name, value in values.items() if name not in WAYS}
    if "goal" in typed or ("direction" in typed and "goal" in values):
        values = {n: value for n, value in values.items() if n not in ("direction", "goal")}
    return values


def _shown(path: Path) -> dict[str, Any]:
    """Return what the file that `view` is given says."""
    from hitjoints.show.viewer.shown_file import read_shown

    held = read_shown(path)
    if held.plan is not None:
        return options_of(held.plan.chosen_hit)
    values = {} if held.hit is None else options_of(held.hit)
    return ({} if held.robot is None else {"robot": held.robot.source}) | values


def options_of(hit: Hit) -> dict[str, Any]:
    """Return a hit as the options that would say it, by name."""
    given, setting = hit.as_dict(), hit.setting
    said: dict[str, Any] = {}
    for name in ("position", "size", "object_size", "q0", "goal", "direction", "offset"):
        for table in given.values():
            if isinstance(table, dict) and name in table and not isinstance(table[name][0], list):
                said[name] = _typed(table[name])
    for name, value in given.get("limits", {}).items():
        said[name] = _typed(value if isinstance(value, list) else [value])
    if "direction" in said:
        said["direction"] = [said["direction"]]
    wish, thing = given["wish"], given["object"]
    for table, names in (
        (wish, ("flux", "object_speed")),
        (thing, ("mass", "restitution", "friction", "yaw")),
        (vars(setting), ("table_height", "margin", "objective", "away", "torque_limits", "seed")),
        (vars(setting), ("dt", "hits", "tolerance")),
    ):
        said |= {name: table[name] for name in names if table.get(name) is not None}
    if (joints := given.get("contact", {}).get("joints")) is not None:
        said["joint"] = joints
    if setting.robot is not None:
        robot = setting.robot
        said |= {
            "robot": robot.source,
            "tip": robot.tip,
            "tool": None if robot.tool is None else Path(robot.tool),
            "base": robot.base,
            "lock": [f"{name}={value!r}" for name, value in robot.lock.items()] or None,
            "package_dirs": [Path(folder) for folder in robot.package_dirs] or None,
            "xacro_args": [f"{name}:={value}" for name, value in robot.xacro_args.items()] or None,
        }
    return said


def _typed(values: Iterable[float]) -> str:
    """Return numbers as they are typed, to the last digit."""
    return ",".join(repr(float(value)) for value in values)
