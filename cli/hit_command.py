"""`hitjoints hit`: from a wish in a file to a verdict."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

import typer

from .complaints import complain
from .figure_options import FigureOptions
from .hit_options import FLUX, HitOptions
from .impact_options import ImpactOptions, inertia_rows
from .kept import output_folder
from .option_groups import OptionGroup, without
from .options import JsonOption
from .output_options import tell_written
from .render import plain, print_json, print_table, say
from .robot_options import RobotOptions

if TYPE_CHECKING:
    from hitjoints.answers.answer_record import Answer
    from hitjoints.evidence.physics.simulated_hit import Simulation
    from hitjoints.swings.swing_record import Swing

NEW = """\
# A hit: which object, where, how heavy, which way, how hard, and with what. It works as it is:
#     hitjoints hit FILE --out DIR
# Lengths in m, masses in kg, angles in rad. What begins with # is left out; paths are relative to
# this file.
schema = 1

[robot]
source = "iiwa14"                   # a name (hitjoints robots list), or the path of a description
# tip = "flange"                    # the link that the arm ends with, if there are several
# base = "base_link"                # the link that it stands on
# lock = { finger_joint = 0.0 }     # joints that are held
# tool = "tool.toml"                # on the flange
# package_dirs = ["."]              # folders of package:// addresses
# xacro_args = { name = "value" }

[contact]
# joints = [5, 6, 7]                # to try, from 1; the robot's hitting joints if left out
offset = [0.0, 0.0, 0.0]            # of the point that touches, in the joint's frame

[object]
position = [0.5, 0.3, 0.5]          # of the point that is hit, in the robot's base frame
mass = 2.0
# size = [0.1, 0.1, 0.1]            # edges of the box: along the direction, across, upwards
# yaw = 0.0                         # how far it is turned about the vertical
# restitution = 0.5                 # of arm and object; a goal and an object speed need it
# friction = 0.3                    # of the object on its table; a goal needs it
# spread = { mass = 0.05, friction = 0.03 }    # standard deviations

[wish]                              # a goal, or a direction with a flux or an object speed
direction = [0.0, 1.0, 0.0]
flux = 0.3                          # m/s, inertia / (inertia + mass) times speed
# object_speed = 0.45               # m/s
# goal = [0.5, 0.8, 0.5]            # where the point that is hit comes to rest

[surroundings]
# object_size = [0.1, 0.1, 0.1]     # seen along the base frame's axes; the box's by itself
# table_height = 0.4
# margin = 0.02                     # clearance to keep

[how]
objective = "inertia"
away = true                         # the links beyond the contact keep behind it (Eq. 14)
torque_limits = false
seed = 0
# dt = 0.001                        # s, of motions
# q0 = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]     # where motions start
# tolerance = 0.05                  # m, how far from the goal counts as there
# hits = 3                          # how many hits a goal may take; 1 if left out

[impact]                            # the inertia that the arm shows, see docs/impact.md
model = "rigid"                     # the links alone; or rotor, composite, elastic
# contact_time = 0.01               # s, elastic
# stiffness = 10000.0               # N m/rad, elastic, of all joints or of each
# rotor_inertia = 0.5               # kg m^2, reflected, of all joints or of each
"""


FILES = ("plan.json", "trajectory.csv", "trajectory.json", "hit.png")
"""Of each hit, in the folder; of a sequence each in a folder of its own."""
WISH, ANSWER = "hit.toml", "answer.json"


@dataclass(frozen=True)
class AnswerOptions(OptionGroup):
    """How it is answered, and where the answer goes."""

    panel: ClassVar[str] = "The answer"

    hits: Annotated[
        int, typer.Option("--hits", metavar="N", help="How many hits a goal may take.")
    ] = 1
    objective: Annotated[
        str,
        typer.Option(
            "--objective",
            help="landing: the joint whose object most surely arrives; else the one that delivers "
            "most.",
        ),
    ] = "deliverable"
    tolerance: Annotated[
        float, typer.Option("--tolerance", metavar="M", help="Around the goal.")
    ] = 0.05
    simulate: Annotated[
        bool | None,
        typer.Option(
            "--simulate/--no-simulate",
            help="Look at the motion in the physics engine. (default: if it is installed)",
        ),
    ] = None
    new: Annotated[
        Path | None, typer.Option("--new", metavar="FILE", help="Write a commented hit.toml.")
    ] = None
    out: Annotated[
        Path | None,
        typer.Option("--out", metavar="DIR", help="Write the plan, the motion, a picture there."),
    ] = None
    as_json: JsonOption = False


def hit(
    robot: RobotOptions,
    hit: Annotated[HitOptions, without("file")],
    impact: Annotated[ImpactOptions, without("restitution")],
    how: AnswerOptions,
    look: Annotated[FigureOptions, without("plot")],
    file: Annotated[Path | None, typer.Argument(metavar="[FILE]", help="hit.toml to read.")] = None,
) -> None:
    """Take a wish to its verdict: the joint, a motion that can be sent, where the object ends.

    The wish is that of FILE; what is typed goes before it.
    """
    from hitjoints.answers.answer import answer
    from hitjoints.hit_loading import load_hit

    if how.new is not None:
        _write_new(how.new)
        if how.as_json:
            print_json({"hit": load_hit(how.new).as_dict(), "files": [str(how.new)]})
        return
    look.check_look(drawn=how.out is not None)
    if how.out is not None:
        _check_folder(how.out, file)
    asked = replace(hit, file=file).read()
    arm = robot.load()
    names = ("hits", "objective", "tolerance")
    setting = {name: getattr(how, name) for name in names} | {"robot": robot.choice}
    setting |= impact.setting()
    wanted = asked.hit(arm, **setting)
    if file is None and wanted.flux is None:
        wanted = wanted.changed(flux=FLUX)
    found = answer(wanted, arm, simulated=how.simulate)
    files, told = ([], found.as_dict()) if how.out is None else _write(found, how.out, look)
    if how.as_json:
        print_json(told | {"files": [str(path) for path in files]})
    else:
        _print(found)
    tell_written(*files)
    if found.verdict == "no":
        raise typer.Exit(3)


def _write_new(path: Path) -> None:
    from hitjoints.datasets.files import check_writable, write_whole
    from hitjoints.errors import InputError

    check_writable(path, "new", (".toml",))
    if path.exists():
        raise InputError("new", path, "it is there already, and is not overwritten")
    write_whole(path, "new", lambda made: made.write_text(NEW, encoding="utf-8"))
    complain("written", str(path))


def _check_folder(out: Path, file: Path | None) -> None:
    """Refuse a folder that cannot be written to, before any work is done for it."""
    from hitjoints.errors import InputError

    if out.exists() and not out.is_dir():
        raise InputError("out", out, "a folder is needed; this is a file")
    if not out.parent.is_dir():
        raise InputError("out", out, f"there is no folder {out.parent}")
    if file is not None and out.exists() and file.resolve() == (out / WISH).resolve():
        raise InputError("out", out, "the file that is read would be overwritten")


def _write(found: Answer, out: Path, look: FigureOptions) -> tuple[list[Path], dict[str, Any]]:
    """Write what there is of the answer; return the files, and the answer as JSON."""
    import json

    from hitjoints.datasets.files import write_whole

    with output_folder(out):
        parts = found.hits or (found,)
        folders = [out] if len(parts) == 1 else [out / f"hit_{k + 1}" for k in range(len(parts))]
        written = [
            _write_hit(one, folder, look) for one, folder in zip(parts, folders, strict=True)
        ]
        told: dict[str, Any] = plain(found.as_dict(*(paths[1:3] for paths in written)))
        found.hit.save(out / WISH)
        text = json.dumps(told, allow_nan=False, indent=1) + "\n"
        write_whole(out / ANSWER, "out", lambda made: made.write_text(text, encoding="utf-8"))
        return [out / WISH, *(path for paths in written for path in paths), out / ANSWER], told


def _write_hit(one: Answer, folder: Path, look: FigureOptions) -> list[Path]:
    """Write plan, motion and picture of one hit; of a no, the plan."""
    from hitjoints.show import figures
    from hitjoints.show.sheet import save_figure

    with output_folder(folder):
        plan, csv, ros, figure = (folder / name for name in FILES)
        one.plan.save(plan)
        if one.swing is None:
            return [plan]
        one.swing.save(csv)
        one.swing.save(ros)
        save_figure(figures.answer(one, **look.look), figure)
        return [plan, csv, ros, figure]


def _print(found: Answer) -> None:
    for one in found.hits or (found,):
        if one.swing is not None:
            _print_hit(found.robot.title, one.swing)
        if one.simulated is not None:
            speed, off = _seen(one.simulated)
            say(f"physics engine: object speed {speed:.4g} m/s ({100 * off:+.2f} %)")
    say(found.words)


def _seen(simulated: Simulation) -> tuple[float, float]:
    """Return the object's speed in the engine, and how far it is off: a box's by the law of boxes.

    A box that is turned, or hit off its centre, leaves slower than Eq. 3 says of its mass.
    """
    told, found = simulated.predicted_rest, simulated.rest
    if told is None or found is None:
        speed, off = (part["object_speed"] for part in (simulated.simulated, simulated.errors))
        return speed or 0.0, off or 0.0
    return found.speed, found.speed / told.speed - 1


def _print_hit(title: str, swing: Swing) -> None:
    rows: list[tuple[object, ...]] = [
        *inertia_rows(swing),
        ("speed", swing.speed, "m/s"),
        ("flux", swing.flux, "m/s"),
        ("impact after", swing.impact_time, "s"),
        ("at rest after", swing.duration, "s"),
        ("clearance", swing.clearance, f"m, {swing.closest}"),
    ]
    joint = swing.hit.chosen_contact.joint
    print_table(f"{title}: joint {joint} hits {swing.hit.words}", ("hit", "value", "unit"), rows)
