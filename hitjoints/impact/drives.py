"""The model of an arm's drives that a hit is reckoned with."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any

from hitjoints.errors import UnknownNameError
from hitjoints.impact.restitution import check_restitution
from hitjoints.impact.rotor import with_rotors
from hitjoints.vectors import number

if TYPE_CHECKING:
    from hitjoints.model.robot import Robot

MODELS = ("rigid", "rotor", "composite", "elastic")


@dataclass(frozen=True)
class Drives:
    """The model of the arm's drives that a hit is reckoned with.

    Args:
        model: "rigid", "rotor", "composite" or "elastic", see `impact_inertia` and
            `elastic_impact`.
        contact_time: s, elastic: of the rigid pair.
        restitution: elastic: from 0 to 1, where the hit tells none.
        stiffness: N m/rad, elastic: of the joints, one number or (n,); None: the robot's, or 1e4.
        rotor_inertia: kg m^2, reflected, one number or (n,); None: the robot's.

    Raises:
        UnknownNameError: no such model.
        InputError: a number cannot be used; what needs a robot to be checked is, once there is one.
    """

    model: str = "rigid"
    contact_time: float = 0.01
    restitution: float = 0.5
    stiffness: float | tuple[float, ...] | None = None
    rotor_inertia: float | tuple[float, ...] | None = None

    def __post_init__(self) -> None:
        if self.model not in MODELS:
            raise UnknownNameError("impact", self.model, MODELS)
        words = "it is finite and above 0 s"
        number(self.contact_time, "contact_time", words, lambda value: value > 0)
        check_restitution(self.restitution)
        for name in ("stiffness", "rotor_inertia"):
            object.__setattr__(self, name, _plain(getattr(self, name)))

    @property
    def rigid(self) -> bool:
        """Whether the links alone count."""
        return self.model == "rigid"

    @property
    def in_mass_matrix(self) -> bool:
        """Whether a mass matrix holds all there is to it: the other models have none."""
        return self.model in ("rigid", "rotor")

    def arm(self, robot: Robot) -> Robot:
        """Return the arm whose mass matrix this is: with its rotors, by the model "rotor".

        Raises:
            ModelError: the rotor inertia is not known.
        """
        return with_rotors(robot, self.rotor_inertia) if self.model == "rotor" else robot

    def as_dict(self) -> dict[str, Any]:
        """Return what differs from the usual, by name."""
        return {
            item.name: getattr(self, item.name)
            for item in fields(self)
            if getattr(self, item.name) != item.default
        }


def _plain(value: Any) -> float | tuple[float, ...] | None:
    """Return numbers such that records of them compare and hash."""
    listed = value.tolist() if hasattr(value, "tolist") else value
    return tuple(listed) if isinstance(listed, list | tuple) else listed


RIGID = Drives()
