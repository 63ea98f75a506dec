"""The first time at which a sum of exponentials falls to zero, with none missed in between."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

POINTS = 48
"""Times at which each stretch is looked at before any interval of it is halved."""
HALVINGS = 40
"""After which an interval in which the value may touch zero counts as free of zeros: what is missed
is shallower than 1e-20 of the value's scale."""
REFINEMENTS = 60


@dataclass(frozen=True, eq=False)
class Exponentials:
    """The value Re sum_k amplitude_k exp(rate_k t) + offset + slope t, with rates that decay.

    Attributes:
        amplitude: (K,) complex.
        rate: (K,) complex 1/s, with real parts that are not above zero but by rounding.
        offset: real.
        slope: real, per s.
    """

    amplitude: NDArray[np.complex128]
    rate: NDArray[np.complex128]
    offset: float = 0.0
    slope: float = 0.0

    def __call__(self, time: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the value at times (T,) s."""
        waves = np.exp(np.multiply.outer(time, self.rate)) @ self.amplitude
        return np.asarray(waves.real + (self.offset + self.slope * time))

    def __neg__(self) -> Exponentials:
        """Return the same with the other sign."""
        return Exponentials(-self.amplitude, self.rate, -self.offset, -self.slope)

    def integral(self, until: float) -> float:
        """Return the integral from 0 to a time."""
        rate = np.where(self.rate == 0, 1.0, self.rate)
        spans = np.where(self.rate == 0, until, np.expm1(rate * until) / rate)
        line = self.offset * until + self.slope * until**2 / 2
        return float((self.amplitude @ spans).real) + line

    def bend(self, time: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return bounds (T,) of the second derivative's size from these times on."""
        weight = np.abs(self.amplitude) * np.abs(self.rate) ** 2
        decay = np.minimum(self.rate.real, 0.0)
        return np.asarray(np.exp(np.multiply.outer(time, decay)) @ weight)

    def first_zero(self, start: float, stop: float) -> float | None:
        """Return the first time after `start` at which the value falls to zero; None if none does.

        Where the value is a and b at the ends of an interval of length s, and its second derivative
        at most L, it has no zero in it when (sqrt a + sqrt b)^2 > L s^2 / 2. Intervals that fail
        the test are halved.

        Args:
            start: s; the value is positive there, or zero and about to rise.
            stop: s.
        """
        time = np.linspace(start, stop, POINTS)
        value = self(time)
        value[0] = max(value[0], 0.0)
        for _ in range(HALVINGS):
            below = np.flatnonzero(value[1:] <= 0)
            last = int(below[0]) + 1 if len(below) else len(time) - 1
            time, value = time[: last + 1], value[: last + 1]
            sound = last if len(below) else last + 1  # the interval of the zero itself is not asked
            step = np.diff(time[:sound])
            roots = np.sqrt(value[:sound])
            apart = (roots[:-1] + roots[1:]) ** 2
            doubtful = np.flatnonzero(apart <= self.bend(time[: len(step)]) * step**2 / 2)
            if not len(doubtful):
                break
            middle = (time[doubtful] + time[doubtful + 1]) / 2
            time = np.insert(time, doubtful + 1, middle)
            value = np.insert(value, doubtful + 1, self(middle))
        return self._refine(time[-2], time[-1]) if value[-1] <= 0 else None

    def _refine(self, low: float, high: float) -> float:
        """Return the zero between two times, above zero at the first and not at the second."""
        guess = (low + high) / 2
        for _ in range(REFINEMENTS):
            waves = np.exp(self.rate * guess) * self.amplitude
            value = float(waves.sum().real) + self.offset + self.slope * guess
            low, high = (guess, high) if value > 0 else (low, guess)
            fall = float((waves @ self.rate).real) + self.slope
            before, guess = guess, (guess - value / fall if fall < 0 else low)
            if not low < guess < high:  # Newton's step leaves the bracket
                guess = (low + high) / 2
            if abs(guess - before) <= 4e-16 * high:
                break
        return float(guess)
