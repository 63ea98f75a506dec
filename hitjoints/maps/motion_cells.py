"""What a block of a map of motions holds: the hits that rollouts really deliver."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple

import numpy as np

from hitjoints.built import kernel_for
from hitjoints.hit import Hit
from hitjoints.hit_checks import LEAST_FLUX
from hitjoints.hitting.approach import ASKEW, MISSED
from hitjoints.hitting.field import HittingField
from hitjoints.maps.cells import Question, sample
from hitjoints.maps.map_kinds import MOTION, MapKind
from hitjoints.planning.start import AIM, ALLOWANCE
from hitjoints.quantities import place_joint
from hitjoints.rollouts.side_by_side import rollouts

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from hitjoints.model.robot import Contact
    from hitjoints.rollouts.many_record import Rollouts
    from hitjoints.types import Array

STAGES = 8
"""In which the arm is placed further and further back along the line, each from the one before."""
FOUND = {
    "flux": "flux",
    "inertia": "inertia",
    "speed": "speed",
    "miss": "miss",
    "direction_error": "direction_error",
    "time": "time",
    "q": "q",
    "q0": "q0",
    "q_hit": "q_hit",
    "acceleration_ratio": "acceleration_ratio_max",
    "torque_ratio": "torque_ratio_max",
}
"""Variables of a map, and what `Rollouts` call them."""


class Tried(NamedTuple):
    """Hitting configurations to be tried: of the R positions, M of them.

    Attributes:
        position: (M,) which position each belongs to.
        q: (M, n) rad.
        flux: (M,) m/s, the greatest straight one there.
    """

    position: NDArray[np.int64]
    q: Array
    flux: Array


@dataclass(frozen=True)
class MotionQuestion(Question):
    """What is asked at every position.

    Attributes:
        tries: motions tried per position, joint and direction.
        dt: s, of their control steps.
    """

    tries: int
    dt: float
    kind: ClassVar[MapKind] = MOTION

    @property
    def further(self) -> dict[str, Any]:
        """What else a map's numbers hang on, for its attributes."""
        return {"map": MOTION.name, "tries": self.tries, "dt": self.dt}

    def part(
        self,
        contact: Contact,
        positions: Array,
        numbers: NDArray[np.int64],
        threads: int | None,
    ) -> dict[str, Array]:
        """Return the answer for one contact, without its axis; see `cells.evaluate`."""
        robot, directions = self.robot, self.directions
        shape = (len(directions), len(positions))
        result: dict[str, Array] = {name: np.full(shape, np.nan) for name in MOTION.per_direction}
        result |= {name: np.full((*shape, robot.n), np.nan) for name in MOTION.postures}
        result["reachable"] = np.zeros(len(positions))
        q, solved, where = sample(self, contact, positions, numbers, threads)
        if not where.size:
            return result
        result["reachable"][where] = solved.mean(axis=1)
        result["hits"][:, where] = 0.0
        for d, h in enumerate(directions):
            tried = self._promising(contact, h, q, solved)
            if tried.flux.size:
                at, rows = positions[where], numbers[where]
                found, kept = self._moved(contact, h, at, rows, tried)
                views = {
                    name: result[name][d] for name in (*MOTION.per_direction, *MOTION.postures)
                }
                _note(found, kept, tried, where, views)
        return result

    def _promising(self, contact: Contact, h: Array, q: Array, solved: NDArray[np.bool_]) -> Tried:
        """Return the samples (R, S, n) of greatest straight flux, at most `tries` a position."""
        kernel = kernel_for(self.robot, (contact,), ("straight_flux",))
        values = kernel(q.reshape(-1, self.robot.n), h, self.mass, threads=1)["straight_flux"][0]
        flux = np.where(solved, values.reshape(solved.shape), 0.0)
        best = np.argsort(-flux, axis=1, kind="stable")[:, : self.tries]
        each = np.repeat(np.arange(len(flux)), best.shape[1])
        most = flux[each, best.ravel()]
        able = most > LEAST_FLUX
        return Tried(each[able], q[each, best.ravel()][able], most[able])

    def _moved(
        self, contact: Contact, h: Array, at: Array, rows: NDArray[np.int64], tried: Tried
    ) -> tuple[Rollouts, NDArray[np.int64]]:
        """Return the motions of those that have a start, and which of the tried they are."""
        robot = self.robot
        here, q = at[tried.position], tried.q
        inertia = kernel_for(robot, (contact,), ("inertia",))(q, h, threads=1)["inertia"][0]
        speed = (1.0 + self.mass / inertia) * tried.flux
        # The run-up of the default field grows with the speed alone.
        run_up = speed * HittingField(np.zeros(3), h).distance_to_settle(ALLOWANCE, AIM)
        solved, numbers = np.ones(len(q), dtype=np.bool_), rows[tried.position]
        for stage in range(1, STAGES + 1):
            back = here - (stage / STAGES * run_up)[:, None] * h
            placed = place_joint(robot, contact, back, self.seed, start=q, rows=numbers, threads=1)
            q, solved = placed.q, solved & placed.solved
        kept = np.flatnonzero(solved)
        hits = [
            Hit(contact, here[i], h, self.mass, flux)
            for i, flux in zip(kept, tried.flux[kept].tolist(), strict=True)
        ]
        ends = tried.q[kept]
        return rollouts(robot, hits, q[kept], q_hit=ends, dt=self.dt, threads=1), kept


def _note(
    found: Rollouts,
    kept: NDArray[np.int64],
    tried: Tried,
    where: NDArray[np.int64],
    result: dict[str, Array],
) -> None:
    """Write into the results (P, ...) of one direction what the best motions deliver.

    A motion counts that crosses the object's plane at the object, along the direction, whatever
    its flux.
    """
    of = tried.position[kept]
    with np.errstate(invalid="ignore"):
        good = (found.miss <= MISSED) & (found.direction_error <= ASKEW) & found.within_limits
    delivered = np.where(good, found.flux, -np.inf)
    every = np.bincount(tried.position, minlength=where.size)
    hits = np.bincount(of[good], minlength=where.size)
    result["hits"][where] = hits / np.maximum(every, 1)
    # The first of the greatest: sorted by position, then by flux, the others keep their order.
    order = np.lexsort((-delivered, of))
    first = order[np.unique(of[order], return_index=True)[1]]
    best = first[good[first]]
    place = where[of[best]]
    for name, attribute in FOUND.items():
        result[name][place] = getattr(found, attribute)[best]
    result["straight_flux"][place] = tried.flux[kept[best]]
