"""What a block of a workspace map holds: every quantity over sampled configurations."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from hitjoints.built import kernel_for
from hitjoints.maps.map_kinds import WORKSPACE, MapKind
from hitjoints.model.robot import Contact
from hitjoints.quantities import place_joint

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from hitjoints.kernels import Placement
    from hitjoints.model.robot import Robot
    from hitjoints.types import Array

OUTPUTS = ("inertia", "speed", "flux", "straight_speed", "straight_flux")
ROWS_AT_ONCE = 200_000  # configurations in memory at a time
MOST_SAMPLES = 1_000_000  # per position and joint: those of one position are in memory together


@dataclass(frozen=True)
class Question:
    """What is asked at every position.

    Attributes:
        robot: the arm.
        contacts: hitting joints or contact points.
        directions: (D, 3) unit vectors.
        mass: of the object, kg.
        samples: configurations tried per position and joint.
        seed: of those.
    """

    robot: Robot
    contacts: tuple[Contact, ...]
    directions: Array
    mass: float
    samples: int
    seed: int
    kind: ClassVar[MapKind] = WORKSPACE

    @property
    def further(self) -> dict[str, Any]:
        """What else a map's numbers hang on, for its attributes."""
        return {}

    def part(
        self,
        contact: Contact,
        positions: Array,
        numbers: NDArray[np.int64],
        threads: int | None,
    ) -> dict[str, Array]:
        """Return the answer for one contact, without its axis; see `evaluate`."""
        return _evaluate(self, contact, positions, numbers, threads)

    @property
    def positions_at_once(self) -> int:
        """Positions whose samples fit in memory together."""
        return max(1, ROWS_AT_ONCE // self.samples)


class StoppedError(Exception):
    """Nobody waits for the answer any more."""


def evaluate(
    question: Question,
    positions: Array,
    numbers: NDArray[np.int64],
    threads: int | None = None,
    stopped: Callable[[], bool] = lambda: False,
) -> dict[str, Array]:
    """Answer a question at some positions.

    Args:
        question: what to compute.
        positions: (P, 3) m.
        numbers: (P,) of each position in the whole map: the random numbers hang on it, so the
            answer does not depend on how the map is cut.
        threads: see `hj.place_joint`.
        stopped: asked now and then whether the answer is still wanted.

    Returns:
        `reachable` (K, P), the share of samples that reach the position; the names of the kind of
        map, (K, D, P), postures (K, D, P, n); nan where there is no answer.

    Raises:
        StoppedError: it is not.
    """
    step = question.positions_at_once

    def part(contact: Contact, i: int) -> dict[str, Array]:
        if stopped():
            raise StoppedError
        cut = slice(i, i + step)
        return question.part(contact, positions[cut], numbers[cut], threads)

    parts = [
        [part(contact, i) for i in range(0, len(positions), step)] for contact in question.contacts
    ]
    return {
        name: np.stack([np.concatenate([p[name] for p in row], axis=_axis(name)) for row in parts])
        for name in parts[0][0]
    }


def _axis(name: str) -> int:
    """Return which axis of one contact's result counts the positions."""
    return 0 if name == "reachable" else 1


def _evaluate(
    question: Question,
    contact: Contact,
    positions: Array,
    numbers: NDArray[np.int64],
    threads: int | None,
) -> dict[str, Array]:
    robot, directions, samples = question.robot, question.directions, question.samples
    shape = (len(directions), len(positions))
    result: dict[str, Array] = {name: np.full(shape, np.nan) for name in WORKSPACE.per_direction}
    result["q"] = np.full((*shape, robot.n), np.nan)
    result["reachable"] = np.zeros(len(positions))
    q, solved, where = sample(question, contact, positions, numbers, threads)
    if not where.size:
        return result
    result["reachable"][where] = solved.mean(axis=1)
    rows = q.reshape(-1, robot.n)
    kernel = kernel_for(robot, (contact,), OUTPUTS)
    outward = _outward(robot, contact, rows, threads).reshape(-1, samples, 3)
    each = np.arange(where.size)
    for d, h in enumerate(directions):
        values = kernel(rows, h, question.mass, threads=threads)
        inertia, speed, flux, straight_speed, straight_flux = (
            np.where(solved, values[name][0].reshape(solved.shape), np.nan) for name in OUTPUTS
        )
        away = solved & (outward @ h < 0)
        best = np.nanargmax(flux, axis=1)
        ordered, flux_ordered = np.sort(inertia, axis=1), np.sort(flux, axis=1)
        count = solved.sum(axis=1)
        found = {
            "inertia": inertia[each, best],
            "inertia_min": ordered[:, 0],
            "inertia_median": _median(ordered, count),
            "inertia_max": ordered[each, count - 1],
            "speed": speed[each, best],
            "speed_max": np.nanmax(speed, axis=1),
            "flux": flux[each, best],
            "flux_median": _median(flux_ordered, count),
            "straight_speed": straight_speed[each, best],
            "straight_flux": straight_flux[each, best],
            "away": away.any(axis=1).astype(float),
            "away_flux": _greatest(flux, away),
            "q": q[each, best],
        }
        for name, value in found.items():
            result[name][d, where] = value
    return result


def sample(
    question: Question,
    contact: Contact,
    positions: Array,
    numbers: NDArray[np.int64],
    threads: int | None,
) -> tuple[Array, NDArray[np.bool_], NDArray[np.int64]]:
    """Return q (R, S, n), solved (R, S) at the R positions that can be reached, and which."""
    robot, samples, seed = question.robot, question.samples, question.seed

    def attempt(targets: Array, rows: NDArray[np.int64]) -> Placement:
        return place_joint(robot, contact, targets, seed, rows=rows, threads=threads)

    # One sample decides whether the position can be reached: most of a map often cannot.
    first = numbers * samples
    where = np.flatnonzero(attempt(positions, first).solved)
    rows = (first[where, None] + np.arange(samples)).ravel()
    placed = attempt(np.repeat(positions[where], samples, axis=0), rows)
    shape = (where.size, samples)
    return placed.q.reshape(*shape, robot.n), placed.solved.reshape(shape), where


def _outward(robot: Robot, contact: Contact, rows: Array, threads: int | None) -> Array:
    """Return chi_{k+1} - chi_k (N, 3) of Eq. 14, see `Robot.beyond`."""
    ends = Contact(contact.joint), robot.beyond(contact)
    kernel = kernel_for(robot, ends, ("position",))
    places = kernel(rows, np.array([1.0, 0.0, 0.0]), threads=threads)["position"]
    return np.asarray(places[1] - places[0])


def _median(ordered: Array, count: NDArray[np.int64]) -> Array:
    """Return the median of each row's first `count` values, the rest being nan."""
    each = np.arange(len(ordered))
    return np.asarray((ordered[each, (count - 1) // 2] + ordered[each, count // 2]) / 2)


def _greatest(values: Array, chosen: NDArray[np.bool_]) -> Array:
    """Return the greatest chosen value of each row, nan where none is."""
    greatest = np.where(chosen, values, -np.inf).max(axis=1)
    return np.where(chosen.any(axis=1), greatest, np.nan)
