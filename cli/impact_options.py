"""The model of the arm's drives that a command reckons with, and what it tells of one hit."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

import typer

from .option_groups import OptionGroup
from .options import numbers

if TYPE_CHECKING:
    from hitjoints.impact.drives import Drives
    from hitjoints.model.robot import Contact, Robot
    from hitjoints.swings.swing_record import Swing

MODELS = ("rigid", "rotor", "composite", "elastic")
CONTACT_TIME, RESTITUTION = 0.01, 0.5
"""As `Drives` has them; said in the help, which imports nothing of it."""


def of_joints(text: str | None) -> Any:
    """Read one number for all joints, or one for each; None when nothing is given."""
    values = None if text is None else numbers(text)
    return values[0] if values is not None and len(values) == 1 else values


StiffnessOption = Annotated[
    str | None,
    typer.Option(
        "--stiffness",
        metavar="K[,...]",
        help="elastic: of the joints, N m/rad. (default: the robot's, else 1e4)",
    ),
]
RotorOption = Annotated[
    str | None,
    typer.Option(
        "--rotor-inertia",
        metavar="B[,...]",
        help="Reflected through the gears, kg m^2. (default: the robot's)",
    ),
]


@dataclass(frozen=True)
class ImpactOptions(OptionGroup):
    """What the arm shows in a hit."""

    panel: ClassVar[str] = "What the arm shows in a hit"

    impact: Annotated[
        str | None,
        typer.Option("--impact", metavar="MODEL", help=f"{', '.join(MODELS)}, or all of them."),
    ] = None
    contact_time: Annotated[
        float | None,
        typer.Option(
            "--contact-time", metavar="S", help=f"elastic: how long. (default: {CONTACT_TIME:g})"
        ),
    ] = None
    restitution: Annotated[
        float | None,
        typer.Option("--restitution", help=f"elastic: from 0 to 1. (default: {RESTITUTION:g})"),
    ] = None
    stiffness: StiffnessOption = None
    rotor_inertia: RotorOption = None

    def check(self) -> None:
        """Refuse an unknown model, and what is given without one.

        Raises:
            UnknownNameError: no such model.
            BadParameter: an option that only a model reads.
        """
        from hitjoints.errors import UnknownNameError

        if self.impact is None:
            for item in fields(self):
                # A goal needs the restitution, too.
                if item.name != "restitution" and getattr(self, item.name) is not None:
                    option = item.name.replace("_", "-")
                    raise typer.BadParameter(f"--{option} needs --impact, the model that reads it")
        elif self.impact not in (*MODELS, "all"):
            raise UnknownNameError("impact", self.impact, (*MODELS, "all"))

    def setting(self) -> dict[str, Any]:
        """Return what a hit keeps of it: the model that it is reckoned with, if one is asked for.

        Raises:
            UnknownNameError: no such model.
            BadParameter: an option that only a model reads.
        """
        if self.impact is None:
            self.check()
            return {}
        return {"drives": self._drives(self.impact)}

    def _drives(self, model: str) -> Drives:
        from hitjoints.impact.drives import Drives

        given = {
            "contact_time": self.contact_time,
            "restitution": self.restitution,
            "stiffness": of_joints(self.stiffness),
            "rotor_inertia": of_joints(self.rotor_inertia),
        }
        return Drives(model, **{name: v for name, v in given.items() if v is not None})

    def of(
        self, robot: Robot, q: Any, contact: Contact, direction: Any, mass: float, speed: float
    ) -> dict[str, Any]:
        """Return what the models make of a hit: kg each, and the elastic hit.

        Raises:
            HitjointsError: an option cannot be used, or the rotor inertia is not known.
        """
        import hitjoints as hj
        from hitjoints.impact.inertia_models import INERTIA_MODELS

        rotors, stiffness = of_joints(self.rotor_inertia), of_joints(self.stiffness)
        drives, found = self._drives("elastic"), dict[str, Any]()
        for name in INERTIA_MODELS:
            if self.impact in (name, "all"):
                found[name] = hj.impact_inertia(
                    robot,
                    q,
                    contact,
                    direction,
                    name,
                    rotor_inertia=rotors,
                )
        if self.impact in ("elastic", "all"):
            hit = hj.elastic_impact(
                robot, q, contact, direction, mass, speed, drives.restitution,
                drives.contact_time, stiffness, rotor_inertia=rotors,
            )  # fmt: skip
            found["elastic"] = hit.as_dict() | {
                "speed": speed,
                "restitution": drives.restitution,
                "rigid_contact_time": drives.contact_time,
                "stiffness_assumed": stiffness is None and robot.joint_stiffness is None,
            }
        return found


def inertia_rows(swing: Swing) -> list[tuple[str, Any, str]]:
    """Return lines of a table: the inertia that a swing reckons with, and that of the links."""
    drives = swing.hit.setting.drives
    if drives.rigid:
        return [("inertia", swing.inertia, "kg")]
    return [
        (f"inertia shown, {drives.model}", swing.inertia, "kg"),
        ("inertia of the links", swing.links_inertia, "kg"),
    ]


def impact_rows(impact: dict[str, Any]) -> list[tuple[str, Any, str]]:
    """Return lines of a table: quantity, value, unit."""
    words = {
        "rigid": "inertia, links alone",
        "rotor": "inertia, with rotors",
        "composite": "inertia, joints locked",
    }
    rows = [(words[name], impact[name], "kg") for name in words if name in impact]
    if "elastic" in impact:
        hit = impact["elastic"]
        rows += [
            ("elastic: shown at the parting", hit["shown"], "kg"),
            ("elastic: equivalent in Eq. 3", hit["equivalent"], "kg"),
            ("elastic: object speed", hit["object_speed"], "m/s"),
            ("elastic: robot speed then", hit["robot_speed"], "m/s"),
            ("elastic: contact time", hit["contact_time"], "s"),
            ("elastic: second contact after", hit["second_contact"], "s"),
        ]
    return rows
