"""The model of the arm's drives that a command reckons with, and what it tells of one hit."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, NamedTuple

import typer

from .options import numbers

if TYPE_CHECKING:
    from hitjoints.model.robot import Contact, Robot

MODELS = ("rigid", "rotor", "composite", "elastic")
CONTACT_TIME, RESTITUTION = 0.01, 0.5

ContactTimeOption = Annotated[
    float | None,
    typer.Option("--contact-time", metavar="S", help=f"elastic: s. (default: {CONTACT_TIME:g})"),
]
RestitutionOption = Annotated[
    float | None,
    typer.Option("--restitution", help=f"elastic: from 0 to 1. (default: {RESTITUTION:g})"),
]
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


class Drives(NamedTuple):
    """What is asked about the drives; None: as the robot or usually."""

    contact_time: float | None = None
    restitution: float | None = None
    stiffness: str | None = None
    rotor_inertia: str | None = None

    def check(self, model: str | None, choices: tuple[str, ...] = (*MODELS, "all")) -> None:
        """Refuse a model that is none of the choices, and what is given without one.

        Raises:
            UnknownNameError: no such model.
            BadParameter: an option that only a model reads.
        """
        from hitjoints.errors import UnknownNameError

        if model is None:
            given = [name for name in self._fields if getattr(self, name) is not None]
            if given:
                option = given[0].replace("_", "-")
                raise typer.BadParameter(f"--{option} needs --impact, the model that reads it")
        elif model not in choices:
            raise UnknownNameError("impact", model, choices)

    def of_joints(self, name: str) -> Any:
        """Return the number that was given for all joints, or those for each; None if none."""
        text = getattr(self, name)
        values = None if text is None else numbers(text)
        return values[0] if values is not None and len(values) == 1 else values


def impact_by_model(
    robot: Robot,
    q: Any,
    contact: Contact,
    direction: Any,
    mass: float,
    speed: float,
    model: str,
    drives: Drives,
) -> dict[str, Any]:
    """Return what one model, or "all" of them, make of a hit: kg each, and the elastic hit.

    Raises:
        HitjointsError: an option cannot be used, or the rotor inertia is not known.
    """
    import hitjoints as hj

    rotors = drives.of_joints("rotor_inertia")
    found: dict[str, Any] = {}
    for name in MODELS if model == "all" else (model,):
        if name != "elastic":
            found[name] = hj.impact_inertia(
                robot, q, contact, direction, name, rotor_inertia=rotors  # type: ignore[arg-type]
            )
            continue
        time = CONTACT_TIME if drives.contact_time is None else drives.contact_time
        restitution = RESTITUTION if drives.restitution is None else drives.restitution
        stiffness = drives.of_joints("stiffness")
        hit = hj.elastic_impact(
            robot, q, contact, direction, mass, speed, restitution, time, stiffness,
            rotor_inertia=rotors,
        )  # fmt: skip
        known = stiffness is not None or robot.joint_stiffness is not None
        found[name] = hit.as_dict() | {
            "speed": speed,
            "restitution": restitution,
            "rigid_contact_time": time,
            "stiffness_assumed": not known,
        }
    return found


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
