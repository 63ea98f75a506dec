"""What is wanted: which object, where, how heavy, which way, how hard, and with what."""

from __future__ import annotations

import copy
import json
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from hitjoints.constants import GRAVITY
from hitjoints.errors import InputError
from hitjoints.hit_checks import LEAST_FLUX, frozen, spread_of, vector_of
from hitjoints.hit_setting import USUAL, HitSetting, RobotChoice, offsets_of
from hitjoints.impact.flux import flux as flux_at
from hitjoints.impact.flux import speed_for
from hitjoints.model.robot import Contact
from hitjoints.told import Told
from hitjoints.vectors import number, positive_mass, unit

if TYPE_CHECKING:
    from hitjoints.model.robot import Robot
    from hitjoints.types import Array

HOW_HARD = ("goal", "flux", "object_speed")
"""Ways to say how hard the hit is to be; at most one of them."""


OBJECT = ("position", "mass", "size", "yaw", "restitution", "friction", "spread")
SURROUNDINGS = ("object_size", "table_height", "margin")
HOW = (
    "objective",
    "deliverable",
    "away",
    "torque_limits",
    "seed",
    "dt",
    "q0",
    "q_hit",
    "hits",
    "tolerance",
)
LIMITS = ("acceleration", "jerk")
LEVEL = 1e-6
"""m, and share of the way, up to which object and goal count as equally high."""


@dataclass(frozen=True, eq=False, repr=False)
class Hit(Told):
    """A wanted hit, the one description that everything takes and every result keeps.

    Args:
        contact: what hits: joint number or Contact; None tries the robot's hitting joints.
        position: (3,) m, where the object is hit, robot base frame.
        direction: (3,) hitting direction, unit length after construction; a goal gives it.
        mass: kg, of the object, at rest.
        flux: m/s, desired directional flux (Eq. 4); a goal or an object speed gives it; None asks
            for no particular one.
        goal: (3,) m, where the point that is hit is to come to rest, instead of direction and flux:
            the object slides there on a level table.
        object_speed: m/s, desired speed of the object after the hit, instead of a flux.
        restitution: eps of the impact, 0 to 1; a goal or an object speed needs it (Eq. 3).
        friction: mu of the object on its table; a goal needs it.
        size: (3,) m, edges of the box along the direction, across it and upwards.
        yaw: rad, how far the box is turned about the vertical, against the direction.
        spread: standard deviations by name, see `hit_checks.UNCERTAIN`.
        setting: the arm, the joints to try, the surroundings, and how, see `HitSetting`.

    Raises:
        InputError: an argument is out of its range, of wrong shape, not finite, or says what
            another one says already.
    """

    contact: Contact | int | None
    position: Array
    direction: Array = None  # type: ignore[assignment]  # never None after construction
    mass: float = None  # type: ignore[assignment]  # refused
    flux: float | None = None
    goal: Array | None = None
    object_speed: float | None = None
    restitution: float | None = None
    friction: float | None = None
    size: Array | None = None
    yaw: float = 0.0
    spread: Mapping[str, float] | None = None
    setting: HitSetting = USUAL

    def __post_init__(self) -> None:
        if self.contact is not None and not isinstance(self.contact, Contact):
            self._set("contact", Contact(self.contact))
        self._set("position", vector_of(self.position, "position"))
        self._set("mass", positive_mass(self.mass))
        if (self.goal is None) == (self.direction is None):
            given = "neither" if self.goal is None else "both"
            raise InputError("goal", given, "a hit has a direction or a goal, exactly one of them")
        said = [name for name in HOW_HARD if getattr(self, name) is not None]
        if len(said) > 1:
            raise InputError(said[1], getattr(self, said[1]), f"{said[0]} says how hard already")
        for name, words in (
            ("flux", f"a desired flux is finite and at least {LEAST_FLUX:g} m/s"),
            ("object_speed", f"a desired speed is finite and at least {LEAST_FLUX:g} m/s"),
        ):
            self._number(name, words, lambda value: value >= LEAST_FLUX)
        self._number("restitution", "it lies from 0 to 1", lambda value: 0 <= value <= 1)
        self._number("friction", "it is finite and above 0", lambda value: value > 0)
        self._number("yaw", "a finite angle in rad", lambda value: True)
        if self.size is not None:
            size = vector_of(self.size, "size")
            if not (size > 0).all():
                raise InputError("size", size.tolist(), "edges are above 0 m")
            self._set("size", size)
        self._set("spread", spread_of(self.spread or {}))
        self._aim()

    def _aim(self) -> None:
        """Find direction and flux from what was given instead."""
        if self.goal is not None:
            self._set("goal", vector_of(self.goal, "goal"))
            way = self.goal - self.position
            distance = float(np.hypot(way[0], way[1]))
            if abs(way[2]) > LEVEL * max(distance, LEVEL):
                raise InputError("goal", self.goal.tolist(), "it lies as high as the object")
            if distance == 0:
                raise InputError("goal", self.goal.tolist(), "the object is there already")
            self._set("direction", frozen(unit(np.array([way[0], way[1], 0.0]))))
            friction = self._needed("friction", "a goal")
            speed = math.sqrt(2 * friction * GRAVITY * distance)
            self._set("flux", speed / (1 + self._needed("restitution", "a goal")))
            return
        self._set("direction", frozen(unit(vector_of(self.direction, "direction"))))
        if self.object_speed is not None:
            restitution = self._needed("restitution", "an object speed")
            self._set("flux", self.object_speed / (1 + restitution))

    def _needed(self, name: str, what: str) -> float:
        value = getattr(self, name)
        if value is None:
            raise InputError(name, value, f"{what} needs it")
        return float(value)

    def _set(self, name: str, value: Any) -> None:
        object.__setattr__(self, name, value)

    def _number(self, name: str, words: str, allowed: Callable[[float], bool]) -> None:
        value = getattr(self, name)
        if value is None:
            return
        self._set(name, number(value, name, words, allowed))

    @property
    def words(self) -> str:
        """What is hit, where and which way, such as "2 kg at (0.5, 0.3, 0.5) m along (0, 1, 0)"."""
        at = ", ".join(f"{v:g}" for v in self.position)
        along = ", ".join(f"{v:.4g}" for v in self.direction)
        return f"{self.mass:g} kg at ({at}) m along ({along})"

    def __repr__(self) -> str:
        """Say in a line what is wanted."""
        joint = "any joint" if self.contact is None else f"joint {self.chosen_contact.joint}"
        goal = "" if self.goal is None else f" to ({', '.join(f'{v:g}' for v in self.goal)}) m"
        flux = "" if self.flux is None else f", flux {self.flux:.4g} m/s"
        return f"Hit({joint}, {self.words}{goal}{flux})"

    def lines(self) -> list[tuple[str, object]]:
        """Return what was given, as in a file."""
        tables = {name: table for name, table in self.as_dict().items() if name != "schema"}
        return [(f"{name} {key}", v) for name, table in tables.items() for key, v in table.items()]

    @property
    def chosen_contact(self) -> Contact:
        """What hits.

        Raises:
            InputError: no joint was chosen.
        """
        if not isinstance(self.contact, Contact):
            raise InputError("joint", None, "one joint has to be chosen (`plan` chooses the best)")
        return self.contact

    @property
    def desired_flux(self) -> float:
        """The flux asked for, m/s.

        Raises:
            InputError: none was.
        """
        if self.flux is None:
            raise InputError("flux", None, "a flux, an object speed or a goal is needed (m/s)")
        return self.flux

    def speed(self, inertia: float) -> float:
        """Return the speed (m/s) that produces the flux at an inertia (kg): Eq. 4 solved for v."""
        return float(speed_for(1.0 / inertia, self.mass, self.desired_flux))

    def flux_of(self, inertia: float, speed: float) -> float:
        """Return the flux (m/s) of an inertia (kg) and a speed (m/s), Eq. 4."""
        return float(flux_at(1.0 / inertia, self.mass, speed))

    def with_contact(self, contact: Contact | int) -> Hit:
        """Return the same hit with what hits."""
        other = copy.copy(self)
        other._set("contact", contact if isinstance(contact, Contact) else Contact(contact))
        return other

    def with_flux(self, flux: float) -> Hit:
        """Return the same hit, asking for a flux (m/s)."""
        said = dict.fromkeys(HOW_HARD) | {"direction": self.direction, "flux": flux}
        return self.changed(**said)

    def changed(self, **values: Any) -> Hit:
        """Return the same hit with some of its arguments changed."""
        return Hit(**(self._given() | values))

    def _given(self) -> dict[str, Any]:
        """Return the arguments it was made of: what a goal or an object speed gave is left out."""
        found = {"direction", "flux"} if self.goal is not None else set()
        found |= {"flux"} if self.object_speed is not None else set()
        return {f.name: getattr(self, f.name) for f in fields(self) if f.name not in found}

    def contacts(self, robot: Robot) -> tuple[Contact, ...]:
        """Return the contacts to try with a robot: the one chosen, those named, or the robot's own.

        Raises:
            InputError: the robot has no such joint.
        """
        if isinstance(self.contact, Contact):
            return (robot.contact(self.contact),)
        joints, offset = self.setting.joints, self.setting.offset
        if joints is None and offset is None:
            return robot.usual_contacts
        tried = joints or robot.hitting_joints
        return robot.contacts(
            [Contact(*each) for each in zip(tried, offsets_of(offset, len(tried)), strict=True)]
        )

    def as_dict(self) -> dict[str, Any]:
        """Return what was given, table by table as in a file; what was left out is left out."""
        from hitjoints.hit_file import told

        given, setting = self._given(), self.setting
        contact = self.contact if isinstance(self.contact, Contact) else None
        joints = setting.joints if contact is None else (contact.joint,)
        tables = {
            "robot": {} if setting.robot is None else vars(setting.robot),
            "contact": {
                "joints": joints,
                "offset": setting.offset if contact is None else contact.offset,
            },
            "object": {name: given.get(name) for name in OBJECT},
            "wish": {name: given.get(name) for name in ("goal", "direction", *HOW_HARD[1:])},
            "surroundings": {name: getattr(setting, name) for name in SURROUNDINGS},
            "how": {name: getattr(setting, name) for name in HOW},
            "limits": {name: getattr(setting, name) for name in LIMITS},
            "impact": setting.drives.as_dict(),
        }
        return told(tables)

    def made_by(self, robot: Robot, **told: Any) -> Hit:
        """Return the same hit, which says with which arm and how it is made.

        Args:
            robot: the arm, for a hit that does not say.
            told: by the names of `HitSetting`; None tells nothing.
        """
        said: dict[str, Any] = {
            name: tuple(np.ravel(value).tolist()) if np.ndim(value) else value
            for name, value in told.items()
            if value is not None
        }
        if self.setting.robot is None and robot.asked is not None:
            said["robot"] = RobotChoice(**robot.asked)
        return self.changed(setting=replace(self.setting, **said)) if said else self

    @property
    def text(self) -> str:
        """What was given as one line of JSON, whatever folder it is read from."""
        choice = self.setting.robot
        here = None if choice is None else choice.found_from(Path.cwd())
        return json.dumps(self.changed(setting=replace(self.setting, robot=here)).as_dict())

    def seen_from(self, folder: Path) -> Hit:
        """Return the same hit, its paths relative to a folder."""
        robot = self.setting.robot
        seen = None if robot is None else robot.seen_from(folder)
        return self.changed(setting=replace(self.setting, robot=seen))

    def save(self, path: str | Path) -> None:
        """Write a file that `load_hit` reads, with paths relative to it.

        Raises:
            InputError: it cannot be written.
        """
        from hitjoints.datasets.files import write_whole
        from hitjoints.hit_file import check_tables, write_tables

        path = Path(path)
        text = write_tables(check_tables(self.seen_from(path.parent).as_dict(), str(path)))
        write_whole(path, "hit", lambda made: made.write_text(text, encoding="utf-8"))

    def __eq__(self, other: object) -> bool:
        """Tell whether two hits ask for the same."""
        if not isinstance(other, Hit):
            return NotImplemented
        return self.as_dict() == other.as_dict()

    def __hash__(self) -> int:
        """Return a hash that equal hits share."""
        return hash((self.contact, self.position.tobytes(), self.mass, self.flux))
