"""What recorded hits show of the arm, beside the models of its drives; and which stiffness fits.

The balance of momentum, mass object_speed / (robot_speed - robot_speed_after), counts what the
controller pushes as if it were mass. Its push is estimated from the robot's acceleration before
the contact and after it, where nothing else acts: what speed it would have gained meanwhile is
added to the loss.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from hitjoints.errors import InputError, ModelError
from hitjoints.impact.elastic import elastic_impact
from hitjoints.impact.inertia_models import impact_inertia

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from hitjoints.evidence.recordings.replayed_hit import ReplayedHit
    from hitjoints.model.robot import Contact, Robot
    from hitjoints.types import Array

CONTACT = 0.02
"""s, how long the recorded hits of the public data set last: 15 to 25 ms."""
RESTITUTION = 0.5
"""Of the contact's spring, which the elastic model needs; found ones hold the push as well."""
GRID = np.geomspace(3e2, 3e5, 61)
"""N m/rad, stiffnesses that are tried."""


@dataclass(frozen=True)
class ShownMass:
    """What the models of the drives say of one recorded hit, kg; None where rotors are not known.

    Attributes:
        rigid: of the links alone.
        rotor: with the rotors.
        composite: all joints locked.
        elastic: shown at the parting, by the stiffness that is known or assumed.
        curve: the same by every stiffness of `GRID`.
    """

    rigid: float
    rotor: float | None
    composite: float
    elastic: float | None
    curve: tuple[float, ...] | None = None

    def as_dict(self) -> dict[str, float | None]:
        """Return the models' values by name."""
        return {
            "rigid": self.rigid,
            "rotor": self.rotor,
            "composite": self.composite,
            "elastic": self.elastic,
        }


class FittedStiffness(NamedTuple):
    """The stiffness (N m/rad) of all joints that explains a set of hits best.

    Attributes:
        value: the best.
        low: least and
        high: greatest of those that are best when one hit is left out.
        error: mean of |log(measured / shown)| over hits, each by the stiffness of the others.
        hits: how many.
        at_edge: the best is the softest or stiffest that was tried: the hits do not bound it.
    """

    value: float
    low: float
    high: float
    error: float
    hits: int
    at_edge: bool


def with_models(
    hit: ReplayedHit,
    robot: Robot,
    q: Array,
    contact: Contact,
    *,
    contact_time: float = CONTACT,
    stiffness: ArrayLike | None = None,
    rotor_inertia: ArrayLike | None = None,
) -> ReplayedHit:
    """Return a measured hit with what the models say of it.

    Args:
        hit: measured.
        robot: the arm.
        q: (n,) rad, at the contact.
        contact: the point that hits.
        contact_time: s, of the rigid pair.
        stiffness: of the joints, see `elastic_impact`.
        rotor_inertia: likewise.
    """
    h, mass, speed = hit.direction, hit.mass, hit.robot_speed
    assert h is not None
    assert mass is not None
    assert speed is not None

    def shown(k: ArrayLike | None) -> float:
        one = elastic_impact(
            robot, q, contact, h, mass, speed, RESTITUTION, contact_time, k,
            rotor_inertia=rotor_inertia,
        )  # fmt: skip
        return math.inf if one.shown is None else one.shown

    rigid, composite = (impact_inertia(robot, q, contact, h, m) for m in ("rigid", "composite"))
    try:
        rotor = impact_inertia(robot, q, contact, h, "rotor", rotor_inertia=rotor_inertia)
    except ModelError:  # its rotors are not known
        return replace(hit, shown_mass=ShownMass(rigid, None, composite, None))
    elastic, curve = shown(stiffness), tuple(shown(float(k)) for k in GRID)
    finite = elastic if math.isfinite(elastic) else None
    return replace(hit, shown_mass=ShownMass(rigid, rotor, composite, finite, curve))


def fit_stiffness(hits: Sequence[ReplayedHit]) -> FittedStiffness | None:
    """Return the stiffness that explains hits best, each judged by that of the others.

    Measured is the balance of momentum without the controller's push. One number for all joints.

    Returns:
        None where fewer than three hits have known rotors and a balance.
    """
    rows = []
    for hit in hits:
        curve = None if hit.shown_mass is None else hit.shown_mass.curve
        if curve is not None and hit.unpushed_mass is not None:
            with np.errstate(divide="ignore"):
                rows.append(np.abs(np.log(hit.unpushed_mass) - np.log(curve)))
    if len(rows) < 3:
        return None
    off = np.array(rows)
    off[~np.isfinite(off)] = 10.0  # as far off as a factor of e^10
    best = int(np.argmin(off.sum(axis=0)))
    without = [int(np.argmin(np.delete(off, i, axis=0).sum(axis=0))) for i in range(len(off))]
    return FittedStiffness(
        float(GRID[best]),
        float(GRID[min(without)]),
        float(GRID[max(without)]),
        float(np.mean([off[i, k] for i, k in enumerate(without)])),
        len(off),
        best in (0, len(GRID) - 1),
    )


def check_drives(
    contact_time: float, stiffness: ArrayLike | None, rotor_inertia: ArrayLike | None
) -> None:
    """Refuse drives that no arm has, before any file is read.

    Raises:
        InputError: a number is not finite, or not above 0 (a rotor: below 0).
    """
    for name, given, least in (
        ("contact_time", contact_time, "above 0"),
        ("stiffness", 1.0 if stiffness is None else stiffness, "above 0"),
        ("rotor_inertia", 0.0 if rotor_inertia is None else rotor_inertia, "not below 0"),
    ):
        values = np.asarray(given, dtype=float)
        ok = values >= 0 if name == "rotor_inertia" else values > 0
        if not (np.isfinite(values).all() and ok.all()):
            raise InputError(name, given, f"it must be finite and {least}")
