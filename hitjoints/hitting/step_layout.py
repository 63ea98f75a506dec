"""Where the numbers of a control step's program stand."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from hitjoints.hitting.step_tape import Setting

if TYPE_CHECKING:
    from hitjoints.types import Array

GUESSES = 24
"""Guesses of the active bounds that are followed; the right one is mostly the last step's."""
HASTY = 5
"""Of these change in all entries at once; the rest, which may have run in a circle, one by one."""


class StepLayout:
    """Places in the inputs and outputs of `record_step_of`, for an arm of n joints.

    Attributes:
        q: of the inputs (n).
        guesses: of the inputs (2 n + 1).
        setting: of the inputs.
        lower: of the inputs, bounds (n) beside those of the limits; -inf for none.
        upper: of the inputs, the same; inf for none.
        one_by_one: of the inputs.
        usable: of the outputs.
        exact: of the outputs.
        changed: of the outputs.
        following: of the outputs, the next guesses (2 n + 1).
        qd: of the outputs (n).
        scaling: of the outputs.
        position: of the outputs (3).
        numbers: of the outputs: inertia, desired inertia, speed, flux, out of reach.
        gradient: of the outputs (n).
        asked: of the outputs, the answer of Eq. 12 (n).
    """

    def __init__(self, n: int) -> None:
        self.q, self.guesses = slice(0, n), slice(n, 3 * n + 1)
        self.setting, self.one_by_one = slice(3 * n + 1, 4 * n + 16), 6 * n + 16
        self.lower, self.upper = slice(4 * n + 16, 5 * n + 16), slice(5 * n + 16, 6 * n + 16)
        self.usable, self.exact, self.changed = 0, 1, 2
        self.following = slice(3, 2 * n + 4)
        self.qd, self.scaling = slice(2 * n + 4, 3 * n + 4), 3 * n + 4
        self.position = slice(3 * n + 5, 3 * n + 8)
        self.numbers = slice(3 * n + 8, 3 * n + 13)
        self.gradient, self.asked = slice(3 * n + 13, 4 * n + 13), slice(4 * n + 13, 5 * n + 13)


def no_guess(n: int) -> Array:
    """Return the guess (2 n + 1) that no bound is active but s = 1."""
    guess = np.zeros(2 * n + 1)
    guess[-1] = 1.0
    return guess


def unbounded(inputs: Array, at: StepLayout) -> None:
    """Set no bounds beside those of the limits, in the inputs of one step or of columns."""
    inputs[at.lower], inputs[at.upper] = -np.inf, np.inf


def flat(setting: Setting) -> Array:
    """Return a setting as the inputs take it."""
    target, direction, *rest, posture = setting
    return np.array([*target, *direction, *rest, *posture], dtype=float)
