"""`hitjoints replay`: recorded hits beside the model."""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from .complaints import complain
from .figure_options import FigureOptions
from .hit_options import check_mass
from .impact_options import RotorOption, StiffnessOption, of_joints
from .option_groups import without
from .options import JsonOption, OutOption, check_outputs, numbers, triple
from .render import print_json, print_table, say
from .robot_options import RobotOptions

if TYPE_CHECKING:
    from hitjoints.evidence.recordings.replayed_hit import ReplayedHit
    from hitjoints.evidence.recordings.replayer import Replay

SHOWN = 40  # rows of the table


def replay(  # noqa: PLR0913
    files: Annotated[
        list[Path] | None,
        typer.Argument(
            metavar="FILE...",
            help="Robots' files (..._hit_N.csv), or folders. (default: four recorded hits)",
            show_default=False,
        ),
    ] = None,
    robot: Annotated[
        str | None,
        typer.Option(
            "--robot",
            metavar="NAME|FILE",
            help="The arm, with the options below. (default: as the file says)",
        ),
    ] = None,
    *,
    chosen: Annotated[RobotOptions, without("robot")],
    direction: Annotated[
        str | None,
        typer.Option(
            "--direction", metavar="X,Y,Z", help="Hitting direction. (default: as recorded, +y, -y)"
        ),
    ] = None,
    mass: Annotated[
        float | None,
        typer.Option(
            "--mass", metavar="KG", help="Of the object. (default: by the recorded flux, else 0.4)"
        ),
    ] = None,
    offset: Annotated[
        str,
        typer.Option(
            "--offset", metavar="X,Y,Z", help="Point that hits, in the last joint's frame."
        ),
    ] = "0,0,0.15",
    restitution: Annotated[
        float | None,
        typer.Option(
            "--restitution", help="For the prediction. (default: median of the other hits)"
        ),
    ] = None,
    impact: Annotated[
        bool,
        typer.Option("--impact", help="Add what models of the arm's drives say of each hit."),
    ] = False,
    contact_time: Annotated[
        float, typer.Option("--contact-time", metavar="S", help="For them, elastic: how long.")
    ] = 0.02,
    stiffness: StiffnessOption = None,
    rotor_inertia: RotorOption = None,
    out: OutOption = None,
    figure: FigureOptions,
    as_json: JsonOption = False,
) -> None:
    """Compare recorded hits with the model: inertia, flux, speeds, restitution.

    Each robot's file has the object's, object_M_hit_N.csv, beside it. A file that cannot be used
    is reported with its reason, and the rest goes on.
    """
    from hitjoints.counting import tell
    from hitjoints.datasets.files import DATASET_ENDINGS, write_dataset
    from hitjoints.evidence.recordings.hit_files import read_by
    from hitjoints.evidence.recordings.replayer import replay as compare
    from hitjoints.show import figures

    if mass is not None:
        check_mass(mass)
    check_outputs(figure.plot, (out, "out", DATASET_ENDINGS), inputs=[*read_by(files or ()), robot])
    figure.check_look()
    result = compare(
        files or None,
        robot=None if robot is None else replace(chosen, robot=robot).load(),
        direction=None if direction is None else numbers(direction),
        mass=mass,
        offset=triple(offset, "offset"),
        restitution=restitution,
        impact=impact,
        contact_time=contact_time,
        stiffness=of_joints(stiffness),
        rotor_inertia=of_joints(rotor_inertia),
        progress=partial(tell, "files"),
    )
    if out is not None:
        from hitjoints.evidence.recordings.dataset import hits_dataset

        # A table has one line per hit; what is along the motions needs more dimensions.
        write_dataset(hits_dataset(result.hits, along=out.suffix != ".csv"), out)
    figure.save(figures.replay, result)
    if as_json:
        print_json(result.as_dict())
    else:
        _print(result)
    for path in (out, figure.plot):
        if path is not None:
            complain("written", str(path))
    if not result.usable:
        reasons = Counter(hit.reason for hit in result.hits).most_common(1)
        complain("error", f"no file could be used: {reasons[0][0] if reasons else 'none is there'}")
        raise typer.Exit(1)


def _print(result: Replay) -> None:
    from hitjoints.evidence.recordings.replayer import REMARKS

    names = (
        "file", "robot", "mass", "inertia", "(theirs)", "speed", "flux", "(theirs)",
        "object", "predicted", "restitution",
    )  # fmt: skip
    print_table(
        f"{len(result.usable)} of {len(result.hits)} recorded hits could be used",
        names,
        [_row(hit) for hit in result.usable[:SHOWN]],
        caption="kg and m/s; (theirs): the recorder's, of its own model; object: its speed after "
        "the hit; predicted: with the median restitution of the other hits, or as given",
    )
    if len(result.usable) > SHOWN:
        say(f"... and {len(result.usable) - SHOWN} more: --out writes all of them")
    if result.usable[0:1] and result.usable[0].shown_mass is not None:
        _print_impact(result)
    _print_summary(result.usable)
    for name in ("restitution", "recorded_inertia", "momentum_mass"):
        say(f"{name}: {REMARKS[name]}.")
    failed = [hit for hit in result.hits if not hit.ok]
    for hit in failed[:SHOWN]:
        complain("not usable", f"{hit.file}: {hit.reason}")
    if len(failed) > SHOWN:
        complain("not usable", f"{len(failed) - SHOWN} more files")
    for note, count in Counter(hit.reason for hit in result.usable if hit.reason).most_common(5):
        complain("note", f"{count} of {len(result.usable)} files: {note}")


def _row(hit: ReplayedHit) -> list[object]:
    numbers = (
        hit.mass, hit.inertia, hit.recorded_inertia, hit.robot_speed, hit.flux, hit.recorded_flux,
        hit.object_speed, hit.predicted_object_speed, hit.restitution,
    )  # fmt: skip
    cells = ["-" if value is None else f"{value:.3g}" for value in numbers]
    return [Path(hit.file).stem, hit.robot, *cells]


def _print_impact(result: Replay) -> None:
    rows = []
    for hit in result.usable[:SHOWN]:
        told = {} if hit.shown_mass is None else hit.shown_mass.as_dict()
        models = [told.get(name) for name in ("rigid", "rotor", "composite", "elastic")]
        rows.append([Path(hit.file).stem, *models, hit.momentum_mass, hit.unpushed_mass])
    print_table(
        "Inertia (kg) by models of the drives, and by the balance of momentum",
        ("file", "rigid", "rotor", "composite", "elastic", "measured", "less controller"),
        rows,
        caption="less controller: without what the robot's own acceleration did meanwhile",
    )
    fitted = result.stiffness
    if fitted is None:
        say("stiffness: too few hits of arms whose rotor inertia is known")
        return
    bound = "; the hits do not bound it" if fitted.at_edge else ""
    say(
        f"stiffness: {fitted.value:.3g} N m/rad explains {fitted.hits} hits best, "
        f"{fitted.low:.3g} to {fitted.high:.3g} with one left out{bound}; off by a factor of "
        f"{math.exp(fitted.error):.2g} on hits left out"
    )


def _print_summary(hits: tuple[ReplayedHit, ...]) -> None:
    import numpy as np

    def spread(name: str, unit: str) -> None:
        values = [getattr(hit, name) for hit in hits if getattr(hit, name) is not None]
        if values:
            low, middle, high = np.percentile(values, (0, 50, 100))
            say(f"{name}: {low:.3g} .. {high:.3g}{unit}, median {middle:.3g} ({len(values)} hits)")

    spread("position_error", " m")
    spread("velocity_error", " m/s")
    spread("recorded_flux_error", " m/s")
    spread("restitution", "")
    spread("momentum_ratio", " times the inertia")
    spread("friction", "")
    pairs = [(h.predicted_object_speed, h.object_speed) for h in hits]
    off = [abs(a / b - 1) for a, b in pairs if a is not None and b is not None and b > 0]
    if off:
        say(f"predicted object speed: off by {np.median(off):.2g} of the measured, in the median")
