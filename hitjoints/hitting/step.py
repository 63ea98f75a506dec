"""What a step of the controller is made with, and what it decides."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from hitjoints.types import Array

SLOWED = 1.0 - 1e-6  # scalings below this count as slowed down
STABLE = 0.5  # greatest share of an inertia error that one step may remove to first order


class Gains(NamedTuple):
    """The gains of the null space term of Eq. 7.

    Attributes:
        posture: beta1, 1/s, towards the configuration of greatest manipulability.
        inertia: beta2, rad^2/(kg^2 s), towards the desired inertia. One step never removes more
            than half of an error to first order, however steep the inertia is.
    """

    posture: float = 0.5
    inertia: float = 0.5


class Step(NamedTuple):
    """What a step of the controller saw and decided.

    Attributes:
        qd: (n,) rad/s.
        position: (3,) m, of the contact.
        inertia: kg.
        desired_inertia: kg.
        speed: m/s along the direction that qd gives.
        flux: m/s, at that speed.
        scaling: share of the field's speed that the limits allow, 0 to 1.
        saturated: the desired flux was out of reach, or the motion had to be slowed down.
        braked: no motion was certified, so the arm slows down instead.
        emergency: nor is a way to rest within all limits known: the arm brakes as hard as its
            motors can, and where even that cannot keep a position or velocity limit, qd asks
            for more torque than there is, but never for a velocity beyond a limit.
    """

    qd: Array
    position: Array
    inertia: float
    desired_inertia: float
    speed: float
    flux: float
    scaling: float
    saturated: bool
    braked: bool
    emergency: bool
