"""`hitjoints simulate`: a planned hit in a physics engine, predicted against simulated."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

import typer

from .hit_options import HitOptions
from .impact_options import RotorOption, StiffnessOption, of_joints
from .option_groups import OptionGroup, without
from .options import check_outputs, triple
from .output_options import OutputOptions
from .render import print_json, print_table
from .robot_options import RobotOptions
from .start_options import StartOptions

if TYPE_CHECKING:
    from hitjoints.evidence.physics.simulated_hit import Cause, Simulation
    from hitjoints.hit import Hit
    from hitjoints.model.robot import Robot
    from hitjoints.swings.swing_record import Swing

SHOWN = {
    "servo": "{:g} N m s/rad",
    "contact time": "{:g} s",
    "contact friction": "{:g}",
    "off-centre": "{:g} m",
    "turned box": "{:g} rad",
    "height": "{:g} m",
    "table": "box stands on it",
    "elastic joints": "{:g} N m/rad",
}
"""How the value of each cause is printed."""
DEGREES = 180 / math.pi


@dataclass(frozen=True)
class SettingOptions(OptionGroup):
    """What the box is, and what is not as the model has it."""

    panel: ClassVar[str] = "The engine"

    restitution: Annotated[
        float | None,
        typer.Option("--restitution", help="Of arm and object, from 0 to 1. (default: 0.5)"),
    ] = None
    realistic: Annotated[
        bool,
        typer.Option(
            "--realistic/--ideal",
            help="A servo, friction, off centre, a long contact; or none of that.",
        ),
    ] = False
    size: Annotated[
        str | None,
        typer.Option(
            "--size",
            metavar="X,Y,Z",
            help="Box along the hit face's normal, sideways, up (m). (default: 0.1,0.1,0.1)",
        ),
    ] = None
    yaw: Annotated[
        float | None,
        typer.Option("--yaw", metavar="RAD", help="Of the box, to the left. (default: 0)"),
    ] = None
    friction: Annotated[
        float | None, typer.Option("--friction", help="Between box and table. (default: 0.3)")
    ] = None
    support: Annotated[
        str | None,
        typer.Option("--support", metavar="face|corners", help="What carries the box."),
    ] = None
    contact_time: Annotated[
        float | None,
        typer.Option("--contact-time", metavar="S", help="(default: 0.0001; realistic: 0.01)"),
    ] = None
    servo_gain: Annotated[
        float | None,
        typer.Option(
            "--servo-gain", metavar="N M S/RAD", help="Of the joints. (default: 0; realistic: 50)"
        ),
    ] = None
    contact_friction: Annotated[
        float | None,
        typer.Option(
            "--contact-friction", help="Between arm and box. (default: 0; realistic: 0.3)"
        ),
    ] = None
    off_centre: Annotated[
        float | None,
        typer.Option(
            "--off-centre", metavar="M", help="Of the contact. (default: 0; realistic: 0.02)"
        ),
    ] = None

    height: Annotated[
        float | None,
        typer.Option(
            "--height", metavar="M", help="Of the contact above the box's centre. (default: 0)"
        ),
    ] = None
    elastic: Annotated[
        bool | None,
        typer.Option(
            "--elastic/--no-elastic",
            help="Motors on springs; then a contact lasts 0.01 s. "
            "(default: if the hit reckons with them)",
        ),
    ] = None
    stiffness: StiffnessOption = None
    rotor_inertia: RotorOption = None

    @property
    def edges(self) -> tuple[float, float, float] | None:
        """The box's, (3,) m, if they were given.

        Raises:
            InputError: not three numbers.
        """
        return None if self.size is None else triple(self.size, "size")

    def told(self) -> dict[str, float]:
        """Return what a goal needs to know of the box: what is given, or else usual."""
        from hitjoints.evidence.physics.setting import EngineSetting

        given = {"restitution": self.restitution, "friction": self.friction}
        return {
            name: getattr(EngineSetting, name) if value is None else value
            for name, value in given.items()
        }

    def arguments(self) -> dict[str, Any]:
        """Return the arguments of `simulate` for its setting.

        Raises:
            InputError: a value cannot be used.
        """
        given = asdict(self)
        realistic = given.pop("realistic")
        mode = "realistic" if realistic else "ideal"
        joints = {name: of_joints(given[name]) for name in ("stiffness", "rotor_inertia")}
        return given | joints | {"mode": mode, "size": self.edges}


@dataclass(frozen=True)
class MovingOutputs(OutputOptions):
    """As for a motion, and a moving picture."""

    animate: Annotated[
        Path | None, typer.Option("--animate", metavar="FILE", help="Draw the hit moving: .gif.")
    ] = None

    def check(self, *inputs: str | Path | None) -> None:
        """Refuse paths before any work is done for them; `inputs` are read, not written.

        Raises:
            InputError: one cannot be written.
        """
        from hitjoints.show.animation import ANIMATION_ENDINGS

        super().check(*inputs)
        check_outputs(None, (self.animate, "animate", ANIMATION_ENDINGS), inputs=inputs)


def simulate(
    robot: RobotOptions,
    hit: Annotated[HitOptions, without("restitution", "friction")],
    start: StartOptions,
    how: SettingOptions,
    output: MovingOutputs,
    swing: Annotated[
        bool, typer.Option("--swing", help="Follow a swing that can be sent, not a rollout.")
    ] = False,
) -> None:
    """Simulate a planned hit in a physics engine (MuJoCo) and compare it with the prediction.

    The arm follows a rollout or a swing up to the impact and hits a box, which slides on a table
    until it stops. An ideal hit must agree; a realistic one shows how far the model is off, and
    why.
    """
    from hitjoints.evidence.physics.simulation import simulate as run
    from hitjoints.show import figures

    output.check(robot.robot, start.plan, hit.file)
    planned = start.planned()
    asked = hit.read(planned, **how.told())
    arm = robot.load()
    wanted = asked.flux_hit(arm)
    given = start.arguments(planned, wanted, arm)
    if swing:
        sized = wanted if how.edges is None else wanted.changed(size=how.edges)
        result = run(_swing(arm, sized, given), **how.arguments())
    else:
        result = run(arm, wanted, **how.arguments(), **given)
    _write(result, output.out, output.animate)
    output.save(figures.simulation, result)
    if output.as_json:
        said = {"robot": robot.robot, "joint": result.impact.contact.joint, "flux": wanted.flux}
        print_json(said | result.as_dict())
    else:
        _print(result)
    output.tell(output.animate)


def _swing(arm: Robot, hit: Hit, given: dict[str, Any]) -> Swing:
    """Return the swing to follow.

    Raises:
        InputError: a start that a swing does not have.
    """
    from hitjoints.errors import InputError
    from hitjoints.swings.make_swing import swing

    if given["start"] is not None:
        raise InputError("start", "given", "a swing starts in a configuration: give --q0")
    return swing(arm, hit, q0=given["q0"], q_hit=given["q_hit"], seed=given["seed"])


def _write(result: Simulation, out: Path | None, animate: Path | None) -> None:
    if out is not None:
        from hitjoints.datasets.files import write_dataset
        from hitjoints.rollouts.record import flattened

        dataset = result.dataset
        if out.suffix == ".csv":  # a table has one time: that of the contact
            dataset = flattened(dataset.drop_dims("slide_time", errors="ignore"))
        write_dataset(dataset, out)
    if animate is not None:
        from hitjoints.show.animation import save_animation

        save_animation(result, animate)


def _print(result: Simulation) -> None:
    told, found, errors, hit = result.predicted, result.strike, result.errors, result.motion.hit
    robot, joint, how = result.motion.robot, result.impact.contact.joint, result.setting
    rows = [
        ("object speed", told.object_speed, found.object_speed, errors["object_speed"], "m/s"),
        ("rebound", told.rebound, found.rebound, errors["rebound"], "m/s"),
        ("inertia", told.inertia, found.inertia, errors["inertia"], "kg"),
        ("restitution", how.restitution, found.restitution, None, ""),
        ("contact time", 1e3 * how.contact_time, 1e3 * found.contact_time, None, "ms"),
        ("travel", told.travel, result.travel, errors["travel"], "m"),
    ]
    print_table(
        f"{robot.title}: joint {joint} hits {hit.words} with {told.speed:.4g} m/s, {result.mode}",
        ("", "predicted", "simulated", "off by", "unit"),
        [(*row[:3], _percent(row[3]), row[4]) for row in rows],
        caption="simulated inertia: by the balance of momentum",
    )
    _print_rest(result)
    if result.elastic is not None and result.elastic_errors is not None:
        off, elastic = result.elastic_errors, result.elastic
        robot_speed = told.speed + found.rebound
        print_table(
            "Elastic joints, in closed form",
            ("", "predicted", "simulated", "off by", "unit"),
            [
                ("object speed", elastic.object_speed, found.object_speed,
                 _percent(off["object_speed"]), "m/s"),
                ("robot speed", elastic.robot_speed, robot_speed,
                 _percent(off["robot_speed"]) + " of the hit's", "m/s"),
                ("inertia shown", elastic.shown, found.inertia, "-", "kg"),
                ("inertia in Eq. 3", elastic.equivalent, None, "-", "kg"),
            ],
        )  # fmt: skip
    if result.causes:
        print_table(
            "How far off each cause brings them, alone, and what is left without it",
            ("cause", "is", "object speed", "without", "rebound", "without", "inertia", "without"),
            [_share(result, cause) for cause in result.causes],
        )


def _print_rest(result: Simulation) -> None:
    """Print where the box ends, and where it should."""
    found, told = result.rest, result.predicted_rest
    if found is None:
        return
    rows: list[tuple[object, ...]] = []
    for name, unit, scale in (
        ("speed", "m/s", 1.0), ("spin", "rad/s", 1.0), ("distance", "m", 1.0),
        ("direction", "degrees", DEGREES), ("yaw", "degrees", DEGREES),
    ):  # fmt: skip
        pair = [None if one is None else scale * getattr(one, name) for one in (told, found)]
        rows.append((name, *pair, unit))
    end = "it fell over" if found.tipped else "at rest"
    at = ", ".join(f"{value:.4g}" for value in found.place)
    miss = "" if told is None else f", {1e3 * found.miss(told):.3g} mm from the predicted place"
    print_table(
        f"The box, {end} at ({at}) m{miss}",
        ("", "predicted", "simulated", "unit"),
        rows,
        caption=f"no prediction: {result.unpredicted}" if told is None else "",
    )


def _share(result: Simulation, cause: Cause) -> tuple[object, ...]:
    alone, without = result.errors_of(cause.alone), result.errors_of(cause.without)
    pairs = [(_percent(alone[name]), _percent(without[name])) for name in alone]
    is_set = SHOWN[cause.name].format(cause.value)
    return cause.name, is_set, *pairs[0], *pairs[1], *pairs[2]


def _percent(share: float | None) -> str:
    return "-" if share is None else f"{100 * share:+.2f} %"
