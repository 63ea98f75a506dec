"""Two laws that follow the field and use what freedom is left for posture and inertia (Eq. 7)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, NamedTuple, Protocol

import numpy as np

from hitjoints.errors import UnknownNameError
from hitjoints.programs.velocity import PROGRESS, following_terms, least_norm
from hitjoints.programs.warm import ROWS, WarmProgram

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

LawName = Literal["qp", "paper"]


class Motion(NamedTuple):
    """A joint velocity (n,) rad/s within its bounds, and s in [0, 1]: J qd = s f."""

    qd: Array
    scaling: float


class Law(Protocol):
    """Chooses the joint velocity of a step."""

    def __call__(
        self, J: Array, f: Array, posture: Array, lower: Array, upper: Array
    ) -> Motion | None:
        """Return the motion, or None if there is no certified one.

        Args:
            J: (3, n) m/rad. f: (3,) m/s, the field. posture: (n,) rad/s, wanted besides.
            lower, upper: (n,) rad/s, with lower <= 0 <= upper.
        """
        ...


def law_named(name: LawName, n: int) -> Law:
    """Return a law for an arm of n joints.

    Raises:
        UnknownNameError: there is no such law.
    """
    if name not in ("qp", "paper"):
        raise UnknownNameError("law", name, ("qp", "paper"))
    return QpLaw(n) if name == "qp" else paper_law


class QpLaw:
    """One strictly convex QP: the field first, slowed down if it must be, then the posture.

    Without active bounds its answer is Eq. 7, which is tried first. With them the other joints
    take over, and only when they cannot does the contact slow down, in the field's direction.
    """

    def __init__(self, n: int) -> None:
        self._program = WarmProgram(n + 1, 3)
        self._lower, self._upper = np.zeros(n + 1), np.ones(n + 1)

    def __call__(
        self, J: Array, f: Array, posture: Array, lower: Array, upper: Array
    ) -> Motion | None:
        """Return the motion; see `Law`."""
        qd, pushed = _unbounded(J, f, posture)
        if (
            (qd >= lower).all()
            and (qd <= upper).all()
            and float(qd @ pushed) <= PROGRESS - 1.0  # the multiplier of s <= 1 is not negative
            and np.abs(J @ qd - f).max() <= ROWS
        ):
            return Motion(qd, 1.0)
        self._lower[:-1], self._upper[:-1] = lower, upper
        x = self._program.solve(*following_terms(J, f, posture), self._lower, self._upper)
        return None if x is None else Motion(x[:-1], float(x[-1]))


def paper_law(J: Array, f: Array, posture: Array, lower: Array, upper: Array) -> Motion:
    """Return Eq. 7 as printed, all joints scaled by one factor into the bounds; see `Law`."""
    qd = _unbounded(J, f, posture)[0]
    limit = np.where(qd > 0, upper, lower)
    moving = qd != 0
    scaling = float(np.min(limit[moving] / qd[moving], initial=1.0))
    return Motion(np.minimum(np.maximum(scaling * qd, lower), upper), scaling)


def _unbounded(J: Array, f: Array, posture: Array) -> tuple[Array, Array]:
    """Return Eq. 7, posture + J^+ (f - J posture), and its second term."""
    pushed = least_norm(J, f - J @ posture)
    return posture + pushed, pushed
