"""`hitjoints view`: the arm in the browser."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, ClassVar

import typer

from .complaints import complain
from .hit_options import HitOptions
from .option_groups import OptionGroup, without
from .options import ConfigurationOption, JsonOption, check_outputs, numbers
from .render import print_json
from .robot_options import RobotOptions
from .start_options import StartOptions


@dataclass(frozen=True)
class ServeOptions(OptionGroup):
    """Where it is served, or written to."""

    panel: ClassVar[str] = "Output"

    host: Annotated[str, typer.Option("--host", help="Address to serve on.")] = "127.0.0.1"
    port: Annotated[
        int, typer.Option("--port", help="Port to serve on; the next free one if it is taken.")
    ] = 8080
    out: Annotated[
        Path | None,
        typer.Option("--out", metavar="FILE", help="Write a page, .html, instead of serving."),
    ] = None
    as_json: JsonOption = False


def view(
    robot: RobotOptions,
    hit: HitOptions,
    start: Annotated[StartOptions, without("q0", "start", "torque_limits", "seed")],
    output: ServeOptions,
    q: ConfigurationOption = None,
) -> None:
    """Show the arm in the browser: sliders, inertia at the contact, plans and hits."""
    from hitjoints.datasets.files import write_whole
    from hitjoints.show.open_viewer import view as show

    planned, out = start.planned(), output.out
    asked = hit.read(planned)
    check_outputs(None, (out, "out", (".html",)), inputs=[robot.robot, start.plan, hit.file])
    arm = robot.load()
    wanted = asked.flux_hit(arm)
    contact, at_hit = wanted.chosen_contact, start.arguments(planned, wanted, arm)["q_hit"]
    for link, reason in arm.shape_faults[:1]:
        complain("warning", f"drawn with bars: a collision shape of {link}: {reason}")
    viewer = show(
        arm,
        at_hit if q is None else numbers(q),
        contact,
        position=wanted.position,
        direction=wanted.direction,
        mass=wanted.mass,
        flux=wanted.desired_flux,
        q_hit=at_hit,
        host=output.host,
        port=output.port,
    )
    shown = {"robot": robot.robot, "url": viewer.url, "joint": contact.joint, "q": viewer.q}

    def say(url: str) -> None:
        if output.as_json:
            print_json(shown)
        complain("serving", f"{url} until Ctrl-C")

    try:
        if out is None:
            viewer.serve(say)
        else:
            page = viewer.as_html()
            write_whole(out, "out", lambda path: path.write_text(page, encoding="utf-8"))
            if output.as_json:
                print_json(shown)
            complain("written", str(out))
    finally:
        viewer.stop()
