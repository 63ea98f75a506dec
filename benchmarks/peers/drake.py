"""Drake: mass matrix and Jacobian of a MultibodyPlant, its automatic derivatives."""

from __future__ import annotations

from typing import Any

import numpy as np

import hitjoints as hj
from benchmarks.peers.urdf import urdf_path


class DrakeArm:
    """One joint of an arm."""

    def __init__(self, robot: hj.Robot, joint: int) -> None:
        from pydrake import autodiffutils
        from pydrake.multibody.parsing import Parser
        from pydrake.multibody.plant import MultibodyPlant
        from pydrake.multibody.tree import JacobianWrtVariable

        self.wrt_v, self.autodiff = JacobianWrtVariable.kV, autodiffutils
        self.plant = MultibodyPlant(time_step=0.0)
        Parser(self.plant).AddModels(urdf_path(robot.name))
        base = self.plant.GetFrameByName("link_0")
        self.plant.WeldFrames(self.plant.world_frame(), base)
        self.plant.Finalize()
        self.context = self.plant.CreateDefaultContext()
        self.dual_plant = self.plant.ToAutoDiffXd()
        self.dual_context = self.dual_plant.CreateDefaultContext()
        self.link, self.joint = f"link_{joint}", joint

    def inertia(self, q: Any, h: Any) -> float:
        """Return 1 / (h^T J M^-1 J^T h), kg."""
        self.plant.SetPositions(self.context, q)
        M, pull = self._terms(self.plant, self.context, h)
        return float(1.0 / (pull @ np.linalg.solve(M, pull)))

    def gradient(self, q: Any, h: Any) -> Any:
        """Return its gradient (n,) kg/rad: of g^T u and of u^T M u, with u = M^-1 g held fixed."""
        dual = self.autodiff
        self.dual_plant.SetPositions(self.dual_context, dual.InitializeAutoDiff(q).ravel())
        M, pull = self._terms(self.dual_plant, self.dual_context, h)
        g = dual.ExtractValue(pull).ravel()
        u = np.linalg.solve(dual.ExtractValue(M), g)
        mobility = 2 * (pull @ u) - u @ (M @ u)
        return -mobility.derivatives() / (g @ u) ** 2

    def place(self, target: Any, rng: np.random.Generator) -> Any:
        """Return q (n,) that puts the joint at a target (3,), by Drake's InverseKinematics."""
        from pydrake.multibody.inverse_kinematics import InverseKinematics
        from pydrake.solvers import Solve

        plant = self.plant
        lower, upper = plant.GetPositionLowerLimits(), plant.GetPositionUpperLimits()
        frame, world = plant.GetFrameByName(self.link), plant.world_frame()
        for _ in range(400):
            problem = InverseKinematics(plant)
            problem.AddPositionConstraint(frame, np.zeros(3), world, target, target)
            start = rng.uniform(lower, upper)
            found = Solve(problem.prog(), start)
            if found.is_success():
                return found.GetSolution(problem.q())
        return None

    def _terms(self, plant: Any, context: Any, h: Any) -> tuple[Any, Any]:
        world, frame = plant.world_frame(), plant.GetFrameByName(self.link)
        J = plant.CalcJacobianTranslationalVelocity(
            context, self.wrt_v, frame, np.zeros(3), world, world
        )
        return plant.CalcMassMatrix(context), h @ J
