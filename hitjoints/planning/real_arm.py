"""Plans for an arm on elastic joints: the best of the links, ranked by what they show in a hit.

Rotors are in the mass matrix, and locked joints have a gradient: those are planned for. What
elastic joints show has neither kernel nor gradient.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

from hitjoints.impact.shown_inertia import shown_inertia

if TYPE_CHECKING:
    from hitjoints.planning.candidates import Candidate
    from hitjoints.planning.task import Task


def ranked_again(task: Task, one: Candidate) -> Candidate:
    """Return a feasible candidate with the inertia that it shows, and its fluxes by that."""
    inertia = float(shown_inertia(task.robot, one.q[None], task.contact, task.hit)[0])
    alone = one.inertia / (one.inertia + task.mass)
    share = inertia / (inertia + task.mass)
    fluxes: dict[str, Any] = {
        name: None if value is None else value / alone * share
        for name in ("flux", "straight_flux", "deliverable_flux")
        for value in [getattr(one, name)]
    }
    return replace(one, inertia=inertia, links_inertia=one.inertia, **fluxes)
