"""How a hit is made in the physics engine: what the box is, and what is not as the model has it."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal

import numpy as np

from hitjoints.errors import InputError, UnknownNameError
from hitjoints.goals.box_hit import lever
from hitjoints.goals.sliding import check_support
from hitjoints.impact.restitution import check_restitution
from hitjoints.vectors import number

if TYPE_CHECKING:
    from hitjoints.goals.sliding import Support

Mode = Literal["ideal", "realistic"]
SHORTEST_CONTACT, LONGEST_CONTACT = 1e-6, 0.05
"""s; what lasts longer is a push, and what is shorter drowns in rounding."""
STRONGEST = 1e4
"""N m s/rad, of a servo; with more the engine's step is too long for the lightest links."""
STEP = 1e-5
"""s, the engine's step at most during the contact, and"""
STEPS = 200
"""steps in each contact at least."""
SMALLEST, LARGEST = 1e-3, 10.0
"""m, edges of a box that the engine can follow."""
STEEPEST_YAW = math.pi / 4
"""rad, of a box; turned further, a corner comes first."""
SHORT = 1e-4
"""s, a contact that is an impact."""


@dataclass(frozen=True)
class EngineSetting:
    """A hit in the engine; as it stands, the ideal one.

    Attributes:
        restitution: eps, from 0 to 1.
        size: (3,) m, of the box: along the normal of the face that is hit, sideways, up.
        friction: coefficient between box and table.
        contact_time: s, how long arm and box touch.
        servo_gain: N m s/rad (N s/m), of every joint's velocity servo; 0 leaves the arm free.
        contact_friction: coefficient between arm and box.
        off_centre: m, to the left from the line of the hit to the box's centre.
        yaw: rad, by which the box is turned to the left, against the hitting direction.
        height: m, of the point that is hit above the box's centre.
        support: what carries the box, its "face" or its four "corners".
        on_table: the table acts on the box during the contact already.
        stiffness: (n,) N m/rad, of springs between motors and links; empty: joints without motors.
        rotors: (n,) kg m^2, of those motors, reflected through the gears.

    Raises:
        InputError: a value is out of its range.
    """

    restitution: float = 0.5
    size: tuple[float, float, float] = (0.1, 0.1, 0.1)
    friction: float = 0.3
    contact_time: float = SHORT
    servo_gain: float = 0.0
    contact_friction: float = 0.0
    off_centre: float = 0.0
    yaw: float = 0.0
    height: float = 0.0
    support: Support = "face"
    on_table: bool = False
    stiffness: tuple[float, ...] = ()
    rotors: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        check_restitution(self.restitution)
        if len(self.size) != 3 or not all(SMALLEST <= edge <= LARGEST for edge in self.size):
            raise InputError("size", self.size, f"three edges from {SMALLEST:g} to {LARGEST:g} m")
        for name in ("friction", "servo_gain", "contact_friction"):
            words = "it must be finite and not below 0"
            number(getattr(self, name), name, words, lambda value: value >= 0)
        if self.servo_gain > STRONGEST:
            raise InputError("servo_gain", self.servo_gain, f"at most {STRONGEST:g} N m s/rad")
        words = f"a contact lasts {SHORTEST_CONTACT:g} s to {LONGEST_CONTACT:g} s"
        within = (SHORTEST_CONTACT, LONGEST_CONTACT)
        number(self.contact_time, "contact_time", words, lambda v: within[0] <= v <= within[1])
        self._check_place()

    def _check_place(self) -> None:
        """Refuse places that the arm cannot hit.

        Raises:
            InputError: the arm would miss the box's face.
        """
        check_support(self.support)
        words = f"within {STEEPEST_YAW:g} rad, or another face is hit"
        number(self.yaw, "yaw", words, lambda value: abs(value) <= STEEPEST_YAW)
        number(self.off_centre, "off_centre", "a finite distance, or the arm misses the box")
        aside = abs(float(lever(-self.off_centre, self.yaw, self.size[0])))
        if not aside < (half := self.size[1] / 2):
            expected = f"within {half:g} m of the face's middle, or the arm misses the box"
            name = "off_centre" if self.off_centre else "yaw"
            raise InputError(name, getattr(self, name), expected)
        words = f"it is within {self.size[2] / 2:g} m, or the arm misses the box"
        number(self.height, "height", words, lambda value: abs(value) < self.size[2] / 2)

    @property
    def stands(self) -> bool:
        """The table is there during the contact: a box that is hit high or low leans on it."""
        return self.on_table or self.height != 0

    @property
    def timestep(self) -> float:
        """The engine's step, s."""
        return min(STEP, self.contact_time / STEPS)

    def causes(self) -> list[tuple[str, float, EngineSetting, EngineSetting]]:
        """Return what is not ideal: its name, its value, and settings with it alone and without."""
        ideal = EngineSetting(
            self.restitution, self.size, self.friction, support=self.support, rotors=self.rotors
        )
        found = []
        for cause, name in CAUSES.items():
            value, usual = getattr(self, name), getattr(ideal, name)
            if value != usual:
                alone, without = replace(ideal, **{name: value}), replace(self, **{name: usual})
                found.append((cause, float(np.max(value)), alone, without))
        return found


CAUSES = {
    "servo": "servo_gain",
    "contact time": "contact_time",
    "contact friction": "contact_friction",
    "off-centre": "off_centre",
    "turned box": "yaw",
    "height": "height",
    "table": "on_table",
    "elastic joints": "stiffness",
}
"""What sets a hit apart from the model, each with its entry of a setting."""
MODES: dict[Mode, dict[str, float | bool]] = {
    "ideal": {},
    "realistic": {
        "contact_time": 0.01,
        "servo_gain": 50.0,
        "contact_friction": 0.3,
        "off_centre": 0.02,
        "on_table": True,
    },
}
"""What each mode sets, where nothing else is asked for."""


def setting(mode: Mode, **asked: float | str | tuple[float, ...] | None) -> EngineSetting:
    """Return the setting of a mode with what is asked for instead; None asks for nothing.

    Raises:
        InputError: an unknown mode, or a value out of its range.
    """
    if mode not in MODES:
        raise UnknownNameError("mode", mode, MODES)
    given = {name: value for name, value in asked.items() if value is not None}
    return EngineSetting(**(MODES[mode] | given))  # type: ignore[arg-type]
