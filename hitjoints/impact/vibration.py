"""Bodies on springs and dampers, in coordinates in which their energy is a sum of squares.

The elongations z of the springs obey z'' = -W f, f = k z + d z', with W = C (masses)^-1 C^T and C
the elongations by the bodies' positions. With W = L L^T, a = sqrt(k) z and b = L^-1 z' this reads

    a' = sqrt(k) L b,    b' = -L^T (sqrt(k) a + d L b):

a skew-symmetric matrix less a positive semidefinite one. (|a|^2 + |b|^2) / 2 is the energy, which
cannot grow; nothing drifts, since only elongations are followed; and without dampers the modes are
orthogonal, however stiff the springs and however light the bodies.
"""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from hitjoints.types import Array

    Modes = NDArray[np.complex128]


class Vibration:
    """The exact motion of S springs from given elongations and rates.

    Args:
        mobility: (S, S), W above, positive definite.
        stiffness: (S,) k; where it is zero, the elongation itself is not followed.
        damping: (S,) d.
        elongation: (S,) z at the start.
        rate: (S,) z' at the start.
    """

    def __init__(
        self, mobility: Array, stiffness: Array, damping: Array, elongation: Array, rate: Array
    ) -> None:
        self._damping = damping
        self._root = np.linalg.cholesky(mobility)
        self._springs = np.flatnonzero(stiffness > 0)
        self._scale = np.sqrt(stiffness[self._springs])
        self._count = len(self._springs)
        stretch = self._scale[:, None] * self._root[self._springs]
        size = self._count + len(self._root)
        motion = np.zeros((size, size))
        motion[: self._count, self._count :] = stretch
        motion[self._count :, : self._count] = -stretch.T
        motion[self._count :, self._count :] = -(self._root.T * damping) @ self._root
        start = np.concatenate(
            [self._scale * elongation[self._springs], np.linalg.solve(self._root, rate)]
        )
        self._motion, self._start = motion, start

    @cached_property
    def _solved(self) -> tuple[Modes, Modes]:
        """The rates, and the modes' shapes times their shares of the start."""
        rates, shapes = np.linalg.eig(self._motion)
        return rates.astype(complex), shapes * np.linalg.solve(shapes, self._start.astype(complex))

    @property
    def rates(self) -> Modes:
        """(K,) 1/s, of the modes: all motion is a sum of exp(rate t)."""
        return self._solved[0]

    @property
    def _modes(self) -> Modes:
        return self._solved[1]

    def rate(self, spring: int) -> Modes:
        """Return the amplitudes (K,) of a spring's z'."""
        return np.asarray(self._root[spring] @ self._modes[self._count :])

    def force(self, spring: int) -> Modes:
        """Return the amplitudes (K,) of a spring's force k z + d z'."""
        pull = self._damping[spring] * self.rate(spring)
        at = np.flatnonzero(self._springs == spring % len(self._root))
        for row in at:
            pull = pull + self._scale[row] * self._modes[row]
        return np.asarray(pull)

    def state(self, time: float) -> tuple[Array, Array]:
        """Return elongations (S,), zero where they are not followed, and rates (S,) at a time."""
        now = (self._modes @ np.exp(self.rates * time)).real
        elongation = np.zeros(len(self._root))
        elongation[self._springs] = now[: self._count] / self._scale
        return elongation, self._root @ now[self._count :]

    def energy(self, time: float) -> float:
        """Return the energy of elongations and rates at a time."""
        now = (self._modes @ np.exp(self.rates * time)).real
        return float(now @ now) / 2
