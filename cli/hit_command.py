"""`hitjoints hit`: a hit in a file."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from .complaints import complain
from .options import JsonOption
from .render import print_json, print_table

NEW = """\
# A hit: which object, where, how heavy, which way, how hard, and with what. It works as it is:
#     hitjoints plan --hit FILE
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
# dt = 0.002                        # s, of motions
# q0 = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]     # where motions start
"""


def hit(
    file: Annotated[Path | None, typer.Argument(metavar="[FILE]", help="hit.toml to read.")] = None,
    new: Annotated[
        Path | None, typer.Option("--new", metavar="FILE", help="Write a commented hit.toml.")
    ] = None,
    as_json: JsonOption = False,
) -> None:
    """Write a hit.toml to begin with, or read one and say what it asks for."""
    from hitjoints.datasets.files import check_writable, write_whole
    from hitjoints.errors import InputError
    from hitjoints.hit_loading import load_hit

    if new is not None:
        check_writable(new, "new", (".toml",))
        if new.exists():
            raise InputError("new", new, "it is there already, and is not overwritten")
        write_whole(new, "new", lambda made: made.write_text(NEW, encoding="utf-8"))
        complain("written", str(new))
    if (file or new) is None:
        raise typer.BadParameter("a FILE to read is needed, or --new FILE to write one")
    asked = load_hit(file or new or "")
    if as_json:
        print_json({"hit": asked.as_dict()})
        return
    tables = {name: table for name, table in asked.as_dict().items() if isinstance(table, dict)}
    rows = [(f"{name}.{key}", str(value)) for name in tables for key, value in tables[name].items()]
    print_table(f"{file or new}: hit {asked.words}", ("what", "is asked for"), rows)
