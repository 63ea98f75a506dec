"""A whole hit in the engine: what it began with, what became of it, and where the miss comes from.

Five places tell the causes apart, each foreseen with more of what happened: by the swing as it was
meant; by the arm as it touched; by the box as it first left; as it last did; and where it rests.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from hitjoints.evidence.physics.setting import EngineSetting
    from hitjoints.goals.box_rest import BoxRest
    from hitjoints.swings.swing_record import Swing
    from hitjoints.types import Array

CAUSES = ("servo", "contact", "touching again", "sliding")
"""What brings the box from each place to the next."""


@dataclass(frozen=True, eq=False)
class FirstTouch:
    """The first touch.

    Attributes:
        time: s, since the start of the swing.
        speed: m/s, of the contact along the direction.
        q: (n,) rad.
        qd: (n,) rad/s.
        off_centre: m, to the left from where the arm touches to the box's centre.
        height: m, of where the arm touches above the box's centre.
    """

    time: float
    speed: float
    q: Array
    qd: Array
    off_centre: float
    height: float


@dataclass(frozen=True, eq=False)
class WholeHit:
    """A swing by servos, the impact and the box's way, in one simulation.

    Attributes:
        swing: that was followed.
        setting: of the hit.
        touch: as it came about.
        meant: where the box rests by the swing as it is.
        touched: by the arm as it touched the box.
        left: by the box as it left the arm for the first time.
        left_last: by the box as it left the arm for the last time.
        rest: in the engine.
        contacts: how often the arm touched the box.
        largest_error: rad, between the servos' reference and the joints until the touch.
    """

    swing: Swing
    setting: EngineSetting
    touch: FirstTouch
    meant: BoxRest
    touched: BoxRest
    left: BoxRest
    left_last: BoxRest
    rest: BoxRest
    contacts: int
    largest_error: float

    @property
    def miss(self) -> float:
        """Distance of the rest from where it was meant to be, m."""
        return self.rest.miss(self.meant)

    @property
    def steps(self) -> dict[str, Array]:
        """By how much each cause moves the rest, (3,) m; together they make the miss."""
        ways = self.meant, self.touched, self.left, self.left_last, self.rest
        return {
            cause: other.place - one.place
            for cause, one, other in zip(CAUSES, ways[:-1], ways[1:], strict=True)
        }

    @property
    def shares(self) -> dict[str, float]:
        """How far each cause moves the rest, m."""
        return {cause: float(np.linalg.norm(step)) for cause, step in self.steps.items()}

    @property
    def along(self) -> dict[str, float]:
        """How far each cause moves the rest along the way that was meant, m, with its sign."""
        way = self.meant.place - self.swing.hit.position
        ahead = way / np.linalg.norm(way)
        return {cause: float(ahead @ step) for cause, step in self.steps.items()}

    def as_dict(self) -> dict[str, Any]:
        """Return the result as JSON knows it."""
        return {
            "meant": self.meant.as_dict(),
            "rest": self.rest.as_dict(),
            "miss": self.miss,
            "shares": self.shares,
            "along": self.along,
            "contacts": self.contacts,
            "largest_error": self.largest_error,
            "touch": {"time": self.touch.time, "speed": self.touch.speed},
        }
