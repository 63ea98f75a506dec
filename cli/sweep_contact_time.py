"""`hitjoints sweep contact-time`: what each joint shows in a hit, by how long it lasts."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from .hit_options import HitOptions
from .impact_options import RESTITUTION, RotorOption, StiffnessOption, of_joints
from .option_groups import without
from .options import SeedOption, check_outputs, numbers
from .output_options import OutputOptions
from .render import print_json, print_table, say
from .robot_options import RobotOptions

if TYPE_CHECKING:
    from xarray import Dataset

SHOWN = (1e-3, 5e-3, 1e-2, 2e-2)
"""s, contact times of the table."""
MAPPED = ((-0.9, 0.9, 37), (-0.9, 0.9, 37))
"""m, places of the object along x and y: from, to, count."""


def sweep_contact_time(  # noqa: PLR0913
    robot: RobotOptions,
    hit: Annotated[HitOptions, without("flux", "object_speed", "restitution")],
    output: OutputOptions,
    longest: Annotated[
        float, typer.Option("--longest", metavar="S", help="From 0.0001 s to this.")
    ] = 0.03,
    count: Annotated[int, typer.Option("--count", help="Contact times.")] = 61,
    restitution: Annotated[
        float, typer.Option("--restitution", help="Of arm and object, from 0 to 1.")
    ] = RESTITUTION,
    stiffness: StiffnessOption = None,
    rotor_inertia: RotorOption = None,
    map_plot: Annotated[
        Path | None,
        typer.Option("--map", metavar="FILE", help="Draw which joint shows most, and where."),
    ] = None,
    q: Annotated[
        str | None,
        typer.Option("--q", metavar="Q1,Q2,...", help="Common configuration (rad)."),
    ] = None,
    seed: SeedOption = 0,
) -> None:
    """Hit with each joint and contacts of every length: which one shows how much of the arm."""
    import numpy as np

    from hitjoints.errors import InputError
    from hitjoints.maps.contact_time_sweep import crossings
    from hitjoints.maps.contact_time_sweep import sweep_contact_time as sweep
    from hitjoints.show import figures

    asked = hit.read(restitution=restitution)
    output.check(robot.robot, hit.file)
    check_outputs(map_plot)
    if not (1e-4 < longest <= 1 and count >= 2):
        raise InputError("longest", longest, "a contact time above 0.0001 s, and --count above 1")
    arm = robot.load()
    times = np.unique([*np.geomspace(1e-4, longest, count), *(t for t in SHOWN if t < longest)])
    swept = sweep(
        arm,
        asked.position,
        asked.direction,
        asked.mass,
        times,
        restitution=restitution,
        joints=asked.contacts(arm),
        start=None if q is None else numbers(q),
        stiffness=of_joints(stiffness),
        rotor_inertia=of_joints(rotor_inertia),
        seed=seed,
    )
    if output.out is not None:
        from hitjoints.datasets.files import write_dataset

        write_dataset(swept, output.out)
    output.save(figures.contact_time_sweep, swept)
    if map_plot is not None:
        from hitjoints.maps.winning_joint import winning_joint
        from hitjoints.show.sheet import save_figure

        x, y = MAPPED
        found = winning_joint(
            arm, np.linspace(*x), np.linspace(*y), asked.position[2], asked.direction, asked.mass,
            restitution=restitution, joints=asked.contacts(arm), stiffness=of_joints(stiffness),
            rotor_inertia=of_joints(rotor_inertia), seed=seed,
        )  # fmt: skip
        save_figure(figures.winning_joint(found, **output.look), map_plot, "map")
    meet = [one for name in ("equivalent", "object_speed") for one in crossings(swept, name)]
    if output.as_json:
        joints = [
            {"joint": int(k), **{str(n): swept[n].sel(joint=k).values for n in swept.data_vars}}
            for k in swept.joint.values
        ]
        crossed = [one._asdict() for one in meet]
        print_json({**swept.attrs, "times": times, "joints": joints, "crossings": crossed})
    else:
        _print(swept)
        for one in meet:
            what = "inertia" if one.variable == "equivalent" else "object speed"
            say(f"joints {one.joints[0]} and {one.joints[1]}: equal {what} at {one.time:.3g} s")
    output.tell(map_plot)


def _print(swept: Dataset) -> None:
    spans = [span for span in SHOWN if span in swept.time.values]
    rows: list[list[Any]] = []
    for k in swept.joint.values:
        row = swept.sel(joint=k)
        shown = [float(row.equivalent.sel(time=span)) for span in spans]
        ends = [float(row[name]) for name in ("rigid", "rotor", "composite")]
        rows.append([f"joint {k}", *(value for value in (ends[0], *shown, *ends[1:]))])
    names = ("hit with", "links", *(f"{1e3 * span:g} ms" for span in spans), "rotors", "locked")
    print_table(
        f"{swept.attrs['robot']}: inertia (kg) that a hit shows, by contact time", names, rows
    )
