"""Place a contact at many positions: batched inverse kinematics."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import Any

import numpy as np
import pinocchio as pin

from hitjoints.errors import InputError, KernelMismatchError
from hitjoints.kernels.formulas.chain import Chain, Triple
from hitjoints.kernels.ik_single import SingleSearch
from hitjoints.kernels.ik_starts import random_starts
from hitjoints.kernels.ik_step import (
    SQUARE_TOLERANCE,
    Iteration,
    LlvmIteration,
    iteration,
    record_step,
)
from hitjoints.kernels.outputs import record
from hitjoints.kernels.tape.backends import Array, Runnable, choose, evaluate, prepare
from hitjoints.told import Told

TOLERANCE = 1e-9
"""Largest position error (m) of a solved row."""

ATTEMPTS = (13,) * 8 + (52,) * 8 + (150,) * 16
"""Most iterations of each attempt. Nine in ten succeed within 13; what is left after eight attempts
needs patience rather than luck."""

FOR_ALL = 16
"""Attempts for every target; the later ones are for those missed by less than `NEAR_MISS` only."""

NEAR_MISS = 1e-2
"""Error (m) that leaves hope: a reachable target at the edge of the workspace or of the limits."""

SPOT_CHECKS = 8
"""Rows per call compared with Pinocchio."""


@dataclass(frozen=True, repr=False)
class Placement(Told):
    """Configurations that place a contact.

    Args:
        q: (N, n) within the position limits (rad, m); the closest one found where not solved.
        solved: (N,) whether the error is at most 1e-9 m.
        error: (N,) distance to the position asked for (m).
    """

    q: Array
    solved: np.ndarray[Any, np.dtype[np.bool_]]
    error: Array


def place(  # noqa: PLR0913
    model: pin.Model,
    contact: tuple[int, tuple[float, float, float]],
    positions: Array,
    seed: int = 0,
    start: Array | None = None,
    rows: np.ndarray[Any, np.dtype[np.integer[Any]]] | None = None,
    threads: int | None = None,
    backend: str | None = None,
    chain: Chain | None = None,
    data: pin.Data | None = None,
) -> Placement:
    """Find configurations whose contact is at the given positions.

    Projected Levenberg-Marquardt from a start and then from random restarts. A row's result depends
    on its position, its row number, its start and the seed only.

    Args:
        model: serial fixed-base arm.
        contact: 1-based joint and contact point in the joint's frame (m).
        positions: (N, 3) in the world (m).
        seed: of the random starts.
        start: (n,) or (N, n) first configuration tried, clipped to the limits; joints that do not
            move the contact keep it. None for a random one.
        rows: (N,) row numbers that key the random starts; None for 0..N-1. A caller who splits a
            batch passes the numbers in the whole.
        threads: None for as many as help.
        backend: see `build_kernel`.
        chain: of the model, when it is known already.
        data: of the model, overwritten; made when it is not given.

    Raises:
        InputError: no such joint, wrong shapes, or a number that is not finite.
        ModelError: the model is not a serial arm.
        KernelMismatchError: the positions found disagree with Pinocchio.
    """
    chain = Chain.from_model(model) if chain is None else chain
    targets = np.asarray(positions, dtype=np.float64)
    if targets.ndim != 2 or targets.shape[1] != 3 or not np.isfinite(targets).all():
        raise InputError("positions", f"shape {targets.shape}", "finite (N, 3) (m) is expected")
    count = len(targets)
    numbers = np.arange(count) if rows is None else np.asarray(rows)
    if numbers.shape != (count,):
        raise InputError("rows", f"shape {numbers.shape}", f"({count},) is expected")
    first = None if start is None else _first(chain, np.asarray(start, dtype=np.float64), count)
    offset = (float(contact[1][0]), float(contact[1][1]), float(contact[1][2]))
    search = _search(chain, (contact[0], offset), choose(backend))
    if threads is not None and threads < 1:
        raise InputError("threads", threads, "at least 1")
    if count == 1 and search.single is not None:
        begin = None if first is None else first[:, 0]
        one = search.single(targets[0], int(numbers[0]), seed, begin, FOR_ALL, NEAR_MISS**2)
        q, error = one[0][:, None], np.array([one[1]])
    else:
        q, error = search(np.ascontiguousarray(targets.T), numbers, seed, first, threads)
    work = model.createData() if data is None else data
    _spot_check(model, work, (contact[0], offset), q, targets, error)
    return Placement(q.T, error <= TOLERANCE, error)


class Search:
    """The rounds of attempts for one contact.

    Args:
        chain: the arm.
        iterate: repeats the step.
        position: gives the contact's position for q; judges the result independently of the step.
        movers: number of joints that move the contact.
    """

    def __init__(self, chain: Chain, iterate: Iteration, position: Runnable, movers: int) -> None:
        self.chain, self.iterate, self.position, self.movers = chain, iterate, position, movers
        self.single: SingleSearch | None = None
        if isinstance(iterate, LlvmIteration) and movers:
            compiled: Any = position
            self.single = SingleSearch(chain, iterate.run, compiled, movers, ATTEMPTS)

    def __call__(
        self,
        targets: Array,
        numbers: np.ndarray[Any, np.dtype[np.integer[Any]]],
        seed: int,
        start: Array | None,
        threads: int | None,
    ) -> tuple[Array, Array]:
        """Solve targets (3, N): q (n, N) and errors (N,)."""
        q = random_starts(self.chain, numbers, seed, 0, threads) if start is None else start
        if not self.movers:
            return q, self.errors(q, targets, threads)
        best, square = self.iterate(q, targets, ATTEMPTS[0], threads)
        left = np.flatnonzero(square > SQUARE_TOLERANCE)
        for attempt, iterations in enumerate(ATTEMPTS[1:], 1):
            if attempt >= FOR_ALL:
                left = left[square[left] < NEAR_MISS**2]
            if not len(left):
                break
            fresh = random_starts(self.chain, numbers[left], seed, attempt, threads)
            fresh[self.movers :] = q[self.movers :, left]
            tried, reached = self.iterate(fresh, targets[:, left], iterations, threads)
            closer = reached < square[left]
            best[:, left[closer]], square[left[closer]] = tried[:, closer], reached[closer]
            left = left[reached > SQUARE_TOLERANCE]
        return best, self.errors(best, targets, threads)

    def errors(self, q: Array, targets: Array, threads: int | None) -> Array:
        """Distances (N,) from the targets (m)."""
        fill = [np.zeros(1)] * 4
        found = evaluate(self.position, 3, [*q, *fill], q.shape[1], threads)
        return np.asarray(np.sqrt(((found - targets) ** 2).sum(axis=0)))


@functools.lru_cache(maxsize=32)
def _search(chain: Chain, contact: tuple[int, Triple], backend: str) -> Search:
    attached = chain.attach(*contact)
    position = prepare(record(chain, [attached], ("position",)), chain.size, backend)
    if not attached[0]:
        raise InputError("joint", contact[0], "no joint moves this contact")
    step = iteration(record_step(chain, attached), backend)
    return Search(chain, step, position, attached[0])


def _first(chain: Chain, start: Array, count: int) -> Array:
    if start.shape not in {(chain.size,), (count, chain.size)} or not np.isfinite(start).all():
        expected = f"finite ({chain.size},) or ({count}, {chain.size}) is expected"
        raise InputError("start", f"shape {start.shape}", expected)
    low = [link.lower for link in chain.links]
    high = [link.upper for link in chain.links]
    inside = np.clip(start, low, high)
    return np.array(np.broadcast_to(inside, (count, chain.size)).T, order="C")


def _spot_check(
    model: pin.Model,
    data: pin.Data,
    contact: tuple[int, Triple],
    q: Array,
    targets: Array,
    error: Array,
) -> None:
    last = len(error) - 1
    for i in (0,) if last == 0 else np.linspace(0, last, min(SPOT_CHECKS, last + 1), dtype=int):
        pin.forwardKinematics(model, data, np.ascontiguousarray(q[:, i]))
        position = data.oMi[contact[0]].act(np.array(contact[1]))
        deviation = abs(float(np.linalg.norm(position - targets[i])) - float(error[i]))
        if not deviation <= 0.1 * TOLERANCE * (1.0 + float(np.abs(targets[i]).max())):
            raise KernelMismatchError(
                f"row {i}: the placement's error is off by {deviation:.3g} m from Pinocchio"
            )
