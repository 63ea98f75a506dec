"""Plans by another path: Pinocchio, NumPy and SciPy alone, random samples and SLSQP."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
from scipy.optimize import linprog, minimize


class Reference:
    """Hits of one joint, evaluated one configuration at a time."""

    def __init__(self, robot, joint, position, direction, mass, away):
        self.model, self.data = robot.model, robot.model.createData()
        self.lower, self.upper = robot.lower, robot.upper
        self.qd_lower, self.qd_upper = robot.velocity_lower, robot.velocity_upper
        self.joint, self.position, self.mass, self.away = joint, position, mass, away
        self.h = np.asarray(direction) / np.linalg.norm(direction)
        self.B = np.linalg.svd(self.h[None])[2][1:]
        self.last = joint == robot.n
        self.flange = np.array(robot.flange.offset)

    def frames(self, q):
        pin.computeJointJacobians(self.model, self.data, q)
        J = pin.getJointJacobian(self.model, self.data, self.joint, pin.LOCAL_WORLD_ALIGNED)[:3]
        here = self.data.oMi[self.joint].translation
        after = (
            self.data.oMi[self.joint].act(self.flange)
            if self.last
            else self.data.oMi[self.joint + 1].translation
        )
        return here.copy(), J.copy(), float(self.h @ (after - here))

    def inertia(self, q):
        J = self.frames(q)[1]
        g = self.h @ J
        return 1.0 / (g @ np.linalg.solve(pin.crba(self.model, self.data, q), g))

    def flux(self, q):
        g = self.h @ self.frames(q)[1]
        speed = np.maximum(g * self.qd_upper, g * self.qd_lower).sum()
        return speed / (1 + self.mass / self.inertia(q))

    def straight_flux(self, q):
        J = self.frames(q)[1]
        bounds = list(zip(self.qd_lower, self.qd_upper, strict=True))
        found = linprog(-(self.h @ J), A_eq=self.B @ J, b_eq=np.zeros(2), bounds=bounds)
        return -found.fun / (1 + self.mass / self.inertia(q)) if found.status == 0 else 0.0

    def samples(self, count, rng):
        """Random configurations at the position, by damped Newton steps clamped to the limits."""
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

    def best(self, objective, rng, samples=250, starts=6, least_flux=None):
        """The greatest value found; None if no sample is admissible."""
        value = {
            "inertia": self.inertia,
            "rebound": self.inertia,
            "flux": self.flux,
            "straight-flux": self.straight_flux,
        }[objective]
        drawn = self.samples(samples, rng)
        if least_flux is not None:
            drawn = sorted(drawn, key=self.flux)[::-1][: 4 * starts]
        ranked = sorted(drawn, key=self.flux if objective == "straight-flux" else value)[::-1]
        best = None
        for q in ranked[:starts]:
            end = self.improve(q, objective, value, least_flux)
            here, _, gap = self.frames(end)
            ok = np.linalg.norm(here - self.position) < 1e-5 and (gap < 1e-7 or not self.away)
            ok = ok and (least_flux is None or self.flux(end) >= least_flux * (1 - 1e-6))
            if ok:
                best = max(best or 0.0, value(end))
        return best

    def improve(self, q, objective, value, least_flux):
        n = len(q)
        straight = objective == "straight-flux"
        constraints = [
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
            J = self.frames(q)[1]
            qd_bounds = list(zip(self.qd_lower, self.qd_upper, strict=True))
            found = linprog(-(self.h @ J), A_eq=self.B @ J, b_eq=np.zeros(2), bounds=qd_bounds)
            start, bounds = np.concatenate((q, found.x)), bounds + qd_bounds
            constraints.append(
                {"type": "eq", "fun": lambda x: self.B @ self.frames(x[:n])[1] @ x[n:]}
            )

        def cost(x):
            if not straight:
                return -np.log(value(x))
            speed = self.h @ self.frames(x[:n])[1] @ x[n:]
            return -np.log(max(speed, 1e-9) / (1 + self.mass / self.inertia(x[:n])))

        run = minimize(
            cost, start, method="SLSQP", bounds=bounds, constraints=constraints,
            options={"maxiter": 80, "ftol": 1e-8},
        )  # fmt: skip
        return np.clip(run.x[:n], self.lower, self.upper)
