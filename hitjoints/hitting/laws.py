"""Two laws that follow the field and use what freedom is left for posture and inertia (Eq. 7)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, NamedTuple, Protocol

import numpy as np

from hitjoints.errors import UnknownNameError
from hitjoints.programs.following import PROGRESS, following, following_terms
from hitjoints.programs.joint_velocity import least_norm
from hitjoints.programs.torque_rows import Impulses, with_impulses, with_slack
from hitjoints.programs.warm import ROWS, WarmProgram

if TYPE_CHECKING:
    from hitjoints.types import Array

LawName = Literal["qp", "paper"]
ASTRAY = 1e7
"""Cost of leaving the field's direction, (rad/s)^2 per (m/s)^2: motors may leave no other way."""
FASTEST_ASTRAY = 100.0
"""m/s, a bound of that which is never met."""


class LawMotion(NamedTuple):
    """A joint velocity (n,) rad/s within its bounds, and s in [0, 1]: J qd = s f.

    With torque or acceleration limits J qd = s f + e, e as small as they let it be.
    """

    qd: Array
    scaling: float


class VelocityLaw(Protocol):
    """Chooses the joint velocity of a step."""

    def __call__(
        self,
        J: Array,
        f: Array,
        posture: Array,
        lower: Array,
        upper: Array,
        impulses: Impulses | None = None,
    ) -> LawMotion | None:
        """Return the motion, or None if there is no certified one.

        Args:
            J: (3, n) m/rad.
            f: (3,) m/s, the field.
            posture: (n,) rad/s, wanted besides.
            lower: (n,) rad/s, with lower <= 0 <= upper if there are no impulses.
            upper: (n,) rad/s, with lower <= 0 <= upper if there are no impulses.
            impulses: what the motors can do, if that, or the change of velocities, is limited.
        """
        ...


def law_named(name: LawName, n: int) -> VelocityLaw:
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
        self._limited: WarmProgram | None = None  # qd, s, e, p
        self._slack = np.full(3, FASTEST_ASTRAY)

    def __call__(
        self,
        J: Array,
        f: Array,
        posture: Array,
        lower: Array,
        upper: Array,
        impulses: Impulses | None = None,
    ) -> LawMotion | None:
        """Return the motion; see `VelocityLaw`."""
        qd, pushed = _unbounded(J, f, posture)
        miss = J @ qd - f
        if (
            ((qd >= lower) & (qd <= upper)).all()
            and float(qd @ pushed) <= PROGRESS - 1.0  # the multiplier of s <= 1 is not negative
            and float(miss @ miss) <= ROWS * ROWS
            and (impulses is None or impulses.allow(qd))
        ):
            return LawMotion(qd, 1.0)
        n, unit = posture.size, 1.0
        if impulses is None:
            terms, low, high, unit = following(J, f, posture, lower, upper)
            x = self._program.solve(*terms, low, high)
        else:
            terms = following_terms(J, f, posture)
            terms = with_impulses(with_slack(terms, 3, ASTRAY), impulses)
            low = np.concatenate((lower, [0.0], -self._slack, -impulses.limit))
            high = np.concatenate((upper, [1.0], self._slack, impulses.limit))
            if self._limited is None:
                self._limited = WarmProgram(low.size, terms.b.size)
            x = self._limited.solve(*terms, low, high)
        return None if x is None else LawMotion(x[:n], unit * float(x[n]))


def paper_law(
    J: Array,
    f: Array,
    posture: Array,
    lower: Array,
    upper: Array,
    impulses: Impulses | None = None,
) -> LawMotion:
    """Return Eq. 7 as printed, all joints scaled by one factor into the bounds; see `VelocityLaw`.

    It knows no torques: no scaling of it is sure to have any within the limits.
    """
    assert impulses is None
    qd = _unbounded(J, f, posture)[0]
    limit = np.where(qd > 0, upper, lower)
    moving = qd != 0
    scaling = float(np.min(limit[moving] / qd[moving], initial=1.0))
    return LawMotion(np.minimum(np.maximum(scaling * qd, lower), upper), scaling)


def _unbounded(J: Array, f: Array, posture: Array) -> tuple[Array, Array]:
    """Return Eq. 7, posture + J^+ (f - J posture), and its second term."""
    pushed = least_norm(J, f - J @ posture)
    return posture + pushed, pushed
