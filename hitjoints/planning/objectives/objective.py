"""What an objective of a plan is: one class each, with a line in the registry."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, ClassVar

if TYPE_CHECKING:
    from hitjoints.kernels.tape.trace import Scalar
    from hitjoints.planning.objectives.sight import Sight
    from hitjoints.planning.objectives.traced_hit import TracedHit
    from hitjoints.types import Array


class Objective(ABC):
    """Something to be maximised over configurations, as a logarithm.

    Attributes:
        ranked_by: quantity of a candidate that tells which joint is best.
        logarithm: of the formula, which is positive then; else the formula itself is maximised.
        moving: the joint velocities of a straight motion are variables beside q.
        stopping: those velocities are reached from rest, and stopped from, within the limits.
        needs_flux: it makes sense only with a flux to be reached.
        needs_goal: it makes sense only where it is known where the object is to come to rest.
        keeps_away: it can be combined with the away condition.
    """

    ranked_by: ClassVar[str]
    logarithm: ClassVar[bool] = True
    moving: ClassVar[bool] = False
    stopping: ClassVar[bool] = False
    needs_flux: ClassVar[bool] = False
    needs_goal: ClassVar[bool] = False
    keeps_away: ClassVar[bool] = True

    @abstractmethod
    def screen(self, seen: Sight) -> Array:
        """Return what is maximised (N,), not finite where there is nothing to maximise."""

    @abstractmethod
    def formula(self, seen: TracedHit) -> tuple[Scalar, list[Scalar]]:
        """Return the formula, and the gradient of what is maximised: by q (n), or by q and qd when
        moving. It is recorded once for an arm and a contact.
        """
