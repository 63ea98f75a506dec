"""`hitjoints view`: the arm, a hit and its motion in the browser."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

import typer

from .complaints import complain
from .hit_options import HitOptions
from .option_groups import OptionGroup, without
from .options import ConfigurationOption, JsonOption, check_outputs, numbers
from .render import print_json
from .robot_options import RobotOptions
from .start_options import StartOptions

if TYPE_CHECKING:
    from hitjoints.model.robot import Robot
    from hitjoints.show.viewer.clip import Clip
    from hitjoints.show.viewer.live import Viewer


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
    shown: Annotated[
        Path | None,
        typer.Argument(
            metavar="[FILE]",
            help="hit.toml, plan.json, trajectory, rollout or recorded hit to show.",
        ),
    ] = None,
    *,
    robot: RobotOptions,
    hit: HitOptions,
    start: Annotated[StartOptions, without("q0", "start", "torque_limits", "seed")],
    output: ServeOptions,
    q: ConfigurationOption = None,
) -> None:
    """Show an arm in the browser, or on a page: plan, play, and see where the box goes.

    A hit.toml is planned first; what was planned or made before is shown as it is. --out writes a
    page that plays the motion without a server.
    """
    from hitjoints.datasets.files import write_whole
    from hitjoints.show.viewer.making import planned as plan_for
    from hitjoints.show.viewer.open_viewer import open_stage
    from hitjoints.show.viewer.shown_file import read_shown
    from hitjoints.show.viewer.solids import why_bars

    held = None if shown is None else read_shown(shown)
    if held is not None and held.clip is None:
        if held.plan is None:
            hit = replace(hit, file=shown)
        else:
            start = replace(start, plan=shown)
    planned, out = start.planned(), output.out
    asked = hit.read(planned)
    check_outputs(None, (out, "out", (".html",)), inputs=[robot.robot, start.plan, hit.file, shown])
    arm = robot.load()
    if (fault := why_bars(arm)) is not None:
        link, reason = fault
        complain("warning", f"drawn with bars: a collision shape of {link}: {reason}")
    clip = None if held is None or held.clip is None else held.clip(arm)
    if clip is not None:
        _check_motion(arm, hit, clip)
        wanted, contacts = clip.hit, None
    else:
        several = asked.joints is not None and len(asked.joints) > 1
        contacts = asked.contacts(arm) if several else None
        contact = contacts[0] if contacts else asked.contact(arm)
        wanted = asked.flux_hit(arm) if asked.base is None else asked.hit(contact)
    if planned is not None:
        start.arguments(planned, wanted, arm)
    elif asked.base is not None:
        planned = plan_for(arm, wanted, contacts or arm.usual_contacts)
    viewer = open_stage(
        arm,
        wanted,
        None if q is None else numbers(q),
        contacts=contacts,
        plan=planned,
        clip=clip,
        host=output.host,
        port=output.port,
    )
    try:
        if out is None:
            viewer.serve(lambda url: _say(viewer, robot.robot, url, output.as_json))
            return
        if clip is None and viewer.stage.candidate is not None and q is None:
            _make(viewer)
        page = viewer.as_html()
        write_whole(out, "out", lambda path: path.write_text(page, encoding="utf-8"))
        if output.as_json:
            print_json(_told(viewer, robot.robot))
        complain("written", str(out))
    finally:
        viewer.stop()


def _check_motion(arm: Robot, hit: HitOptions, clip: Clip) -> None:
    """Refuse to be asked for what the motion does not do.

    Raises:
        InputError: an option contradicts it.
    """
    import numpy as np

    from hitjoints.errors import InputError

    asked = hit.read()
    for name, typed, value, made in (
        ("object", hit.position, asked.position, clip.hit.position),
        ("direction", hit.direction, asked.direction, clip.hit.direction),
        ("mass", hit.mass, asked.mass, clip.hit.mass),
        ("joint", hit.joint, asked.joints, clip.hit.chosen_contact.joint),
    ):
        if typed is not None and not np.allclose(np.asarray(value, float), made, rtol=0, atol=1e-9):
            words = ",".join(f"{number:g}" for number in np.atleast_1d(made))
            raise InputError(name, typed, f"the {clip.kind} is of {words}")


def _make(viewer: Viewer) -> None:
    """Make the motion that the page is to play; without one it shows the plan."""
    from hitjoints.errors import HitjointsError

    try:
        viewer.make()
    except HitjointsError as error:
        complain("note", f"the page has no motion to play: {error}")


def _told(viewer: Viewer, robot: str) -> dict[str, Any]:
    """Return what JSON says of it."""
    stage, clip = viewer.stage, viewer.stage.clip
    motion = clip and {
        "kind": clip.kind,
        "duration": clip.duration,
        "impact_time": clip.impact_time,
        "speed": clip.speed,
    }
    return {
        "robot": robot,
        "url": viewer.url,
        "joint": stage.contact.joint,
        "q": stage.q if stage.candidate is None else stage.candidate.q,
        "candidates": [one.as_dict() for one in stage.candidates],
        "motion": motion,
    }


def _say(viewer: Viewer, robot: str, url: str, as_json: bool) -> None:
    if as_json:
        print_json(_told(viewer, robot))
    complain("serving", f"{url} until Ctrl-C")
