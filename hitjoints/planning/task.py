"""What a plan for one joint is asked: a hit, the arm that makes it, and how its links may lie."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from hitjoints.hit import Hit
    from hitjoints.model.robot import Contact, Robot
    from hitjoints.types import Array


@dataclass(frozen=True)
class Task:
    """A hit with one contact.

    Attributes:
        robot: the arm.
        hit: what is wanted, with its contact.
        target: (3,) m, where the contact has to be; None leaves it free.
        away: demand the away condition of Eq. 14.
    """

    robot: Robot
    hit: Hit
    target: Array | None
    away: bool

    @cached_property
    def contact(self) -> Contact:
        """What hits."""
        return self.robot.contact(self.hit.chosen_contact)

    @property
    def direction(self) -> Array:
        """(3,) unit vector."""
        return self.hit.direction

    @property
    def mass(self) -> float:
        """Mass of the object, kg."""
        return self.hit.mass

    @cached_property
    def beyond(self) -> Contact:
        """The point chi_{k+1} the away condition compares with, see `Robot.beyond`."""
        return self.robot.beyond(self.contact)
