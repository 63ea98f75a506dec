"""Control steps of many arms at once, one in each lane: proved right, or none."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from hitjoints.built import chain_of, refused_by_name
from hitjoints.hitting.compiled_step import check_step
from hitjoints.hitting.step_layout import GUESSES, HASTY, StepLayout, no_guess
from hitjoints.hitting.step_tape import record_step_of
from hitjoints.kernels.tape.backends import evaluate, prepare

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from hitjoints.kernels.tape.backends import Runnable
    from hitjoints.model.robot import Contact, Robot
    from hitjoints.types import Array


class StepRows(NamedTuple):
    """The program of a step, for rows; see `step_layout.StepLayout` for what is where."""

    run: Runnable
    at: StepLayout
    first: Array

    def __call__(self, inputs: Array) -> tuple[Array, NDArray[np.bool_]]:
        """Take a step in every column of the inputs (I, N), whose guesses are brought up to date.

        Returns:
            The outputs (O, N), and which columns (N,) hold a step that is proved right. The others
            hold positions and inertias all the same.
        """
        at = self.at
        inputs[at.one_by_one] = 0.0
        outputs = self._evaluate(inputs)
        for guess in range(1, GUESSES):
            unsettled = (outputs[at.usable] > 0.0) & (outputs[at.changed] != 0.0)
            left = np.flatnonzero(unsettled)
            if not left.size:
                break
            if left.size < self.run.lanes:
                left = np.resize(left, self.run.lanes)
            some = inputs[:, left]
            some[at.guesses] = outputs[at.following][:, left]
            some[at.one_by_one] = float(guess > HASTY)
            inputs[at.guesses, left] = some[at.guesses]
            outputs[:, left] = self._evaluate(some)
        found = outputs[: at.changed + 1]
        right: NDArray[np.bool_] = (
            (found[at.usable] > 0.0) & (found[at.exact] > 0.0) & (found[at.changed] == 0.0)
        )
        if not right.all():
            inputs[at.guesses, ~right] = self.first[:, None]
        return outputs, right

    def _evaluate(self, inputs: Array) -> Array:
        count = len(self.run.program.outputs)
        return evaluate(self.run, count, inputs, inputs.shape[1], 1)


@lru_cache(maxsize=16)
def step_rows_for(robot: Robot, contact: Contact) -> StepRows:
    """Return the step of a robot and a contact for rows, checked against Pinocchio.

    Raises:
        KernelMismatchError: its kinematics or inertias disagree.
        ModelError: a joint carries no inertia.
    """
    chain = chain_of(robot)
    with refused_by_name(robot):
        tape = record_step_of(chain, chain.attach(contact.joint, contact.offset))
    steps = StepRows(prepare(tape, tape.inputs), StepLayout(robot.n), no_guess(robot.n))
    one, result = np.zeros(tape.inputs), np.zeros(len(tape.outputs))

    def run() -> None:
        result[:] = steps._evaluate(one[:, None])[:, 0]

    check_step(robot, contact, one, result, run)
    return steps
