"""Plans by Pinocchio, NumPy and SciPy alone: samples and SLSQP, or differential evolution."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pinocchio as pin
from scipy.optimize import differential_evolution, linprog, minimize

import hitjoints as hj

PENALTY = 10.0  # 1/m, of the logarithm of the objective: what being away from the object costs
GENERATIONS = 150
NEAR, AWAY = 1e-5, 1e-7  # m, by which an answer may miss the object and the away condition


class SciPyPlanner:
    """Searches the configuration to hit with, one evaluation at a time."""

    def __init__(
        self, robot: hj.Robot, joint: int, position: Any, direction: Any, mass: float, away: bool
    ) -> None:
        self.model, self.data = robot.model, robot.model.createData()
        self.lower, self.upper = robot.lower, robot.upper
        self.qd_lower, self.qd_upper = robot.velocity_lower, robot.velocity_upper
        self.joint, self.position, self.mass, self.away = joint, position, mass, away
        self.h = np.asarray(direction) / np.linalg.norm(direction)
        self.B = np.linalg.svd(self.h[None])[2][1:]
        self.last = joint == robot.n
        self.flange = np.array(robot.flange.offset)
        self.values: dict[str, Callable[[Any], float]] = {
            "inertia": self.inertia,
            "rebound": self.inertia,
            "flux": self.flux,
            "straight-flux": self.straight_flux,
            "deliverable": self.deliverable_flux,
        }
        # Without a known jerk limit the acceleration is built up in a hundredth of a second.
        self.a = robot.acceleration
        self.j = robot.jerk if robot.jerk is not None or self.a is None else 100.0 * self.a

    def frames(self, q: Any) -> tuple[Any, Any, float]:
        """Return the joint's position, its Jacobian, and how far the next one is along h."""
        pin.computeJointJacobians(self.model, self.data, q)
        J = pin.getJointJacobian(self.model, self.data, self.joint, pin.LOCAL_WORLD_ALIGNED)[:3]
        here = self.data.oMi[self.joint].translation
        after = (
            self.data.oMi[self.joint].act(self.flange)
            if self.last
            else self.data.oMi[self.joint + 1].translation
        )
        return here.copy(), J.copy(), float(self.h @ (after - here))

    def inertia(self, q: Any) -> float:
        """Return the directional inertia, kg."""
        g = self.h @ self.frames(q)[1]
        return float(1.0 / (g @ np.linalg.solve(pin.crba(self.model, self.data, q), g)))

    def flux(self, q: Any) -> float:
        """Return the greatest flux, m/s."""
        g = self.h @ self.frames(q)[1]
        speed = np.maximum(g * self.qd_upper, g * self.qd_lower).sum()
        return float(speed / (1 + self.mass / self.inertia(q)))

    def straight_flux(self, q: Any) -> float:
        """Return the greatest flux of a motion straight along h, m/s."""
        J = self.frames(q)[1]
        found = self._fastest(J)
        return -found.fun / (1 + self.mass / self.inertia(q)) if found.status == 0 else 0.0

    def deliverable_flux(self, q: Any) -> float:
        """Return the greatest straight flux at speeds that leave room to stop on either side, m/s.

        v^2 / a + v a / j <= 2 room, of which 98 % are used.
        """
        assert self.a is not None
        assert self.j is not None
        room = np.maximum(self.room(q), 0.0)
        most = -0.5 * self.a**2 / self.j + np.sqrt(0.25 * self.a**4 / self.j**2 + 2 * room * self.a)
        low, high = np.maximum(self.qd_lower, -most), np.minimum(self.qd_upper, most)
        found = self._fastest(self.frames(q)[1], low, high)
        return -found.fun / (1 + self.mass / self.inertia(q)) if found.status == 0 else 0.0

    def room(self, q: Any) -> Any:
        """Return the usable way to the nearer position limit, (n,) rad."""
        return 0.98 * np.minimum(q - self.lower, self.upper - q)

    def samples(self, count: int, rng: np.random.Generator) -> list[Any]:
        """Return random configurations at the position, by damped Newton steps within limits."""
        low = np.where(np.isfinite(self.lower), self.lower, -np.pi)
        high = np.where(np.isfinite(self.upper), self.upper, np.pi)
        found = []
        for _ in range(count):
            q = rng.uniform(low, high)
            for _ in range(40):
                here, J, gap = self.frames(q)
                error = self.position - here
                if np.linalg.norm(error) < 1e-7:
                    break
                step = J.T @ np.linalg.solve(J @ J.T + 1e-6 * np.eye(3), error)
                q = np.clip(q + step * min(1, 0.5 / np.abs(step).max()), self.lower, self.upper)
            if np.linalg.norm(error) < 1e-7 and (gap < 0 or not self.away):
                found.append(q)
        return found

    def by_slsqp(
        self,
        objective: str,
        rng: np.random.Generator,
        samples: int = 250,
        starts: int = 6,
        least_flux: float | None = None,
    ) -> float | None:
        """Return the greatest value that SLSQP reaches from the best of some samples, if any."""
        value = self.values[objective]
        drawn = self.samples(samples, rng)
        if least_flux is not None:
            drawn = sorted(drawn, key=self.flux)[::-1][: 4 * starts]
        straight = objective in ("straight-flux", "deliverable")
        ranked = sorted(drawn, key=self.flux if straight else value)[::-1]
        ends = [self.improve(q, objective, least_flux) for q in ranked[:starts]]
        return max(
            (
                value(q)
                for q in ends
                if self.admissible(q)
                and (least_flux is None or self.flux(q) >= least_flux * (1 - 1e-6))
            ),
            default=None,
        )

    def by_evolution(self, objective: str, seed: int = 0) -> float | None:
        """Return what differential evolution and SLSQP after it reach, if it can be used."""
        value = self.values[objective]

        def cost(q: Any) -> float:
            here, _, gap = self.frames(q)
            beyond = max(gap, 0.0) if self.away else 0.0
            off = float(np.linalg.norm(here - self.position))
            return float(-np.log(value(q)) + PENALTY * (off + beyond))

        bounds = list(zip(self.lower, self.upper, strict=True))
        found = differential_evolution(
            cost, bounds, rng=seed, maxiter=GENERATIONS, polish=False, tol=1e-6
        )
        end = self.improve(found.x, objective, None)
        return value(end) if self.admissible(end) else None

    def admissible(self, q: Any) -> bool:
        """Tell whether q (n,) is at the object, the links behind away from it."""
        here, _, gap = self.frames(q)
        near = bool(np.linalg.norm(here - self.position) < NEAR)
        return near and (gap < AWAY or not self.away)

    def improve(self, q: Any, objective: str, least_flux: float | None) -> Any:
        """Return where SLSQP ends from q (n,)."""
        n = len(q)
        straight = objective in ("straight-flux", "deliverable")
        constraints: list[Any] = [
            {
                "type": "eq",
                "fun": lambda x: self.frames(x[:n])[0] - self.position,
                "jac": lambda x: np.hstack((self.frames(x[:n])[1], np.zeros((3, len(x) - n)))),
            }
        ]
        if self.away:
            constraints.append({"type": "ineq", "fun": lambda x: -self.frames(x[:n])[2]})
        if least_flux is not None:
            constraints.append({"type": "ineq", "fun": lambda x: self.flux(x[:n]) / least_flux - 1})
        bounds = list(zip(self.lower, self.upper, strict=True))
        start = q
        if straight:
            # The joint velocities become variables: the linear program's value has kinks in q.
            start = np.concatenate((q, self._fastest(self.frames(q)[1]).x))
            bounds += list(zip(self.qd_lower, self.qd_upper, strict=True))
            constraints.append(
                {"type": "eq", "fun": lambda x: self.B @ self.frames(x[:n])[1] @ x[n:]}
            )
        if objective == "deliverable":
            constraints.append(
                {
                    "type": "ineq",
                    "fun": lambda x: (
                        2 * self.room(x[:n]) - x[n:] ** 2 / self.a - abs(x[n:]) * self.a / self.j
                    ),
                }
            )

        def cost(x: Any) -> float:
            if not straight:
                return float(-np.log(self.values[objective](x)))
            speed = self.h @ self.frames(x[:n])[1] @ x[n:]
            return float(-np.log(max(speed, 1e-9) / (1 + self.mass / self.inertia(x[:n]))))

        run = minimize(
            cost, start, method="SLSQP", bounds=bounds, constraints=constraints,
            options={"maxiter": 80, "ftol": 1e-8},
        )  # fmt: skip
        return np.clip(run.x[:n], self.lower, self.upper)

    def _fastest(self, J: Any, low: Any = None, high: Any = None) -> Any:
        low, high = (self.qd_lower if low is None else low, self.qd_upper if high is None else high)
        bounds = np.column_stack((low, high))
        return linprog(-(self.h @ J), A_eq=self.B @ J, b_eq=np.zeros(2), bounds=bounds)
