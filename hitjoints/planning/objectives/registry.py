"""The objectives a plan can have. A new one is a class, and a line here."""

from __future__ import annotations

from hitjoints.errors import UnknownNameError
from hitjoints.planning.objectives.most_flux import MostDeliverable, MostFlux, MostStraightFlux
from hitjoints.planning.objectives.most_inertia import LeastRebound, MostArrivals, MostInertia
from hitjoints.planning.objectives.objective import Objective

OBJECTIVES: dict[str, type[Objective]] = {
    "inertia": MostInertia,
    "flux": MostFlux,
    "straight-flux": MostStraightFlux,
    "deliverable": MostDeliverable,
    "rebound": LeastRebound,
    "landing": MostArrivals,
}


def objective_named(name: str) -> Objective:
    """Return an objective.

    Raises:
        UnknownNameError: there is none of that name; the message lists the choices.
    """
    if name not in OBJECTIVES:
        raise UnknownNameError("objective", name, OBJECTIVES)
    return OBJECTIVES[name]()
