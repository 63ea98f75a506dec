"""`hitjoints sweep mass`: which joint hits best from which mass of the object on."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import typer

from .hit_options import HitOptions
from .option_groups import without
from .options import SeedOption, spaced
from .output_options import OutputOptions
from .render import print_json, print_table, say
from .robot_options import RobotOptions

if TYPE_CHECKING:
    from xarray import Dataset

UNUSED = ("mass", "flux", "object_speed", "goal", "restitution", "friction")


def sweep_mass(
    robot: RobotOptions,
    hit: Annotated[HitOptions, without(*UNUSED)],
    output: OutputOptions,
    mass: Annotated[
        str, typer.Option("--mass", metavar="START:STOP:COUNT", help="Masses of the object (kg).")
    ] = "0.5:6:5",
    objective: Annotated[str, typer.Option("--objective", help="flux, or straight-flux.")] = "flux",
    away: Annotated[
        bool, typer.Option("--away/--no-away", help="Demand the away condition of Eq. 14.")
    ] = True,
    seed: SeedOption = 0,
) -> None:
    """Plan with every joint for objects of several masses: which joint wins, and from where on."""
    import hitjoints as hj
    from hitjoints.show import figures

    asked = hit.read()
    output.check(robot.robot, hit.file)
    arm = robot.load()
    swept = hj.sweep_mass(
        arm,
        asked.position,
        asked.direction,
        spaced(mass, "mass"),
        joints=asked.contacts(arm),
        objective=objective,
        away=away,
        seed=seed,
    )
    if output.out is not None:
        from hitjoints.datasets.files import write_dataset

        write_dataset(swept, output.out)
    output.save(figures.mass_sweep, swept)
    crossings = _crossings(swept)
    if output.as_json:
        rows = {str(name): swept[name].values for name in ("joint", "mass", *swept.data_vars)}
        print_json({**swept.attrs, **rows, "crossings": crossings})
    else:
        _print(swept, crossings)
    output.tell()


def _crossings(swept: Dataset) -> list[dict[str, Any]]:
    if "crossing" not in swept.sizes:
        return []
    columns = (swept[f"crossing_{name}"].values for name in ("mass", "before", "after"))
    return [
        {"mass": float(mass), "from": int(before), "to": int(after)}
        for mass, before, after in zip(*columns, strict=True)
    ]


def _print(swept: Dataset, crossings: list[dict[str, Any]]) -> None:
    name = swept.attrs["objective"].replace("-", "_")
    at = ", ".join(f"{v:g}" for v in swept.attrs["position"])
    print_table(
        f"{swept.attrs['robot']}: greatest {name.replace('_', ' ')} (m/s) at ({at}) m",
        ("object (kg)", *(f"joint {k}" for k in swept.joint.values), "best"),
        [
            (f"{float(m):.4g}", *swept[name].sel(mass=m).values, f"joint {int(best)}")
            for m, best in zip(swept.mass.values, swept.best.values, strict=True)
        ],
    )
    for one in crossings:
        say(f"from {one['mass']:.4g} kg on: joint {one['to']}, not joint {one['from']}")
    if not crossings:
        say("the same joint hits best throughout")
