"""What is hit, with what, which way and how hard: the options of every command that takes a hit."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, TypeVar

import typer

from .option_groups import OptionGroup
from .options import numbers, triple

if TYPE_CHECKING:
    from hitjoints.hit import Hit
    from hitjoints.model.robot import Contact, Robot

OBJECT = "0.5,0.3,0.5"
DIRECTION = "0,1,0"
MASS = 2.0
FLUX = 0.3
T = TypeVar("T")
TIP = "tip"
SAME = 1e-9  # by which an option may differ from what a plan says


@dataclass(frozen=True)
class HitOptions(OptionGroup):
    """The hit. What is not asked for is as a plan says, or else as usual."""

    panel: ClassVar[str] = "The hit"

    position: Annotated[
        str | None,
        typer.Option(
            "--object", metavar="X,Y,Z", help=f"Position of the object (m). (default: {OBJECT})"
        ),
    ] = None
    direction: Annotated[
        list[str] | None,
        typer.Option(
            "--direction",
            metavar="X,Y,Z",
            help=f"Hitting direction, robot base frame. (default: {DIRECTION})",
        ),
    ] = None
    mass: Annotated[
        float | None,
        typer.Option("--mass", metavar="KG", help=f"Mass of the object. (default: {MASS:g})"),
    ] = None
    joint: Annotated[
        list[int] | None,
        typer.Option(
            "--joint", help="Hitting joint, from 1; repeat for several. (default: the robot's)"
        ),
    ] = None
    offset: Annotated[
        str | None,
        typer.Option(
            "--offset",
            metavar="X,Y,Z|tip",
            help="Contact point in the joint's frame (m), or the tip of the tool. (default: 0)",
        ),
    ] = None
    flux: Annotated[
        float | None,
        typer.Option("--flux", metavar="M/S", help="Desired hitting flux (Eq. 4)."),
    ] = None

    def read(self, planned: Mapping[str, Any] | None = None) -> AskedHit:
        """Read the values, and fill in what is not asked for.

        Args:
            planned: what a plan says, by the names of `AskedHit`.

        Raises:
            InputError: a value cannot be used, or contradicts the plan.
        """
        asked = {
            "position": None if self.position is None else triple(self.position, "object"),
            "directions": None
            if self.direction is None
            else [triple(text, "direction") for text in self.direction],
            "mass": self.mass,
            "joints": self.joint,
            "offset": self.offset
            if self.offset in (None, TIP)
            else triple(str(self.offset), "offset"),
            "flux": self.flux,
        }
        plan = planned or {}
        chosen = {name: _one(name, value, plan.get(name)) for name, value in asked.items()}
        check_mass(MASS if chosen["mass"] is None else chosen["mass"])
        return AskedHit(**{name: value for name, value in chosen.items() if value is not None})


@dataclass(frozen=True)
class AskedHit:
    """A hit as asked for, with the usual values for what was not.

    Attributes:
        position: (3,) m.
        directions: (3,) each; most commands take one.
        mass: kg.
        joints: to hit with; None for the robot's own.
        offset: (3,) m, of the contact in the joint's frame, or "tip" for that of the tool; None
            for the origin, and for the tip when no joint is named either.
        flux: m/s; None if none is demanded.
    """

    position: tuple[float, ...] = tuple(numbers(OBJECT))
    directions: tuple[tuple[float, ...], ...] = (tuple(numbers(DIRECTION)),)
    mass: float = MASS
    joints: tuple[int, ...] | None = None
    offset: tuple[float, float, float] | str | None = None
    flux: float | None = None

    @property
    def direction(self) -> tuple[float, ...]:
        """The one direction.

        Raises:
            InputError: several were given.
        """
        return _only("direction", self.directions)

    def contacts(self, robot: Robot) -> list[Contact]:
        """Return the contacts to try: the robot's hitting joints if none is named.

        Raises:
            InputError: the robot has no such joint.
        """
        if self.joints is None and self.offset is None:
            return list(robot.usual_contacts)
        usual = (robot.n,) if self.offset == TIP else robot.hitting_joints
        return [self._placed(robot, joint) for joint in self.joints or usual]

    def contact(self, robot: Robot) -> Contact:
        """Return the one contact: of the robot's usual joint if none is named.

        Raises:
            InputError: several joints are named, or one that the robot does not have.
        """
        usual = robot.n if self.offset == TIP else robot.usual_joint
        return self._placed(robot, usual if self.joints is None else _only("joint", self.joints))

    def _placed(self, robot: Robot, joint: int) -> Contact:
        from hitjoints.errors import InputError
        from hitjoints.model.robot import Contact

        if not isinstance(self.offset, str):
            return robot.contact(Contact(joint, self.offset or (0.0, 0.0, 0.0)))
        if robot.tool is None or joint != robot.n:
            wanted = f"a tool (--tool FILE) and joint {robot.n}, which carries it"
            raise InputError("offset", TIP, wanted)
        return robot.flange

    def flux_hit(self, robot: Robot) -> Hit:
        """Return the one hit with a flux, the usual one if none is asked for.

        Raises:
            InputError: a value cannot be used.
        """
        import numpy as np

        from hitjoints.hit import Hit

        at, along = np.array(self.position), np.array(self.direction)
        flux = FLUX if self.flux is None else self.flux
        return Hit(self.contact(robot), at, along, self.mass, flux)


def check_mass(mass: float) -> None:
    """Refuse a mass that no object has.

    Raises:
        InputError: not above zero, or not finite.
    """
    from hitjoints.errors import InputError

    if not (mass > 0 and math.isfinite(mass)):
        raise InputError("mass", mass, "an object weighs more than 0 kg")


def _only(name: str, values: Sequence[T]) -> T:
    from hitjoints.errors import InputError

    if len(values) != 1:
        raise InputError(name, ", ".join(map(str, values)), "this command takes one")
    return values[0]


def _one(name: str, asked: Any, planned: Any) -> Any:
    """Return what is asked for or planned, and refuse to be asked for what is not planned.

    Raises:
        InputError: an option contradicts the plan.
    """
    import numpy as np

    from hitjoints.errors import InputError

    if asked is None or planned is None:
        return planned if asked is None else asked
    if asked == TIP:  # which the plan, made with the same tool, says in numbers
        return planned
    same = np.shape(asked) == np.shape(planned)
    if not same or not np.allclose(asked, planned, rtol=0, atol=SAME):
        option = {"position": "object", "directions": "direction", "joints": "joint"}
        words = f"the plan is for {_words(planned)}"
        raise InputError(option.get(name, name), _words(asked), words)
    return asked


def _words(value: Any) -> str:
    """Return a number, or several, as they are typed."""
    return ",".join(map(_words, value)) if isinstance(value, (list, tuple)) else str(value)
