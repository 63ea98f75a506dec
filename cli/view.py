"""`hitjoints view`: the arm in the browser."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from .asked import FLUX, FluxOption
from .complaints import complain
from .options import (
    DIRECTION,
    MASS,
    OBJECT,
    ORIGIN,
    ROBOT,
    ConfigurationOption,
    DirectionOption,
    JointOption,
    JsonOption,
    MassOption,
    ObjectOption,
    OffsetOption,
    RobotOption,
    check_mass,
    check_outputs,
    numbers,
    triple,
)
from .render import print_json


def view(
    robot: RobotOption = ROBOT,
    joint: JointOption = None,
    offset: OffsetOption = ORIGIN,
    q: ConfigurationOption = None,
    position: ObjectOption = OBJECT,
    direction: DirectionOption = DIRECTION,
    mass: MassOption = MASS,
    flux: FluxOption = FLUX,
    host: Annotated[str, typer.Option("--host", help="Address to serve on.")] = "127.0.0.1",
    port: Annotated[
        int, typer.Option("--port", help="Port to serve on; the next free one if it is taken.")
    ] = 8080,
    out: Annotated[
        Path | None,
        typer.Option("--out", metavar="FILE", help="Write a page, .html, instead of serving."),
    ] = None,
    as_json: JsonOption = False,
) -> None:
    """Show the arm in the browser: sliders, inertia at the contact, plans and hits."""
    from hitjoints.datasets.files import write_whole
    from hitjoints.loading.load import load_robot
    from hitjoints.model.robot import Contact
    from hitjoints.show.viewer import view as show

    check_mass(mass)
    check_outputs(None, (out, "out", (".html",)), inputs=[robot])
    arm = load_robot(robot)
    chosen = arm.usual_joint if joint is None else joint
    viewer = show(
        arm,
        None if q is None else numbers(q),
        Contact(chosen, triple(offset, "offset")),
        position=triple(position, "object"),
        direction=triple(direction, "direction"),
        mass=mass,
        flux=flux,
        host=host,
        port=port,
    )
    try:
        shown = {"robot": robot, "url": viewer.url, "joint": chosen, "q": viewer.q}

        def say(url: str) -> None:
            if as_json:
                print_json(shown)
            complain("serving", f"{url} until Ctrl-C")

        if out is None:
            viewer.serve(say)
        else:
            if as_json:
                print_json(shown)
            page = viewer.as_html()
            write_whole(out, "out", lambda path: path.write_text(page, encoding="utf-8"))
            complain("written", str(out))
    finally:
        viewer.stop()
