"""The hitting field: the velocity that leads a contact point onto the line of the hit (Eq. 5-6)."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cached_property
from operator import mul
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from hitjoints.errors import InfeasibleError, InputError
from hitjoints.vectors import number, points, real

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Vector = NDArray[np.float64]

SIGMA = 0.01
"""m, the default width of the field: the authors' code divides by the square of 0.1."""
RATE = 20.0
"""1/s, the default -A: one tenth per step of 5 ms, well within what an Euler step follows."""
STEPS_PER_SCALE = 20  # integration steps in the shortest time in which anything changes
MOST_STEPS = 20_000
ON_THE_LINE = 1e-9  # m; the error only shrinks from here on


def _default_rates() -> Vector:
    return -RATE * np.eye(3)


@dataclass(frozen=True, eq=False)
class HittingField:
    """A velocity field whose streamlines join the line through the target along the velocity.

    f(chi) = alpha v + (1 - alpha) A (chi - chi_v), alpha = exp(-|chi - chi_v| / sigma), where v is
    the desired velocity and chi_v the projection of chi on the line (Eq. 5-6).

    The lateral error e = chi - chi_v obeys de/dt = (1 - alpha) P A e, P the projection across the
    line, so |e| never grows. Near the line that is -|A| e^2 / sigma: the error fades as 1/t there,
    not exponentially. `distance_to_settle` says what that costs.

    Attributes:
        target: (3,) m, where the object is hit.
        velocity: (3,) m/s, desired at the target, not zero.
        sigma: m, > 0, how near the line the desired velocity takes over.
        A: (3, 3) 1/s, symmetric negative definite.
        speed_profile: "paper" for Eq. 5 as it is; "constant" rescales it to the speed |velocity|
            everywhere, as the authors' code does. The streamlines are the same.

    Raises:
        InputError: an argument is out of its range, of wrong shape or not finite.
    """

    target: Vector
    velocity: Vector
    sigma: float = SIGMA
    A: Vector = field(default_factory=_default_rates)
    speed_profile: Literal["paper", "constant"] = "paper"

    def __post_init__(self) -> None:
        for name in ("target", "velocity"):
            vector = points(getattr(self, name), name)
            if vector.shape != (3,):
                raise InputError(name, f"shape {vector.shape}", "three numbers x,y,z")
            object.__setattr__(self, name, _frozen(vector))
        if not self.speed > 0:
            raise InputError("velocity", self.velocity.tolist(), "it must not be zero")
        object.__setattr__(self, "sigma", _positive("sigma", self.sigma))
        object.__setattr__(self, "A", _frozen(_negative_definite(self.A)))
        if self.speed_profile not in ("paper", "constant"):
            raise InputError("speed_profile", repr(self.speed_profile), "'paper' or 'constant'")

    @cached_property
    def speed(self) -> float:
        """|velocity|, m/s."""
        return float(np.linalg.norm(self.velocity))

    @cached_property
    def direction(self) -> Vector:
        """(3,) unit vector of the velocity."""
        return _frozen(self.velocity / self.speed)

    @cached_property
    def _components(self) -> tuple[list[float], list[list[float]]]:
        """The direction and A as plain numbers."""
        return self.direction.tolist(), self.A.tolist()

    def __call__(self, position: ArrayLike, speed: float | None = None) -> Vector:
        """Return the velocity (3,) m/s that the field asks for at a position (3,) m.

        Args:
            position: (3,) m.
            speed: m/s, desired in place of |velocity|, for an arm whose inertia changes on the way.

        Raises:
            InputError: the position is not three finite numbers.
        """
        return self._at(_one(position), self.speed if speed is None else speed)

    def virtual(self, position: ArrayLike) -> Vector:
        """Return chi_v (3,) m, the projection of a position (3,) m on the line of the hit."""
        h = self.direction
        return np.asarray(self.target + h * (h @ (_one(position) - self.target)))

    def lateral_error(self, position: ArrayLike) -> float:
        """Return |chi - chi_v| (m), the distance of a position (3,) m from the line."""
        return float(np.linalg.norm(_one(position) - self.virtual(position)))

    def predicted_miss(self, start: ArrayLike) -> float:
        """Return how far from the target (m) the streamline from `start` passes it.

        The streamline is integrated (Runge-Kutta of order 4) until it crosses the plane through
        the target across the velocity.

        Args:
            start: (3,) m, behind that plane.

        Raises:
            InputError: the start is not three finite numbers, or lies beyond the plane.
            InfeasibleError: the streamline has not reached the plane when the step count ends.
        """
        h, here = self.direction, _one(start)
        ahead = float(h @ (self.target - here))
        if ahead < 0:
            raise InputError("start", here.tolist(), f"it lies {-ahead:.3g} m beyond the target")
        if ahead == 0:
            return self.lateral_error(here)
        fastest = max(-float(np.linalg.eigvalsh(self.A)[0]), self.speed / self.sigma)
        dt = 1.0 / (STEPS_PER_SCALE * fastest)
        for _ in range(MOST_STEPS):
            following = self._step(here, dt)
            left = float(h @ (self.target - following))
            if left <= 0:
                part = ahead / (ahead - left) if left < ahead else 0.0  # a step shorter than a bit
                return self.lateral_error(here + part * (following - here))
            here, ahead = following, left
            if self.lateral_error(here) < ON_THE_LINE:
                return self.lateral_error(here)
        raise InfeasibleError(
            f"the field does not bring the start to the target in {MOST_STEPS * dt:.3g} s",
            {"left": ahead},
        )

    def distance_to_settle(self, lateral: float, tolerance: float) -> float:
        """Return the run-up (m) in which a lateral error shrinks to a tolerance.

        |v| / a times the integral of de / (e (exp(e / sigma) - 1)) from the tolerance to the
        error, with a the slowest rate of A across the line. Exact for A = -a I.

        Args:
            lateral: m, at the start, >= 0.
            tolerance: m, at the target, > 0.

        Raises:
            InputError: an argument is out of its range.
        """
        tolerance = _positive("tolerance", tolerance)
        number(lateral, "lateral", "a length in m, not below zero", lambda value: value >= 0)
        if lateral <= tolerance:
            return 0.0
        across = np.linalg.svd(self.direction[None, :])[2][1:]
        slowest = -float(np.linalg.eigvalsh(across @ self.A @ across.T)[-1])
        # In x = ln e the integrand is smooth: Gauss-Legendre gives about ten digits a panel.
        nodes, weights = np.polynomial.legendre.leggauss(40)
        low, high = math.log(tolerance), math.log(min(lateral, 50 * self.sigma + tolerance))
        e = np.exp((high - low) / 2 * nodes + (high + low) / 2)
        integral = (high - low) / 2 * float(weights @ (1.0 / np.expm1(e / self.sigma)))
        return self.speed / slowest * integral

    def _at(self, position: Vector, speed: float) -> Vector:
        # In a control loop: three numbers one by one take a third of the time of small arrays.
        h, rows = self._components
        offset = (position - self.target).tolist()
        along = sum(map(mul, h, offset))
        error = [x - along * d for x, d in zip(offset, h, strict=True)]
        alpha = math.exp(-math.hypot(*error) / self.sigma)
        f = [
            alpha * speed * d + (1.0 - alpha) * sum(map(mul, row, error))
            for d, row in zip(h, rows, strict=True)
        ]
        if self.speed_profile == "constant":
            size = math.hypot(*f)
            f = [speed / size * x for x in f] if size > 0 else [speed * d for d in h]
        return np.array(f)

    def _step(self, x: Vector, dt: float) -> Vector:
        k1 = self._at(x, self.speed)
        k2 = self._at(x + dt / 2 * k1, self.speed)
        k3 = self._at(x + dt / 2 * k2, self.speed)
        k4 = self._at(x + dt * k3, self.speed)
        return np.asarray(x + dt / 6 * (k1 + 2 * k2 + 2 * k3 + k4))


def _one(position: ArrayLike) -> Vector:
    array = points(position, "position")
    if array.shape != (3,):
        raise InputError("position", f"shape {array.shape}", "three numbers x,y,z")
    return array


def _positive(name: str, value: Any) -> float:
    return number(value, name, "a finite number above zero", lambda found: found > 0)


def _negative_definite(A: ArrayLike) -> Vector:
    matrix = real(A, "A", "a 3 x 3 matrix")
    if matrix.shape != (3, 3) or not np.isfinite(matrix).all():
        raise InputError("A", matrix.tolist(), "a 3 x 3 matrix of finite numbers")
    if np.abs(matrix - matrix.T).max() > 1e-12 * np.abs(matrix).max():
        raise InputError("A", matrix.tolist(), "must be symmetric")
    if not np.linalg.eigvalsh(matrix)[-1] < 0:
        raise InputError("A", matrix.tolist(), "must be negative definite")
    return matrix


def _frozen(values: Vector) -> Vector:
    array = np.array(values, dtype=float)
    array.setflags(write=False)
    return array
