"""What is hit, with what, which way and how hard: the options of every command that takes a hit."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, TypeVar

import typer

from .option_groups import OptionGroup
from .options import triple

if TYPE_CHECKING:
    from hitjoints.hit import Hit
    from hitjoints.model.robot import Contact, Robot
    from hitjoints.planning.plan_record import Plan

OBJECT = "0.5,0.3,0.5"
DIRECTION = "0,1,0"
MASS = 2.0
FLUX = 0.3
T = TypeVar("T")
TIP = "tip"
SAME = 1e-9  # by which an option may differ from what a plan says


@dataclass(frozen=True)
class HitOptions(OptionGroup):
    """The hit. What is not typed is as a file or a plan says, or else as usual."""

    panel: ClassVar[str] = "The hit"

    file: Annotated[
        Path | None,
        typer.Option("--hit", metavar="FILE", help="hit.toml; what is typed goes before it."),
    ] = None
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
    goal: Annotated[
        str | None,
        typer.Option("--goal", metavar="X,Y,Z", help="Where the object is to slide to (m)."),
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
    object_speed: Annotated[
        float | None,
        typer.Option("--object-speed", metavar="M/S", help="Desired speed of the object."),
    ] = None
    restitution: Annotated[
        float | None,
        typer.Option("--restitution", help="Of arm and object, 0 to 1; a goal needs it."),
    ] = None
    friction: Annotated[
        float | None,
        typer.Option("--friction", help="Between object and table; a goal needs it."),
    ] = None

    def read(self, plan: Plan | None = None, **told: Any) -> AskedHit:
        """Read the values, and fill in what is not asked for.

        Args:
            plan: that the values must not contradict.
            told: restitution and friction, where a command has options of its own for them; a
                goal or an object speed needs them.

        Raises:
            InputError: a value cannot be used, or contradicts the plan.
        """
        positions = {
            "object": self.position, "goal": self.goal,
            "offset": None if self.offset == TIP else self.offset,
        }  # fmt: skip
        read = {name: None if v is None else triple(v, name) for name, v in positions.items()}
        along = [triple(text, "direction") for text in self.direction or ()]
        if plan is not None:
            _check_plan(plan, read["object"], along, self.mass)
        asked: dict[str, Any] = {
            "position": read["object"],
            "directions": tuple(along) or None,
            "goal": read["goal"],
            "mass": self.mass,
            "joints": None if self.joint is None else tuple(self.joint),
            "offset": read["offset"] if self.offset != TIP else TIP,
            "flux": self.flux,
            "object_speed": self.object_speed,
            "restitution": self.restitution,
            "friction": self.friction,
            "base": plan.hit if plan is not None else None,
        }
        if self.file is not None:
            from hitjoints.hit_loading import load_hit

            asked["base"] = load_hit(self.file)
        if self.goal is not None or self.object_speed is not None:
            asked |= told
        check_mass(MASS if self.mass is None else self.mass)
        given = {name: value for name, value in asked.items() if value is not None}
        return AskedHit(**given)


@dataclass(frozen=True)
class AskedHit:
    """A hit as asked for, with the usual values for what was not.

    Attributes:
        position: (3,) m.
        directions: (3,) each; most commands take one; a goal goes before them.
        goal: (3,) m, where the object is to slide to.
        mass: kg.
        joints: to hit with; None for the robot's own.
        offset: (3,) m, of the contact in the joint's frame, or "tip" for that of the tool; None
            for the origin, and for the tip when no joint is named either.
        flux: m/s; None if none is demanded.
        object_speed: m/s, asked for instead.
        restitution: 0 to 1.
        friction: of the object on its table.
        base: a hit that says the rest.
    """

    position: tuple[float, float, float] = triple(OBJECT, "object")
    directions: tuple[tuple[float, float, float], ...] = (triple(DIRECTION, "direction"),)
    goal: tuple[float, float, float] | None = None
    mass: float = MASS
    joints: tuple[int, ...] | None = None
    offset: tuple[float, float, float] | str | None = None
    flux: float | None = None
    object_speed: float | None = None
    restitution: float | None = None
    friction: float | None = None
    base: Hit | None = None

    @property
    def direction(self) -> tuple[float, ...]:
        """The one direction.

        Raises:
            InputError: several were given, or the goal lies nowhere.
        """
        if self.goal is not None:
            return tuple(self.hit(None).direction.tolist())
        return _only("direction", self.directions)

    def contacts(self, robot: Robot) -> tuple[Contact, ...]:
        """Return the contacts to try: the robot's hitting joints if none is named.

        Raises:
            InputError: the robot has no such joint.
        """
        if self.joints is None and self.offset is None:
            return robot.usual_contacts
        if self._as_before:
            assert self.base is not None
            return self.base.contacts(robot)
        usual = (robot.n,) if self.offset == TIP else robot.hitting_joints
        return robot.contacts([self._placed(robot, k) for k in self.joints or usual])

    def contact(self, robot: Robot) -> Contact:
        """Return the one contact: of the robot's usual joint if none is named.

        Raises:
            InputError: several joints are named, or one that the robot does not have.
        """
        usual = robot.n if self.offset == TIP else robot.usual_joint
        return self._placed(robot, usual if self.joints is None else _only("joint", self.joints))

    @property
    def _as_before(self) -> bool:
        """The contacts are those of the base, each with an offset of its own."""
        from hitjoints.hit_setting import for_each

        if self.base is None or self.offset is not None:
            return False
        said = self.base.setting
        return for_each(said.offset) and self.joints == said.joints

    def _placed(self, robot: Robot, joint: int) -> Contact:
        from hitjoints.errors import InputError
        from hitjoints.model.robot import Contact

        if not isinstance(self.offset, str):
            return robot.contact(Contact(joint, self.offset or (0.0, 0.0, 0.0)))
        if robot.tool is None or joint != robot.n:
            wanted = f"a tool (--tool FILE) and joint {robot.n}, which carries it"
            raise InputError("offset", TIP, wanted)
        return robot.flange

    def hit(self, contact: Contact | Robot | None, **setting: Any) -> Hit:
        """Return the hit.

        Args:
            contact: what hits; a robot for whichever of its joints is best.
            setting: what else is asked for, by the names of `HitSetting`.

        Raises:
            InputError: a value cannot be used.
        """
        from dataclasses import replace

        from hitjoints.hit import Hit
        from hitjoints.model.robot import Contact

        robot = None if contact is None or isinstance(contact, Contact) else contact
        if robot is not None:
            # The tip of a tool is kept in numbers.
            at_tip = self.offset == TIP
            joints = (robot.n,) if at_tip else self.joints
            offset: Any = self.contact(robot).offset if at_tip else self.offset
            if self.base is not None and self._as_before:
                offset = self.base.setting.offset
            setting |= {"joints": joints, "offset": offset}
        given: dict[str, Any] = {
            "contact": contact if robot is None else None,
            "position": self.position,
            "mass": self.mass,
            "goal": self.goal,
            "direction": _only("direction", self.directions) if self.goal is None else None,
            "flux": self.flux,
            "object_speed": self.object_speed,
            "restitution": self.restitution,
            "friction": self.friction,
        }
        base = Hit(**given) if self.base is None else self.base.changed(**given)
        wanted = base.changed(setting=replace(base.setting, **setting))
        if self.base is None or wanted.setting.q_hit is None:
            return wanted
        moved = (wanted.position != self.base.position).any()
        if moved or (wanted.contact or self.base.contact) != self.base.contact:
            wanted = wanted.changed(setting=replace(wanted.setting, q_hit=None))
        return wanted

    def flux_hit(self, robot: Robot, **setting: Any) -> Hit:
        """Return the one hit with a flux, the usual one if none is asked for.

        Args:
            robot: whose contact hits.
            setting: as `hit`.

        Raises:
            InputError: a value cannot be used.
        """
        hit = self.hit(self.contact(robot), **setting)
        return hit if hit.flux is not None else hit.changed(flux=FLUX)


def check_mass(mass: float) -> None:
    """Refuse a mass that no object has.

    Raises:
        InputError: not above zero, or not finite.
    """
    from hitjoints.vectors import positive_mass

    positive_mass(mass)


def _only(name: str, values: Sequence[T]) -> T:
    from hitjoints.errors import InputError

    if len(values) != 1:
        raise InputError(name, ", ".join(map(str, values)), "this command takes one")
    return values[0]


def _check_plan(plan: Plan, position: Any, along: Sequence[Any], mass: float | None) -> None:
    """Refuse to be asked for what is not planned.

    Raises:
        InputError: an option contradicts the plan.
    """
    import numpy as np

    from hitjoints.errors import InputError
    from hitjoints.vectors import unit

    pairs: list[tuple[str, Any, Any]] = [
        ("object", position, plan.position),
        *(("direction", unit(one), plan.direction) for one in along),
        ("mass", mass, plan.mass),
    ]
    for name, asked, planned in pairs:
        if asked is not None and not np.allclose(asked, planned, rtol=0, atol=SAME):
            words = ",".join(f"{value:g}" for value in np.atleast_1d(planned))
            raise InputError(name, asked, f"the plan is for {words}")
