"""What stands around the hit, and how much room the arm must leave it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from hitjoints.errors import InputError, ModelError
from hitjoints.planning.room.clearance import Clearance, clearance

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from hitjoints.hit import Hit
    from hitjoints.model.robot import Contact, Robot

APPROACH = 0.1  # m, of straight approach that is looked at


@dataclass(frozen=True)
class Surroundings:
    """The object's size, the table, and the margin asked for.

    Attributes:
        object_size: edges of the box that is hit, m; None leaves it out.
        table_height: z of the table's plane, m; None for no table.
        margin: least distance, m, of the rest of the arm from the object, the table and itself,
            in the hitting configuration and along the straight approach. None only reports it.
    """

    object_size: tuple[float, float, float] | None = None
    table_height: float | None = None
    margin: float | None = None

    @classmethod
    def of(cls, hit: Hit) -> Surroundings:
        """Return what a hit says stands around it; its box is held by one with the base's axes."""
        setting = hit.setting
        size = setting.object_size
        if size is None and hit.size is not None:
            size = _held(hit.size, hit.direction, hit.yaw)
        return cls(size, setting.table_height, setting.margin)

    def __post_init__(self) -> None:
        if self.margin is not None and not np.isfinite(self.margin):
            raise InputError("margin", self.margin, "a finite distance in metres")

    @property
    def asked_for(self) -> bool:
        """Tell whether anything is asked for beyond reporting the arm's distance from itself."""
        return any(v is not None for v in (self.object_size, self.table_height, self.margin))

    def report(
        self, robot: Robot, q: NDArray[np.float64], contact: Contact, h: NDArray[np.float64]
    ) -> dict[str, Any]:
        """Return the clearance by name, or `{"not_known": reason}` if nothing was asked for.

        Raises:
            ModelError: the shapes are missing or cannot be read, and something was asked for.
        """
        try:
            return self.clearance(robot, q, contact, h).as_dict()
        except ModelError as error:
            if self.asked_for:
                raise
            return {"not_known": error.reason}

    def clearance(
        self, robot: Robot, q: NDArray[np.float64], contact: Contact, h: NDArray[np.float64]
    ) -> Clearance:
        """Return the least distances at q (n,) and along the straight approach to it."""
        room = self.object_size, self.table_height
        return clearance(robot, q, contact, h, *room, approach=APPROACH)

    def look(
        self, robot: Robot, q: NDArray[np.float64], contact: Contact, h: NDArray[np.float64]
    ) -> Clearance:
        """Return the clearance at q (n,), of the approach too where q alone keeps the margin."""
        # The configuration alone is a hundred times cheaper, and refuses most.
        here = clearance(robot, q, contact, h, self.object_size, self.table_height)
        short = self.margin is not None and here.least < self.margin
        return here if short else self.clearance(robot, q, contact, h)


def _held(
    size: NDArray[np.float64], h: NDArray[np.float64], yaw: float
) -> tuple[float, float, float]:
    """Return the edges (m) of the box with the base's axes that holds a box along a direction."""
    across = np.cross((0.0, 0.0, 1.0), h)
    across = across / np.linalg.norm(across) if across.any() else np.array((0.0, 1.0, 0.0))
    axes = np.column_stack((h, across, np.cross(h, across)))
    turned = np.array(((np.cos(yaw), -np.sin(yaw), 0), (np.sin(yaw), np.cos(yaw), 0), (0, 0, 1)))
    x, y, z = np.abs(axes @ turned) @ size
    return float(x), float(y), float(z)
