"""`hitjoints swing`: a motion from rest to rest that strikes, and that a controller can be sent."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

import typer

from .complaints import complain
from .hit_options import HitOptions
from .impact_options import ImpactOptions, inertia_rows
from .option_groups import OptionGroup, without
from .options import AccelerationOption, check_outputs, for_joints, triple
from .output_options import OutputOptions
from .render import print_json, print_table
from .robot_options import RobotOptions
from .start_options import StartOptions

if TYPE_CHECKING:
    from hitjoints.hit import Hit
    from hitjoints.swings.swing_record import Swing


@dataclass(frozen=True)
class SwingOptions(OptionGroup):
    """What the motion has to keep."""

    panel: ClassVar[str] = "The motion"

    acceleration: AccelerationOption = None
    jerk: Annotated[
        str | None,
        typer.Option(
            "--jerk",
            metavar="J|J1,J2,...",
            help="Jerk limits (rad/s^3). (default: the robot's; not kept if it tells none)",
        ),
    ] = None
    size: Annotated[
        str | None,
        typer.Option(
            "--size",
            metavar="X,Y,Z",
            help="Box along the direction, sideways, up (m). (default: the hit's, or 0.1,0.1,0.1)",
        ),
    ] = None
    table_height: Annotated[
        float | None, typer.Option("--table-height", metavar="M", help="Of a table to stay above.")
    ] = None
    margin: Annotated[
        float, typer.Option("--margin", metavar="M", help="Clearance to everything on the way.")
    ] = 0.005
    fastest: Annotated[
        bool, typer.Option("--fastest", help="As much flux as can be, instead of --flux.")
    ] = False
    dt: Annotated[
        float, typer.Option("--dt", metavar="S", help="Spacing of the samples, 1e-4 to 0.02 s.")
    ] = 0.001

    def arguments(self) -> dict[str, Any]:
        """Return the arguments of `swing` for its limits and surroundings."""
        return {
            "acceleration": for_joints(self.acceleration),
            "jerk": for_joints(self.jerk),
            "table_height": self.table_height,
            "margin": self.margin,
            "dt": self.dt,
        }

    def hit(self, wanted: Hit) -> Hit:
        """Return the hit with the object's size, and without a flux for the fastest.

        Raises:
            InputError: a size that no box has.
        """
        size = wanted.size if self.size is None else triple(self.size, "size")
        if not self.fastest:
            return wanted.changed(size=size)
        return wanted.changed(
            size=size, direction=wanted.direction, goal=None, object_speed=None, flux=None
        )


@dataclass(frozen=True)
class TrajectoryOutputs(OutputOptions):
    """A trajectory, a figure, JSON instead of a table."""

    out: Annotated[
        Path | None,
        typer.Option(
            "--out",
            metavar="FILE",
            help="Write the trajectory: .csv, .npz, or ROS JointTrajectory as .yaml or .json.",
        ),
    ] = None

    def check(self, *inputs: str | Path | None) -> None:
        """Refuse paths before any work is done for them; `inputs` are read, not written.

        Raises:
            InputError: one cannot be written.
        """
        from hitjoints.export.trajectory import TRAJECTORY_ENDINGS

        check_outputs(self.plot, (self.out, "out", TRAJECTORY_ENDINGS), inputs=inputs)
        self.check_look()


def swing(
    robot: RobotOptions,
    hit: HitOptions,
    start: Annotated[StartOptions, without("start", "torque_limits")],
    motion: SwingOptions,
    impact: Annotated[ImpactOptions, without("restitution")],
    output: TrajectoryOutputs,
) -> None:
    """Make a motion that can be sent: from rest, through the hit, to rest, within all limits.

    It keeps positions, velocities, accelerations, jerks, torques and clearance. What of these the
    robot does not tell is said.
    """
    from hitjoints.show import figures
    from hitjoints.swings.make_swing import swing as make

    output.check(robot.robot, start.plan, hit.file)
    planned = start.planned()
    asked = hit.read(planned)
    arm = robot.load()
    wanted = motion.hit(asked.flux_hit(arm, **impact.setting()))
    given = start.arguments(planned, wanted, arm)
    result = make(
        arm,
        wanted,
        q0=given["q0"],
        q_hit=given["q_hit"],
        seed=given["seed"],
        **motion.arguments(),
    )
    if result.limits.unknown:
        unknown = ", ".join(result.limits.unknown)
        complain("note", f"{arm.name} does not tell: {unknown}; not kept, or left out")
    for note in result.notes:
        complain("note", note)
    if output.out is not None:
        from hitjoints.export.trajectory import write_trajectory

        write_trajectory(result.trajectory, output.out)
    output.save(figures.swing, result)
    if output.as_json:
        files = [str(path) for path in (output.out, output.plot) if path is not None]
        print_json({"robot": robot.robot} | result.as_dict() | {"files": files})
    else:
        _print(result)
    output.tell()


def _print(result: Swing) -> None:
    said, hit = result.as_dict(), result.hit
    jerk = said["jerk_ratio_max"]
    wanted = "the most" if hit.flux is None else f"{hit.flux:g} m/s desired"
    rows = [
        ("impact after", result.impact_time, "s"),
        ("at rest after", result.duration, "s"),
        (f"flux, {wanted}", result.flux, "m/s"),
        ("flux that limits alone would allow", result.maximum_flux, "m/s"),
        ("speed", result.speed, "m/s"),
        *inertia_rows(result),
        ("q at the impact", result.q_hit, "rad"),
        ("qd at the impact", result.qd_hit, "rad/s"),
        ("velocity, of its limit", said["velocity_ratio_max"], ""),
        ("acceleration, of its limit", said["acceleration_ratio_max"], ""),
        ("jerk, of its limit", "not known" if jerk is None else jerk, ""),
        ("torque, of its limit", said["torque_ratio_max"], ""),
        ("clearance", said["clearance"], f"m, {result.closest}" if result.closest else ""),
        ("sendable", result.sendable, result.why),
    ]
    joint = result.hit.chosen_contact.joint
    title = f"{result.robot.title}: joint {joint} hits {hit.words}"
    print_table(title, ("swing", "value", "unit"), rows)
