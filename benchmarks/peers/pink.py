"""Pink: differential inverse kinematics, repeated until it arrives."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin

import hitjoints as hj

STEPS = 30  # before a restart
NEAR = 1e-6  # m


class PinkArm:
    """One joint of an arm."""

    def __init__(self, robot: hj.Robot, joint: int) -> None:
        import daqp  # noqa: F401  (the solver that makes Pink fastest)
        import pink

        self.pink, self.robot = pink, robot
        self.frame = robot.joint_names[joint - 1]
        self.task = pink.tasks.FrameTask(
            self.frame, position_cost=1.0, orientation_cost=0.0, lm_damping=1e-6
        )

    def place(self, target: Any, rng: np.random.Generator) -> Any:
        """Return q (n,) that puts the joint at a target (3,)."""
        robot = self.robot
        self.task.set_target(pin.SE3(np.eye(3), target))
        for _ in range(40):
            start = rng.uniform(robot.lower, robot.upper)
            arm = self.pink.Configuration(robot.model, robot.data, start)
            for _ in range(STEPS):
                here = arm.get_transform_frame_to_world(self.frame).translation
                if np.linalg.norm(here - target) < NEAR:
                    return arm.q
                velocity = self.pink.solve_ik(arm, [self.task], 1.0, solver="daqp")
                arm.integrate_inplace(velocity, 1.0)
        return None
