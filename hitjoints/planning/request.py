"""How a task is to be planned."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from hitjoints.planning.objectives.objective import Objective
    from hitjoints.types import Array


@dataclass(frozen=True)
class Request:
    """What is wanted of the configuration, beyond the task.

    Attributes:
        objective: what is maximised.
        flux: m/s that must be reached, if any.
        deliverable: by a motion from rest to rest; else by the speed of Eq. 9.
        seed: of everything random.
        certificate: bound the inertia, and try to prove a no.
        accept: asked of configurations (n,), best first.
        hints: (M, n) rad, to search from as well.
        near: (K, n) rad, to search near and hardly anywhere else.
    """

    objective: Objective
    flux: float | None = None
    deliverable: bool = False
    seed: int = 0
    certificate: bool = True
    accept: Callable[[Array], bool] | None = None
    hints: Array | None = None
    near: Array | None = None
