"""Eq. 12 as the compiled control step solves it, on its own: guesses followed to a proof."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from hitjoints.hitting.step_layout import GUESSES, HASTY
from hitjoints.hitting.step_tape import EXACT
from hitjoints.kernels.formulas.bounded import Guess, nearest_velocity, with_the_flux
from hitjoints.kernels.tape.scalar import ScalarProgram
from hitjoints.kernels.tape.trace import Scalar, Tape, Tracer, Vector, minimum
from hitjoints.programs.joint_velocity import RHO

if TYPE_CHECKING:
    from hitjoints.types import Array


class CompiledEq12:
    """Solves one program after the other, beginning with the active bounds of the one before.

    Args:
        n: joints of the arm.
    """

    def __init__(self, n: int) -> None:
        self._inputs, self._outputs, self._run = ScalarProgram(_record(n)).bind()
        self._given, self._sides = self._inputs[: 5 * n + 7], self._inputs[5 * n + 7 : -1]
        self._status, self._next = self._outputs[:3], self._outputs[3 : n + 3]
        self._x = self._outputs[n + 3 :]

    def __call__(self, given: Array) -> Array:
        """Return the joint velocity (n,) rad/s for what `flat` made.

        Raises:
            ValueError: no guess is proved.
        """
        self._given[:] = given
        self._inputs[-1] = 0.0
        for guess in range(1, GUESSES + 1):
            self._run()
            usable, exact, changed = self._status.tolist()
            if changed == 0.0 and usable > 0.0 and exact > 0.0:
                return self._x.copy()
            self._sides[:] = self._next
            self._inputs[-1] = float(guess > HASTY)
        raise ValueError("no guess of the active bounds is proved")


def flat(J: Array, f: Array, h: Array, speed: float, lower: Array, upper: Array) -> Array:
    """Return a program as one array: J (3, n), f (3,), h (3,), the speed, and the bounds (n,)."""
    return np.concatenate((J.T.ravel(), f, h, [speed], lower, upper))


def _record(n: int) -> Tape:
    tracer = Tracer(6 * n + 8)
    x = tracer.inputs
    columns: list[Vector] = [(x[3 * i], x[3 * i + 1], x[3 * i + 2]) for i in range(n)]
    a = 3 * n
    f: Vector = (x[a], x[a + 1], x[a + 2])
    h: Vector = (x[a + 3], x[a + 4], x[a + 5])
    lower: list[Scalar] = list(x[a + 7 : a + 7 + n])
    upper: list[Scalar] = list(x[a + 7 + n : a + 7 + 2 * n])
    guess = Guess(list(x[5 * n + 7 : -1]), x[-1])
    nearest, usable = nearest_velocity(columns, f)
    weights: list[Scalar] = [RHO] * n
    found = with_the_flux(columns, f, h, x[a + 6], nearest, weights, (lower, upper), guess)
    return tracer.program(
        [minimum(usable, 1.0), EXACT - found.miss, found.changed, *found.sides, *found.x]
    )
