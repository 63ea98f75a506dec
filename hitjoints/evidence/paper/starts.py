"""Where each joint starts from, by Eq. 14 (Section IV-B), and the hit from there."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from hitjoints.dynamics.inertia import inertia_along
from hitjoints.hit import Hit
from hitjoints.model.robot import Contact
from hitjoints.planning.posture import Posture, posture
from hitjoints.quantities import place_joint
from hitjoints.rollouts.follow import rollout

if TYPE_CHECKING:
    from hitjoints.evidence.paper.scenario import Scenario
    from hitjoints.hitting.controller import ReferenceName
    from hitjoints.hitting.laws import LawName
    from hitjoints.model.robot import Robot
    from hitjoints.rollouts.record import Rollout
    from hitjoints.types import Array


@dataclass(frozen=True, eq=False)
class PaperStart:
    """A start configuration.

    Attributes:
        joint: k.
        placed: (n,) rad, the inverse kinematics solution reached from the robot's home: the common
            configuration of the paper's Section III-A. It sets q_1 .. q_{k-1}.
        placed_inertia: kg, there, before Eq. 14.
        posture: with q_k .. q_n by Eq. 14, the global maximum; `posture.q` is the start.
    """

    joint: int
    placed: Array
    placed_inertia: float
    posture: Posture


def paper_start(robot: Robot, joint: int, scenario: Scenario) -> PaperStart:
    """Place joint k at the scenario's start position, then turn the joints beyond it by Eq. 14.

    Raises:
        InfeasibleError: no posture points away from the object.
    """
    placed = place_joint(robot, joint, scenario.start, start=robot.home).q[0]
    chosen = posture(robot, placed, joint, scenario.direction, certificate=False)
    before = inertia_along(robot, placed, Contact(joint), scenario.h)
    return PaperStart(joint, placed, before, chosen)


def hit_from(
    robot: Robot,
    start: PaperStart,
    scenario: Scenario,
    *,
    reference: ReferenceName = "optimised",
    law: LawName = "paper",
) -> Rollout:
    """Roll the scenario's hit out from a start, by Eq. 5 and Eq. 7 as printed by default."""
    at = np.array(scenario.position)
    hit = Hit(start.joint, at, scenario.h, scenario.mass, scenario.flux)
    return rollout(
        robot,
        hit,
        q0=start.posture.q,
        dt=scenario.dt,
        reference=reference,
        law=law,
        speed_profile="paper",
    )
