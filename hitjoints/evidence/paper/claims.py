"""What the paper says beside its figures: where joints 4 and 5 can move (Section V)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from hitjoints.dynamics.kinematics import feasible_directions, jacobian, position
from hitjoints.evidence.paper.claim_rows import Item, Value, Values
from hitjoints.programs.hitting_speed import box_speed
from hitjoints.quantities import place_joint

if TYPE_CHECKING:
    from hitjoints.evidence.paper.scenario import Scenario
    from hitjoints.model.robot import Robot

CONFIGURATIONS = 500


def claim_values(robot: Robot, scenario: Scenario) -> Values:
    """Return the values of `LINES` on one arm."""
    rng = np.random.default_rng(scenario.seed)
    many = rng.uniform(robot.lower, robot.upper, (CONFIGURATIONS, robot.n))
    values: dict[str, Value] = {}
    q = place_joint(robot, 5, scenario.position, start=robot.home).q[0]
    values["easiest_5"] = float(feasible_directions(robot, q, 5).speed.max())
    for k in (4, 5):
        ranks = [feasible_directions(robot, q, k).rank for q in many]
        values[f"rank_{k}"] = max(ranks)
        values[f"share_{k}"] = 100 * float(np.mean([rank == max(ranks) for rank in ranks]))
        radii = [np.linalg.norm(position(robot, q, k) - position(robot, q, 2)) for q in many]
        values[f"radius_{k}"], values[f"change_{k}"] = float(np.mean(radii)), float(np.ptp(radii))
        radial = position(robot, q, k) - position(robot, q, 2)
        pull = radial / np.linalg.norm(radial) @ jacobian(robot, q, k)
        speed = box_speed(pull, robot.velocity_lower, robot.velocity_upper)[0]
        values[f"radial_{k}"] = round(speed, 12)  # a zero that was computed
    return values


LINES = (
    Item("radius_4", "text", "joint 4: distance from joint 2 (m)", "a sphere",
         "The length of the upper arm."),
    Item("change_4", "text", "joint 4: change of that distance over the workspace (m)", "a sphere",
         "As stated: joint 4 stays on a sphere about joint 2."),
    Item("rank_4", "text", "joint 4: rank of its Jacobian", "a sphere",
         "As stated: a sphere's tangent plane. Where joint 2 is at zero it drops to 1."),
    Item("radial_4", "text", "joint 4: greatest speed away from joint 2 (m/s)", "a sphere",
         "As stated."),
    Item("rank_5", "text", "joint 5: rank of its Jacobian", "tangential only",
         "Differs: the elbow changes the distance of joint 5 from joint 2, by up to "
         "{bullet[change_5]:.2g} m over the workspace. {bullet[share_5]:.4g} % of random "
         "configurations have rank 3; a straight elbow does not. The paper's sentence is true of "
         "joint 4."),
    Item("radial_5", "text", "joint 5: greatest speed away from joint 2, at the object (m/s)",
         "tangential only", "Differs, for the same reason; in its easiest direction it reaches "
         "{bullet[easiest_5]:.3g} m/s."),
)  # fmt: skip
