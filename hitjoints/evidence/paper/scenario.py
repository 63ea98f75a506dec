"""What is asked of the arm where the paper does not print it; chosen once, and not to fit."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from hitjoints.types import Array

JOINTS = (7, 6, 5)
"""The paper's hitting joints, in the order of its Fig. 5."""
PRINTED = {7: 2.5, 6: 3.9}
"""kg, the paper's inertia at the impact with joints 7 and 6, and"""
PRINTED_MORE = 56.0
"""%, by how much joint 6 has more."""
VELOCITIES = (1.48, 1.48, 1.74, 1.30, 2.26, 2.35, 2.35)
"""rad/s, the velocity limits in the authors' simulation (epfl-lasa/hitting_sim)."""


@dataclass(frozen=True)
class Scenario:
    """One hit, asked of each of the joints.

    The object is where the commands of hitjoints put it by default. The start lies on the line
    through it, straight in front of the arm, so that the field of Eq. 5 has no error to correct.

    Attributes:
        position: (3,) m, of the object.
        direction: (3,), unit.
        mass: kg, the paper's.
        run_up: m, from the start to the object.
        flux: m/s, desired.
        setups: start positions tried in the study of the spread.
        seed: of these.
        low: (3,) m, the box around the arm that they lie in.
        high: (3,) m, the box around the arm that they lie in.
        samples: inverse kinematics solutions of the start that Eq. 14 is tried from.
        dt: s, control step.
    """

    position: tuple[float, float, float] = (0.5, 0.3, 0.5)
    direction: tuple[float, float, float] = (0.0, 1.0, 0.0)
    mass: float = 2.0
    run_up: float = 0.3
    flux: float = 0.3
    setups: int = 12000
    seed: int = 0
    low: tuple[float, float, float] = (-0.8, -0.8, 0.0)
    high: tuple[float, float, float] = (0.8, 0.8, 1.0)
    samples: int = 300
    dt: float = 0.002

    @property
    def h(self) -> Array:
        """The hitting direction."""
        return np.array(self.direction)

    @property
    def start(self) -> Array:
        """Where the hitting joint starts, (3,) m."""
        return np.array(self.position) - self.run_up * self.h
