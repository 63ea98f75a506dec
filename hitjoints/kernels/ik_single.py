"""Inverse kinematics of one target: the attempts of a batch of one, without its arrays."""

from __future__ import annotations

import math
import threading
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from hitjoints.kernels.formulas.chain import Chain
from hitjoints.kernels.ik_starts import one_start
from hitjoints.kernels.ik_step import SQUARE_TOLERANCE

if TYPE_CHECKING:
    from hitjoints.kernels.tape.llvm_backend import LlvmProgram

Array = np.ndarray[Any, np.dtype[np.float64]]


class SingleSearch(threading.local):
    """The compiled iteration with numbers of its own, one set for each thread.

    It gives the bits that a batch gives: the same code runs, with the target in every lane.

    Args:
        chain: the arm.
        step: the iteration.
        position: gives the contact's position; judges the result independently of the step.
        movers: number of joints that move the contact.
        attempts: most iterations of each attempt.
    """

    def __init__(
        self,
        chain: Chain,
        step: LlvmProgram,
        position: LlvmProgram,
        movers: int,
        attempts: tuple[int, ...],
    ) -> None:
        n, lanes = chain.size, step.lanes
        self.chain, self.movers, self.lanes = chain, movers, lanes
        self._inputs, self._out = np.zeros((n + 3, lanes)), np.zeros((n + 1, lanes))
        bound = {
            most: step.bind(list(self._inputs), self._out, most) for most in sorted(set(attempts))
        }
        self._attempts = [bound[most] for most in attempts]
        self._q, self._at = np.zeros((n, lanes)), np.zeros((3, lanes))
        unused = [np.zeros(1)] * 4
        self._place = position.bind([*self._q, *unused], self._at)

    def __call__(
        self, target: Array, number: int, seed: int, start: Array | None, for_all: int, near: float
    ) -> tuple[Array, float]:
        """Return the configuration (n,) and its error (m).

        Args:
            target: (3,) m.
            number: the row number that keys the random starts.
            seed: of those.
            start: (n,), or None for a random one.
            for_all: attempts made however far the target is.
            near: squared error (m^2) that leaves hope for more.
        """
        n = self.chain.size
        first = one_start(self.chain, number, seed, 0) if start is None else start
        self._inputs[n:] = target[:, None]
        best, square = self._attempt(self._attempts[0], first)
        for attempt, run in enumerate(self._attempts[1:], 1):
            if square <= SQUARE_TOLERANCE or (attempt >= for_all and not square < near):
                break
            fresh = one_start(self.chain, number, seed, attempt)
            fresh[self.movers :] = first[self.movers :]
            tried, reached = self._attempt(run, fresh)
            if reached < square:
                best, square = tried, reached
        self._q[:] = best[:, None]
        self._place(0, self.lanes)
        off = self._at[:, 0] - target
        return best, math.sqrt(float((off**2).sum()))

    def _attempt(self, run: Callable[[int, int], None], q: Array) -> tuple[Array, float]:
        self._inputs[: len(q)] = q[:, None]
        run(0, self.lanes)
        return self._out[:-1, 0].copy(), float(self._out[-1, 0])
