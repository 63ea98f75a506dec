"""A control step as a compiled call: an answer that is proved right, or none."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from hitjoints.built import chain_of, refused_by_name
from hitjoints.errors import KernelMismatchError
from hitjoints.hitting.step import SLOWED, Step
from hitjoints.hitting.step_layout import (
    GUESSES,
    HASTY,
    StepLayout,
    flat,
    no_guess,
    unbounded,
)
from hitjoints.hitting.step_tape import Setting, record_step_of
from hitjoints.kernels.reference import PinocchioAnswers
from hitjoints.kernels.tape.backends import choose
from hitjoints.kernels.verify import samples

if TYPE_CHECKING:
    from collections.abc import Callable

    from hitjoints.kernels.tape.scalar import ScalarProgram
    from hitjoints.model.robot import Contact, Robot
    from hitjoints.programs.torque_rows import Impulses
    from hitjoints.types import Array

FLOAT = np.dtype(float)
AGREES = 1e-9
"""Largest deviation from Pinocchio, relative to 1 plus the size."""


class CompiledStep:
    """Takes steps with the settings of one controller; not for several threads at once.

    Every answer meets the optimality conditions of both programs for the bounds that it takes to
    be active. Where no such answer is found in a few guesses, or an arm is singular, at its limits
    or beyond, there is none.

    Args:
        robot: the arm and what it hits with.
        contact: the arm and what it hits with.
        setting: of the controller, numbers in place of a tape's.
    """

    def __init__(self, robot: Robot, contact: Contact, setting: Setting) -> None:
        at = StepLayout(robot.n)
        self._inputs, self._outputs, self._run = program_for(robot, contact).bind()
        self._q, self._shape = self._inputs[at.q], (robot.n,)
        self._guesses, self._next = self._inputs[at.guesses], self._outputs[at.following]
        self._inputs[at.setting] = flat(setting)
        self._status = self._outputs[: at.changed + 1]
        self._qd, self._position = self._outputs[at.qd], self._outputs[at.position]
        self._scaling, self._numbers = at.scaling, self._outputs[at.numbers]
        self._lower, self._upper = self._inputs[at.lower], self._inputs[at.upper]
        self._asked = self._outputs[at.asked]
        self._first = no_guess(robot.n)
        unbounded(self._inputs, at)
        self._guesses[:] = self._first

    def within_torques(
        self, q: Array, lower: Array, upper: Array, impulses: Impulses
    ) -> Step | None:
        """Return the step from q (n,) rad if torques do not matter for it, or None.

        Then it is Eq. 7, no bound in the way, and neither it nor the answer of Eq. 12 takes more
        than the motors have.

        Args:
            q: (n,) rad.
            lower: (n,) rad/s, bounds beside those of the limits.
            upper: (n,) rad/s, bounds beside those of the limits.
            impulses: what the motors can do.
        """
        self._lower[:], self._upper[:] = lower, upper
        step = self(q)
        if step is None or not (self._guesses[q.size :] == self._first[q.size :]).all():
            return None
        return step if impulses.allow(step.qd) and impulses.allow(self._asked) else None

    def __call__(self, q: Any) -> Step | None:
        """Return the step from q (n,) rad, or None: not this way."""
        if type(q) is not np.ndarray or q.dtype is not FLOAT or q.shape != self._shape:
            return None
        self._q[:] = q
        self._inputs[-1] = 0.0
        for guess in range(1, GUESSES + 1):
            self._run()
            usable, exact, changed = self._status.tolist()
            if not usable > 0.0:
                break
            if changed == 0.0:
                if not exact > 0.0:
                    break
                scaling = self._outputs.item(self._scaling)
                inertia, desired, speed, flux, beyond = self._numbers.tolist()
                return Step(
                    self._qd.copy(),
                    self._position.copy(),
                    inertia,
                    desired,
                    speed,
                    flux,
                    scaling,
                    beyond > 0.0 or scaling < SLOWED,
                    False,
                    False,
                )
            self._guesses[:] = self._next
            if guess > HASTY:
                self._inputs[-1] = 1.0
        self._guesses[:] = self._first
        return None


def compiles() -> bool:
    """Tell whether steps can be compiled here."""
    return choose() == "llvm"


@lru_cache(maxsize=16)
def program_for(robot: Robot, contact: Contact) -> ScalarProgram:
    """Return the compiled step of a robot and a contact, checked against Pinocchio.

    Raises:
        KernelMismatchError: its kinematics or inertias disagree.
        ModelError: a joint carries no inertia.
    """
    from hitjoints.kernels.tape.scalar import ScalarProgram  # which needs llvmlite

    chain = chain_of(robot)
    attached = chain.attach(contact.joint, contact.offset)
    with refused_by_name(robot):
        program = ScalarProgram(record_step_of(chain, attached))
    check_step(robot, contact, *program.bind())
    return program


def check_step(
    robot: Robot, contact: Contact, inputs: Array, outputs: Array, run: Callable[[], object]
) -> None:
    """Compare a compiled step's kinematics and inertias with Pinocchio's.

    Args:
        robot: the arm and what it hits with.
        contact: the arm and what it hits with.
        inputs: (I,), filled in here.
        outputs: (O,), filled in by `run`.
        run: takes the step.

    Raises:
        KernelMismatchError: they disagree.
    """
    at, data = StepLayout(robot.n), robot.model.createData()
    where = (contact.joint, contact.offset)
    for q, h, mass in zip(*samples(robot.model), strict=True):
        answers = PinocchioAnswers(robot.model, data, q, where, h, float(mass))
        if not answers.moves:
            continue
        inputs[at.q], inputs[at.guesses] = q, no_guess(robot.n)
        unbounded(inputs, at)
        inputs[at.setting] = flat(
            Setting(
                (0.0, 0.0, 0.0), tuple(h), mass, 0.1, 0.002, 1.0, 0.0, 0.5, 0.5, 0.0, 0.0, tuple(q)
            )
        )
        run()
        for name, found, expected in (
            ("position", outputs[at.position], answers.position),
            ("inertia", outputs[at.numbers][0], answers.inertia),
            ("gradient", outputs[at.gradient], answers.gradient),
        ):
            size = 1.0 + float(np.abs(expected).max()) + answers.inertia
            deviation = float(np.abs(found - expected).max())
            if not deviation <= AGREES * size:
                raise KernelMismatchError(
                    f"{name} of a control step at joint {contact.joint}: off by {deviation:.3g} "
                    "from Pinocchio"
                )
