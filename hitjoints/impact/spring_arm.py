"""An arm on springs hits an object: exact while they touch.

Deviations from the uniform motion before the hit, links q, rotors t, object y:

    M q'' = K (t - q) + D (t' - q') - g F,     B t'' = -K (t - q) - D (t' - q') - Kp t - Kd t',
    m y'' = F = k p + d p',                    p = v time + g.q - y.

M, g = J^T h and v are those of the moment of the hit, so that this is linear. What the links do of
themselves, bent by their own motion, adds constant accelerations to q and p.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from hitjoints.impact.first_zero import Exponentials
from hitjoints.impact.vibration import Vibration

if TYPE_CHECKING:
    from hitjoints.types import Array

TOGETHER = 64
"""Contact times after which arm and object count as going on together."""
AGAIN = 0.1
"""s after the parting in which a second contact is looked for."""
STILL = 1e-9
"""Share of the fastest rate below which a rate is that of bodies that drift apart."""


class Parted(NamedTuple):
    """The end of a contact.

    Attributes:
        time: s, of the parting; None if arm and object go on together.
        impulse: N s, of the contact.
        closing: m/s, at which the surfaces still approach, below zero.
        depth: m, by which they still overlap: a damper lets go before they part.
        spring: k (N/m) and d (N s/m) of the contact.
        swing: the arm's springs from then on, without the contact's; its last rate is `closing`.
    """

    time: float | None
    impulse: float
    closing: float
    depth: float
    spring: tuple[float, float]
    swing: Vibration


@dataclass(frozen=True, eq=False)
class SpringArm:
    """The arm at one configuration, as its contact feels it along one direction.

    Attributes:
        response: (n, n), M^-1 of the links.
        pull: (n,), g = J^T h.
        rotors: (n,) kg m^2; where zero, the joint has no spring.
        stiffness: (n,) N m/rad, above 0.
        damping: (n,) N m s/rad.
        gains: (n,) N m/rad and (n,) N m s/rad, of servos at the rotors, or at the link where there
            is none.
        own: (n,) rad/s^2, of the links by their own motion; None: none.
        bend: m/s^2, of the contact along the direction by the same, the links' turning left out.
    """

    response: Array
    pull: Array
    rotors: Array
    stiffness: Array
    damping: Array
    gains: tuple[Array, Array]
    own: Array | None = None
    bend: float = 0.0

    @property
    def mobility(self) -> float:
        """1/kg, of the links alone: g^T M^-1 g."""
        return float(self.pull @ self.response @ self.pull)

    def collide(
        self, mass: float, speed: float, spring: tuple[float, float], contact_time: float
    ) -> Parted:
        """Hit an object at rest.

        Args:
            mass: kg, of the object.
            speed: m/s, of the contact.
            spring: k (N/m) and d (N s/m) of the contact.
            contact_time: s, about how long they touch.
        """
        mobility, stiffness, damping, drift = self._springs(mass, *spring)
        start = np.zeros(len(stiffness))
        start[-1] = speed
        # About the forces that would hold against the drift, the springs swing as without it.
        hold = np.linalg.solve(mobility, drift)
        firm = stiffness > 0
        rest = np.where(firm, hold / np.where(firm, stiffness, 1.0), 0.0)
        glide = np.where(firm, 0.0, hold / np.where(firm, 1.0, damping))
        motion = Vibration(mobility, stiffness, damping, -rest, start - glide)
        force = Exponentials(motion.force(-1), motion.rates, float(hold[-1]))
        parting = _parting(force, contact_time)
        until = TOGETHER * contact_time if parting is None else parting
        elongation, rate = motion.state(until)
        elongation, rate = elongation + rest, rate + glide
        stiffness[-1] = damping[-1] = 0.0
        swing = Vibration(mobility, stiffness, damping, elongation, rate)
        impulse, depth = force.integral(until), float(elongation[-1])
        return Parted(parting, impulse, float(rate[-1]), depth, spring, swing)

    def _springs(self, mass: float, k: float, d: float) -> tuple[Array, Array, Array, Array]:
        """Return W (S, S), stiffness, damping and drift (S,) of joints, servos, last the contact.

        The drift is the elongations' acceleration by the links' own motion.
        """
        n = len(self.pull)
        sprung = np.flatnonzero(self.rotors > 0)
        held = np.flatnonzero(self.gains[0] + self.gains[1] > 0)
        size = n + len(sprung) + 1
        lightness = np.zeros((size, size))
        lightness[:n, :n] = self.response
        lightness[range(n, size), range(n, size)] = [*(1.0 / self.rotors[sprung]), 1.0 / mass]
        driven = np.arange(n)
        driven[sprung] = np.arange(n, size - 1)
        springs = np.zeros((len(sprung) + len(held) + 1, size))
        rows = np.arange(len(sprung))
        springs[rows, sprung], springs[rows, driven[sprung]] = -1.0, 1.0
        springs[np.arange(len(sprung), len(springs) - 1), driven[held]] = 1.0
        springs[-1, :n], springs[-1, -1] = self.pull, -1.0
        drift = np.zeros(len(springs)) if self.own is None else springs[:, :n] @ self.own
        drift[-1] += self.bend
        return (
            springs @ lightness @ springs.T,
            np.concatenate([self.stiffness[sprung], self.gains[0][held], [k]]),
            np.concatenate([self.damping[sprung], self.gains[1][held], [d]]),
            drift,
        )


def _parting(force: Exponentials, contact_time: float) -> float | None:
    """Return when the contact's force falls to zero; None if it does not for long."""
    start, stop = 0.0, 2.0 * contact_time
    while start < TOGETHER * contact_time:
        found = force.first_zero(start, stop)
        if found is not None:
            return found
        start, stop = stop, 2.0 * stop
    return None


def second_contact(parted: Parted) -> float | None:
    """Return how long after a parting the arm, swinging freely, pushes the object again.

    Returns:
        s; None if it does not within `AGAIN`, or they never part.
    """
    if parted.time is None:
        return None
    rates, speeds = parted.swing.rates, parted.swing.rate(-1)
    moving = np.abs(rates) > STILL * np.abs(rates).max()
    drift = float(speeds[~moving].sum().real)
    rates, speeds = rates[moving], speeds[moving]
    sway = speeds / rates
    overlap = Exponentials(sway, rates, parted.depth - float(sway.sum().real), drift)
    start = 0.0
    if parted.depth > 0:
        k, d = parted.spring
        offset, slope = k * overlap.offset + d * drift, k * drift
        pull = -Exponentials(k * sway + d * speeds, rates, offset, slope)
        caught, free = pull.first_zero(0.0, AGAIN), overlap.first_zero(0.0, AGAIN)
        if free is None or (caught is not None and caught < free):
            return caught
        start = free
    return (-overlap).first_zero(start, AGAIN)
