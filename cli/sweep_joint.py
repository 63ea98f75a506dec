"""`hitjoints sweep joint`: turn each hitting joint at the object (Fig. 2)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import typer

from .hit_options import HitOptions
from .impact_options import RotorOption, of_joints
from .option_groups import without
from .options import SeedOption, numbers
from .output_options import OutputOptions
from .render import print_json, print_table
from .robot_options import RobotOptions

if TYPE_CHECKING:
    from xarray import Dataset


def sweep_joint(
    robot: RobotOptions,
    hit: Annotated[HitOptions, without("flux", "object_speed")],
    output: OutputOptions,
    count: Annotated[int, typer.Option("--count", help="Angles per joint.")] = 181,
    q: Annotated[
        str | None,
        typer.Option("--q", metavar="Q1,Q2,...", help="Common null-space configuration (rad)."),
    ] = None,
    impact: Annotated[
        str, typer.Option("--impact", metavar="MODEL", help="rigid, rotor or composite.")
    ] = "rigid",
    rotor_inertia: RotorOption = None,
    seed: SeedOption = 0,
) -> None:
    """Turn each hitting joint at the object: inertia, speed and flux by its angle (Fig. 2)."""
    import hitjoints as hj
    from hitjoints.show import figures

    asked = hit.read()
    output.check(robot.robot, hit.file)
    arm = robot.load()
    swept = hj.sweep_joint(
        arm,
        asked.position,
        asked.direction,
        asked.mass,
        joints=asked.contacts(arm),
        count=count,
        start=None if q is None else numbers(q),
        impact=impact,  # type: ignore[arg-type]  # refused there when it is none
        rotor_inertia=of_joints(rotor_inertia),
        seed=seed,
    )
    if output.out is not None:
        from hitjoints.datasets.files import write_dataset

        write_dataset(swept, output.out)
    output.save(figures.joint_sweep, swept)
    if output.as_json:
        print_json(_as_json(swept))
    else:
        _print(swept)
    output.tell()


def _as_json(swept: Dataset) -> dict[str, Any]:
    rows = []
    for k in swept.joint.values:
        row = swept.sel(joint=k).drop_vars(("joint", "axis"))
        rows.append({"joint": int(k)} | {str(name): row[name].values for name in row.data_vars})
    return {**swept.attrs, "joints": rows}


def _print(swept: Dataset) -> None:
    def span(row: Any, name: str) -> str:
        low, high = float(row[name].min()), float(row[name].max())
        return f"{low:.3g}" if high - low < 1e-9 * high else f"{low:.3g} .. {high:.3g}"

    rows: list[list[object]] = []
    for k in swept.joint.values:
        row = swept.sel(joint=k)
        if bool(row.reachable):
            names = ("inertia", "speed", "straight_speed", "flux", "straight_flux")
            rows.append([f"joint {k}", *(span(row, name) for name in names)])
        else:
            error = f"out of reach by {float(row.position_error):.3g} m"
            rows.append([f"joint {k}", error, "", "", "", ""])
    at = ", ".join(f"{v:g}" for v in swept.attrs["position"])
    model = "" if swept.attrs["impact"] == "rigid" else f", inertia: {swept.attrs['impact']}"
    print_table(
        f"{swept.attrs['robot']}: each joint placed at ({at}) m and turned over its range{model}",
        ("hit with", "inertia (kg)", "speed (m/s)", "straight", "flux (m/s)", "straight"),
        rows,
        caption=f"object of {swept.attrs['mass']:g} kg; least .. greatest over the joint's angle",
    )
