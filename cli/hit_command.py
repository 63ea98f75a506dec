"""`hitjoints hit`: from a wish in a file to a verdict."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from .complaints import complain
from .figure_options import FigureOptions
from .impact_options import ImpactOptions, inertia_rows
from .option_groups import without
from .options import JsonOption
from .output_options import tell_written
from .render import plain, print_json, print_table

if TYPE_CHECKING:
    from hitjoints.answers.answer import Answer
    from hitjoints.hit import Hit

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

[impact]                            # the inertia that the arm shows, see docs/impact.md
model = "rigid"                     # the links alone; or rotor, composite, elastic
# contact_time = 0.01               # s, elastic
# stiffness = 10000.0               # N m/rad, elastic, of all joints or of each
# rotor_inertia = 0.5               # kg m^2, reflected, of all joints or of each
"""


FILES = ("hit.toml", "plan.json", "trajectory.csv", "trajectory.json", "answer.json", "hit.png")


def hit(
    impact: Annotated[ImpactOptions, without("restitution")],
    file: Annotated[Path | None, typer.Argument(metavar="[FILE]", help="hit.toml to read.")] = None,
    new: Annotated[
        Path | None, typer.Option("--new", metavar="FILE", help="Write a commented hit.toml.")
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option("--out", metavar="DIR", help="Write the plan, the motion, a picture there."),
    ] = None,
    tolerance: Annotated[
        float, typer.Option("--tolerance", metavar="M", help="Around the goal.")
    ] = 0.05,
    *,
    look: Annotated[FigureOptions, without("plot")],
    as_json: JsonOption = False,
) -> None:
    """Take a wish to its verdict: the joint, a motion that can be sent, where the object ends.

    Without a FILE the wish of a new hit.toml is taken.
    """
    from hitjoints.answers.answer import answer
    from hitjoints.hit_loading import load_hit

    if new is not None:
        _write_new(new)
        if as_json:
            print_json({"hit": load_hit(new).as_dict(), "files": [str(new)]})
        return
    if out is not None:
        _check_folder(out, file)
    wanted = load_hit(file) if file is not None else _usual()
    wanted = wanted.changed(setting=replace(wanted.setting, **impact.setting()))
    found = answer(wanted, tolerance=tolerance)
    files = [] if out is None else _write(found, out, look)
    if as_json:
        print_json(found.as_dict() | {"files": [str(path) for path in files]})
    else:
        _print(found)
    tell_written(*files)
    if found.swing is None:
        raise typer.Exit(3)


def _write_new(path: Path) -> None:
    from hitjoints.datasets.files import check_writable, write_whole
    from hitjoints.errors import InputError

    check_writable(path, "new", (".toml",))
    if path.exists():
        raise InputError("new", path, "it is there already, and is not overwritten")
    write_whole(path, "new", lambda made: made.write_text(NEW, encoding="utf-8"))
    complain("written", str(path))


def _usual() -> Hit:
    """Return the hit of a new file."""
    import tempfile

    from hitjoints.hit_loading import load_hit

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "hit.toml"
        path.write_text(NEW, encoding="utf-8")
        return load_hit(path)


def _check_folder(out: Path, file: Path | None) -> None:
    """Refuse a folder that cannot be written to, before any work is done for it."""
    from hitjoints.errors import InputError

    if out.exists() and not out.is_dir():
        raise InputError("out", out, "a folder is needed; this is a file")
    if not out.parent.is_dir():
        raise InputError("out", out, f"there is no folder {out.parent}")
    if file is not None and out.exists() and file.resolve() == (out / FILES[0]).resolve():
        raise InputError("out", out, "the file that is read would be overwritten")


def _write(found: Answer, out: Path, look: FigureOptions) -> list[Path]:
    """Write what there is of the answer; return the files."""
    import json

    from hitjoints.datasets.files import write_whole
    from hitjoints.show import figures
    from hitjoints.show.sheet import save_figure

    out.mkdir(exist_ok=True)
    wish, plan, csv, ros, answer, figure = (out / name for name in FILES)
    found.hit.save(wish)
    found.plan.save(plan)
    text = json.dumps(plain(found.as_dict()), allow_nan=False, indent=1) + "\n"
    write_whole(answer, "out", lambda made: made.write_text(text, encoding="utf-8"))
    if found.swing is None:
        return [wish, plan, answer]
    found.swing.save(csv)
    found.swing.save(ros)
    save_figure(figures.answer(found, **look.look), figure)
    return [wish, plan, csv, ros, answer, figure]


def _print(found: Answer) -> None:
    if found.swing is not None:
        swing = found.swing
        rows: list[tuple[object, ...]] = [
            *inertia_rows(swing),
            ("speed", swing.speed, "m/s"),
            ("flux", swing.flux, "m/s"),
            ("impact after", swing.impact_time, "s"),
            ("at rest after", swing.duration, "s"),
            ("clearance", swing.clearance, f"m, {swing.closest}"),
        ]
        joint = swing.hit.chosen_contact.joint
        print_table(
            f"{found.robot.title}: joint {joint} hits {swing.hit.words}",
            ("hit", "value", "unit"),
            rows,
        )
    print(found.words)
